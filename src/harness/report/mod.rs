//! The report page: one HTML file with its figures inside, readable offline.

mod figures;
mod inner;
mod intermittent;
mod page;
mod prescribed;
mod series;

pub use figures::{Figure, FigureError};
pub use page::{document, escape, page, short};
pub use series::Line;
