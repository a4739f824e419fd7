//! Where results go: the rule for what may be replaced, and the trial before any long work.
//!
//! A result replaces a file of its own kind, such as a design a design, and nothing else: a file of another kind, or
//! one that is not recognised, is left as it is unless `--force` is given. An input is never replaced.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use synth::model::{kind_of, Kind, MAX_FILE_BYTES};

use super::error::CliError;
use crate::base::files::OutputError;

/// What a file holds, as far as the rule for replacing it needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contents {
    /// A JSON file of one of these kinds.
    Document(&'static [Kind]),
    /// A JSON object with these keys, called so.
    Record(&'static str, &'static [&'static str]),
    /// A page of this program.
    Page,
    /// Comma-separated values whose header has these columns, called so.
    Csv(&'static str, &'static [&'static str]),
    /// A Parquet table of this program.
    Parquet,
    /// A MAT-file of this program.
    Mat,
    /// A C header of this program.
    Header,
    /// SDPA sparse text of this program.
    Sdpa,
    /// A part of a whole, called so, which alone is not recognised: no file is of this kind.
    Part(&'static str),
}

/// What proves that a design exists, or that none does.
pub const DECISION: Contents = Contents::Document(&[Kind::Design, Kind::Infeasibility]);
/// The summary of a run.
pub const SUMMARY: Contents = Contents::Record("summary", &["scenario", "verdict", "scales"]);
/// A comparison.
pub const COMPARISON: Contents = Contents::Record("comparison", &["task", "runs", "faults"]);
/// How a sweep's table came about.
pub const SWEEP: Contents = Contents::Record("sweep", &["axes", "points", "verdicts"]);
/// The trajectory of a run.
pub const TRAJECTORY: Contents = Contents::Csv("trajectory", &["time_s", "sent"]);
/// The table of a sweep.
pub const SWEEP_TABLE: Contents = Contents::Csv("sweep's table", &["verdict", "reason"]);
/// The table of a comparison.
pub const COMPARISON_TABLE: Contents =
    Contents::Csv("comparison's table", &["label", "verdict", "link_bits"]);
/// A design as a table.
pub const DESIGN_TABLE: Contents =
    Contents::Csv("design's table", &["quantity", "matrix", "row", "value"]);

/// Bytes at either end of a file that are looked at.
const ENDS: u64 = 1 << 16;

impl Contents {
    /// Its name.
    fn name(self) -> String {
        match self {
            Contents::Document(kinds) => {
                let names: Vec<String> = kinds.iter().map(Kind::to_string).collect();
                format!("{} file", names.join(" or "))
            }
            Contents::Record(name, _) => format!("{name} file"),
            Contents::Page => "page of this program".to_string(),
            Contents::Csv(name, _) => format!("{name} (CSV)"),
            Contents::Parquet => "Parquet table of this program".to_string(),
            Contents::Mat => "MAT-file of this program".to_string(),
            Contents::Header => "C header of this program".to_string(),
            Contents::Sdpa => "SDPA file of this program".to_string(),
            Contents::Part(name) => name.to_string(),
        }
    }

    /// Whether a file is of this kind. One that cannot be read is of none; an empty one has nothing to lose.
    fn is_in(self, path: &Path) -> bool {
        let Ok(length) = path.metadata().map(|about| about.len()) else {
            return false;
        };
        if length == 0 {
            return true;
        }
        let Some([head, tail]) = ends(path, length) else {
            return false;
        };
        let has =
            |bytes: &[u8], text: &str| bytes.windows(text.len()).any(|w| w == text.as_bytes());
        let line = head.split(|byte| *byte == b'\n').next().unwrap_or(&[]);
        match self {
            Contents::Document(kinds) => whole(path, length)
                .is_some_and(|text| kind_of(&text).is_some_and(|k| kinds.contains(&k))),
            Contents::Record(_, keys) => whole(path, length).is_some_and(|text| {
                let value: Option<serde_json::Value> = serde_json::from_str(&text).ok();
                value.is_some_and(|value| keys.iter().all(|key| value.get(key).is_some()))
            }),
            Contents::Page => {
                head.starts_with(b"<!DOCTYPE html>") && has(&head, "<p class=\"verdict ")
            }
            Contents::Csv(_, columns) => {
                let line = String::from_utf8_lossy(line);
                let names: Vec<&str> = line.trim_end().split(',').collect();
                columns.iter().all(|column| names.contains(column))
            }
            Contents::Parquet => head.starts_with(b"PAR1") && has(&tail, "steadfast"),
            Contents::Mat => head.starts_with(b"MATLAB 5.0") && has(line, "steadfast"),
            Contents::Header => has(&head, "#ifndef STEADFAST_"),
            Contents::Sdpa => has(line, "by steadfast "),
            Contents::Part(_) => false,
        }
    }
}

/// The first and the last bytes of a file.
fn ends(path: &Path, length: u64) -> Option<[Vec<u8>; 2]> {
    let mut file = File::open(path).ok()?;
    let mut read = |from: u64| {
        let mut bytes = Vec::new();
        file.seek(SeekFrom::Start(from)).ok()?;
        file.by_ref().take(ENDS).read_to_end(&mut bytes).ok()?;
        Some(bytes)
    };
    Some([read(0)?, read(length.saturating_sub(ENDS))?])
}

/// A whole file of text, unless it is too large for one of ours.
fn whole(path: &Path, length: u64) -> Option<String> {
    let small = length <= MAX_FILE_BYTES;
    small.then(|| std::fs::read_to_string(path).ok()).flatten()
}

/// What a file is that is left as it is.
fn found(path: &Path) -> String {
    let kind = path
        .metadata()
        .ok()
        .and_then(|about| whole(path, about.len()));
    match kind.and_then(|text| kind_of(&text)) {
        Some(kind) => format!("a {kind} file"),
        None => "something else".to_string(),
    }
}

/// What a verb may do to the files that it writes.
#[derive(Debug, Clone, Copy)]
pub struct Targets<'a> {
    /// Files that must stay.
    pub inputs: &'a [&'a Path],
    /// Whether files of another kind are replaced too.
    pub force: bool,
}

impl Targets<'_> {
    /// Refuses an output file that cannot be written, that is an input, or that holds something of another kind.
    pub fn check_file(&self, path: Option<&Path>, contents: Contents) -> Result<(), CliError> {
        let Some(path) = path else {
            return Ok(());
        };
        let refuse = |reason: &str| Err(CliError::unsuitable(path, reason));
        let folder = folder_of(path);
        if path.is_dir() {
            return refuse("this is a folder; a file name is needed");
        }
        if !folder.is_dir() {
            return refuse("cannot be written: its folder does not exist");
        }
        if path.exists() && !path.is_file() {
            return refuse("cannot be written: it is not an ordinary file");
        }
        self.check_kept(path, contents)?;
        try_to_write(path, folder)
    }

    /// Refuses an output folder that is something else, that cannot be written, or in which one of the files to be
    /// written there holds something of another kind.
    pub fn check_folder(
        &self,
        folder: Option<&Path>,
        files: &[(&str, Contents)],
    ) -> Result<(), CliError> {
        let Some(folder) = folder else {
            return Ok(());
        };
        let there = folder.ancestors().find(|place| place.exists());
        let there = there.unwrap_or(Path::new("."));
        if !there.is_dir() {
            let reason = match there == folder {
                true => "this is a file; a folder is needed".to_string(),
                false => format!("cannot be created: {} is a file", there.display()),
            };
            return Err(CliError::unsuitable(folder, reason));
        }
        for (name, contents) in files {
            let path = folder.join(name);
            if path.is_dir() {
                let reason = "this is a folder; a file of this name is to be written";
                return Err(CliError::unsuitable(&path, reason));
            }
            self.check_kept(&path, *contents)?;
        }
        try_to_write(folder, there)
    }

    /// Refuses to replace an input, or a file of another kind.
    fn check_kept(&self, path: &Path, contents: Contents) -> Result<(), CliError> {
        let real = |path: &Path| path.canonicalize().ok();
        let own = real(path);
        if own.is_some() && self.inputs.iter().any(|input| real(input) == own) {
            let reason = "this is the input; it would be overwritten";
            return Err(CliError::unsuitable(path, reason));
        }
        if self.force || !path.exists() || contents.is_in(path) {
            return Ok(());
        }
        let reason = format!(
            "holds {}, where a {} would be written; choose another name, or give --force to replace it",
            found(path),
            contents.name()
        );
        Err(CliError::unsuitable(path, reason))
    }
}

/// The folder of a file.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Makes and removes a file in a folder, so that one that cannot be written is known before any work.
fn try_to_write(path: &Path, folder: &Path) -> Result<(), CliError> {
    let folder = match folder.as_os_str().is_empty() {
        true => PathBuf::from("."),
        false => folder.to_path_buf(),
    };
    let made = tempfile::NamedTempFile::new_in(folder).map(drop);
    made.map_err(|error| OutputError::io(path, "cannot be written", error).into())
}
