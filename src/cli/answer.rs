//! What the program prints, and its exit status.

use std::io::Write;
use std::process::ExitCode;

use synth::certify::Verdict;

/// Exit status: the answer is no (infeasible, not proved, requirement missed).
pub const EXIT_NO: u8 = 2;
/// Exit status: the solver failed numerically.
pub const EXIT_SOLVER: u8 = 3;

/// Prints to standard output. A reader that closed its end has seen enough; any other failure, such as
/// a full disk, ends the program, because what was requested is not there.
pub(crate) fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let printed = writeln!(out, "{text}").and_then(|()| out.flush());
    if let Err(error) = printed {
        if error.kind() != std::io::ErrorKind::BrokenPipe {
            complain(&format!("standard output cannot be written: {error}"));
            std::process::exit(1);
        }
    }
}

/// Prints one error line; names from files and paths cannot break it.
pub(crate) fn complain(text: &str) {
    let shown = |c: char| -> String {
        match c.is_control() {
            true => c.escape_default().collect(),
            false => c.to_string(),
        }
    };
    let line: String = text.chars().map(shown).collect();
    let _ = writeln!(std::io::stderr(), "error: {line}");
}

/// 0 for proved, 2 for not proved.
pub fn exit_code(verdict: Verdict) -> ExitCode {
    match verdict {
        Verdict::Proved => ExitCode::SUCCESS,
        Verdict::NotProved => ExitCode::from(EXIT_NO),
    }
}
