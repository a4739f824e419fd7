//! Pages: one HTML file each with its figures inside, readable offline.
//!
//! [`html`] has the parts of a page, [`chart`] the figures with their [`axis`] and [`series`]; [`pages`] has one
//! module for each page.

pub mod axis;
pub mod chart;
pub mod html;
pub mod pages;
pub mod series;

pub use pages::run::page;
