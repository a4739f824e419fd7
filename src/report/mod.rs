//! Pages: one HTML file each with its figures inside, readable offline.

pub mod campaign;
pub mod comparison;
mod figure;
pub mod files;
pub mod html;
mod run;
mod series;
pub mod sweep;

pub use figure::{Band, Figure, FigureError, Horizontal, COLOURS};
pub use html::{document, document_with_style, escape};
pub use run::page;
pub use series::Line;
