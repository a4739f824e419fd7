//! The report page: one HTML file with its figures inside, readable offline.

mod figures;
mod intermittent;
mod page;
mod series;

pub use figures::FigureError;
pub use page::page;
