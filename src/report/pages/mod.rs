//! The pages.

pub mod campaign;
pub mod comparison;
pub mod files;
pub mod run;
pub mod sweep;

use super::html::section;

/// A section around HTML; none around nothing.
fn optional(title: &str, html: &str) -> Option<String> {
    (!html.is_empty()).then(|| section(title, html))
}

/// The digests of a scenario and of its design, for a footer.
fn hashes(scenario: &str, design: Option<&str>) -> Vec<String> {
    vec![
        format!("scenario SHA-256 {scenario}"),
        format!("design SHA-256 {}", design.unwrap_or("none")),
    ]
}
