//! Pages: one HTML file each with its figures inside, readable offline.
//!
//! [`html`] and [`figure`] are what every page is made of; [`pages`] has one module for each.

mod figure;
pub mod html;
pub mod pages;
mod series;

pub use figure::{Band, Figure, FigureError, Horizontal, COLOURS};
pub use html::{document, document_with_style, escape};
pub use pages::run::page;
pub use series::Line;
