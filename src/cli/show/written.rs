//! Files that were written, or not.

use std::path::Path;

use synth::certify::Verdict;

/// Says that nothing was written.
pub const NOTHING: &str = "nothing written";

/// Names a file that was written.
pub fn written(path: &Path) -> String {
    format!("written: {}", path.display())
}

/// Names a file that was written, or says that none was.
pub fn written_or_nothing(path: Option<&Path>) -> String {
    path.map_or_else(|| NOTHING.to_string(), written)
}

/// What became of a design.
pub fn design_written(path: Option<&Path>, verdict: Verdict) -> String {
    match (path, verdict) {
        (None, Verdict::Proved) => format!("{NOTHING}; give -o DESIGN.json to keep the design"),
        (path, _) => written_or_nothing(path),
    }
}
