//! What a verb answers: its exit status and what it prints, which is printed once, here.

use std::io::Write;
use std::process::ExitCode;

use serde::Serialize;
use synth::certify::Verdict;

use crate::base::files::what_was_written;

/// Exit status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Exit {
    /// Done; the answer is yes.
    Yes = 0,
    /// Bad usage, or an input that cannot be read or is not valid.
    Usage = 1,
    /// The answer is no: infeasible, not proved, undecided, a requirement missed.
    No = 2,
    /// The solver failed numerically.
    SolverFailed = 3,
}

impl Exit {
    /// Yes or no.
    pub fn of(yes: bool) -> Self {
        match yes {
            true => Exit::Yes,
            false => Exit::No,
        }
    }
}

impl From<Verdict> for Exit {
    fn from(verdict: Verdict) -> Self {
        Exit::of(verdict == Verdict::Proved)
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}

/// What a verb answers.
#[derive(Debug)]
pub struct Answer {
    exit: Exit,
    json: Option<String>,
    text: Option<String>,
    remarks: Vec<String>,
}

impl Answer {
    /// A report, and the same in words. The keys of the JSON object are in alphabetical order.
    pub fn new(exit: Exit, report: &impl Serialize, lines: &[String]) -> Self {
        // Reports hold numbers, texts and lists under text keys, so they can always be written.
        let report = serde_json::to_value(report).unwrap_or_default();
        Answer {
            json: Some(report.to_string()),
            ..Answer::text(exit, lines.join("\n"))
        }
    }

    /// A report whose JSON is the text of a file.
    pub fn file(exit: Exit, json: String, text: String) -> Self {
        Answer {
            json: Some(json),
            ..Answer::text(exit, text)
        }
    }

    /// The answer of a verb without `--json`.
    pub fn text(exit: Exit, text: String) -> Self {
        Answer {
            text: Some(text),
            ..Answer::silent(exit)
        }
    }

    /// An answer that prints nothing.
    pub fn silent(exit: Exit) -> Self {
        Answer {
            exit,
            json: None,
            text: None,
            remarks: Vec::new(),
        }
    }

    /// With one more line for standard error, after the answer.
    pub fn remark(mut self, line: impl Into<String>) -> Self {
        self.remarks.push(line.into());
        self
    }

    /// Prints the JSON object or the text, and the remarks.
    pub(crate) fn print(self, json: bool) -> ExitCode {
        let printed = match json {
            true => self.json,
            false => self.text,
        };
        if let Some(text) = printed {
            print(&text);
        }
        self.remarks.iter().for_each(|line| note(line));
        self.exit.into()
    }
}

/// Prints to standard output. A reader that closed its end has seen enough; any other failure, such as
/// a full disk, ends the program, because what it was asked for is not there.
fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let printed = writeln!(out, "{text}").and_then(|()| out.flush());
    if let Err(error) = printed {
        if error.kind() != std::io::ErrorKind::BrokenPipe {
            complain(&format!(
                "standard output cannot be written: {error}; {}",
                what_was_written()
            ));
            std::process::exit(1);
        }
    }
}

/// Prints a line to standard error.
pub(crate) fn note(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
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
    note(&format!("error: {line}"));
}
