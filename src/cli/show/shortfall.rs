//! How far a search came, and what stops it there.

use synth::synthesis::LimitingFactors;

use super::blocking::titled;

/// The limiting factors in words.
pub fn limiting_lines(shortfall: &LimitingFactors) -> Vec<String> {
    let title = "what holds it back (1 % more of the number changes the outcome by so much):";
    let limits = shortfall.limits.iter().map(|limit| {
        format!(
            "  {:+.3} %  {}, now {}",
            limit.per_cent, limit.what, limit.value
        )
    });
    titled(title, limits)
}
