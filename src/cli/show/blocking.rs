//! Which conditions block, and by how much all conditions fail.

use synth::programs::Blocking;

/// Conditions named at most where nothing is feasible.
const MOST: usize = 12;

/// The conditions that block.
pub fn blocking_lines(blocking: &[Blocking]) -> Vec<String> {
    let title = "conditions that block (share of the dual solution):";
    let lines = blocking.iter().take(MOST);
    titled(
        title,
        lines.map(|one| format!("  {:5.1} %  {}", 100.0 * one.share, one.name)),
    )
}

/// Conditions named at most where a search stopped short of its goal.
const MOST_OF_SEARCH: usize = 6;

/// The conditions at the best point of a search.
pub fn search_lines(blocking: &[Blocking]) -> Vec<String> {
    let title = "conditions by their share of the dual solution:";
    let lines = blocking.iter().take(MOST_OF_SEARCH);
    titled(
        title,
        lines.map(|one| format!("  {:4.1} %  {}", 100.0 * one.share, one.name)),
    )
}

/// Lines below a title; nothing without lines.
pub fn titled(title: &str, lines: impl Iterator<Item = String>) -> Vec<String> {
    let mut lines = lines.peekable();
    let title = lines.peek().map(|_| title.to_string());
    title.into_iter().chain(lines).collect()
}

/// The smallest slack.
pub fn slack_line(slack: Option<f64>) -> Option<String> {
    let slack = slack?;
    Some(format!(
        "smallest slack t with which every condition holds: {slack:.4e} (scaled units; the solver's number, not proved)"
    ))
}

/// The smallest slack, or that there is none.
pub fn slack_or_none(slack: Option<f64>) -> String {
    slack_line(slack)
        .unwrap_or_else(|| "the smallest slack could not be computed either".to_string())
}
