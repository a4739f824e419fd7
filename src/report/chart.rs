//! Drawings as SVG: what every figure has in common.

use plotters::coord::Shift;
use plotters::prelude::*;

use super::html::escape;

/// Colours that colour-blind readers can tell apart (P. Tol's bright scheme).
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(68, 119, 170),
    RGBColor(238, 102, 119),
    RGBColor(34, 136, 51),
    RGBColor(204, 187, 68),
    RGBColor(102, 204, 238),
    RGBColor(170, 51, 119),
];

/// A figure could not be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("figure '{title}': {reason}")]
pub struct FigureError {
    /// Its title.
    pub title: String,
    /// What the drawing library says.
    pub reason: String,
}

/// Where a figure is drawn.
pub type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws into an SVG element with a label for those who cannot see it; `attributes` are further ones.
///
/// # Errors
/// The drawing library's.
pub fn svg(
    title: &str,
    attributes: &str,
    size: (u32, u32),
    draw: impl FnOnce(&Canvas) -> Result<(), String>,
) -> Result<String, FigureError> {
    let mut out = String::new();
    let root = SVGBackend::with_string(&mut out, size).into_drawing_area();
    let drawn = draw(&root).and_then(|()| root.present().map_err(reason));
    drop(root);
    drawn.map_err(|reason| FigureError {
        title: title.to_string(),
        reason,
    })?;
    let start = out.find("<svg").unwrap_or(0);
    let label = escape(title);
    let open = format!("<svg {attributes}role=\"img\" aria-label=\"{label}\" ");
    Ok(out[start..].replacen("<svg ", &open, 1))
}

/// What the drawing library says.
pub fn reason(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// A colour as in HTML.
pub fn hexadecimal(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
