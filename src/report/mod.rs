//! Pages: one HTML file each with its figures inside, readable offline.
//!
//! [`html`] has the parts of a page, [`figure`] and [`plot`] what is drawn, [`chart`] what drawings have in
//! common; [`pages`] has one module for each page.

pub mod chart;
pub mod figure;
pub mod html;
pub mod pages;
pub mod plot;
pub mod scale;
pub mod series;

pub use chart::{FigureError, COLOURS};
pub use figure::{Band, Figure, Horizontal};
pub use html::escape;
pub use pages::run::page;
pub use series::Line;
