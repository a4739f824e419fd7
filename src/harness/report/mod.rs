//! The report page: one HTML file with its figures inside, readable offline.

pub mod campaign;
mod figures;
mod inner;
mod intermittent;
mod page;
mod prescribed;
mod series;

pub use figures::{Band, Figure, FigureError, Horizontal, COLOURS};
pub use page::{document, document_with_style, escape, page, short};
pub use series::Line;
