//! What a file on the disk holds.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use serde_json::Value;
use synth::model::{Kind, MAX_FILE_BYTES};

use super::document::{recognise, Recognised};
use crate::base::table::Table;
use crate::base::trajectory::check_trajectory;
use crate::export::flight::source::MARK;
use crate::export::{basilisk, csv};
use crate::report::html::PageKind;

/// What a file holds, as far as the rule for replacing it needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contents {
    /// A JSON file of one of these kinds.
    Document(&'static [Kind]),
    /// A JSON object of this program with these keys, called so.
    Record(&'static str, &'static [&'static str]),
    /// A page of this program.
    Page(PageKind),
    /// The trajectory of a run.
    Trajectory,
    /// Comma-separated values whose header has these columns side by side, called so.
    Csv(&'static str, &'static [&'static str]),
    /// The points of a sweep.
    Journal,
    /// A Parquet table of this program.
    Parquet,
    /// A MAT-file of this program.
    Mat,
    /// A C header of this program.
    Header,
    /// A file of a controller's source text by this program.
    FlightCode,
    /// A module for Basilisk of this program.
    Basilisk,
    /// A functional mock-up unit of this program.
    Unit,
    /// SDPA sparse text of this program.
    Sdpa,
    /// A part of a whole, called so, which alone is not recognised: no file is of this kind.
    Part(&'static str),
}

/// What proves that a design exists, or that none does.
pub const DECISION: Contents = Contents::Document(&[Kind::Design, Kind::Infeasibility]);
/// The summary of a run.
pub const SUMMARY: Contents = Contents::Document(&[Kind::Summary]);
/// A comparison.
pub const COMPARISON: Contents =
    Contents::Record("comparison", &["schema_version", "task", "runs", "faults"]);
/// How a sweep's table came about.
pub const SWEEP: Contents = Contents::Record(
    "sweep",
    &["kind", "file_sha256", "axes", "points", "verdicts"],
);
/// The record of a campaign.
pub const CAMPAIGN: Contents = Contents::Record(
    "campaign",
    &["schema_version", "state", "inputs", "results"],
);
/// The table of a sweep.
pub const SWEEP_TABLE: Contents = Contents::Csv("sweep's table", &["verdict", "reason"]);
/// The table of a comparison.
pub const COMPARISON_TABLE: Contents =
    Contents::Csv("comparison's table", &["label", "verdict", "proof_covers"]);
/// A design as a table.
pub const DESIGN_TABLE: Contents = Contents::Csv("design's table", &csv::COLUMNS);

/// All that is recognised beside documents.
const RECOGNISED: [Contents; 18] = [
    COMPARISON,
    SWEEP,
    CAMPAIGN,
    Contents::Page(PageKind::Run),
    Contents::Page(PageKind::Campaign),
    Contents::Page(PageKind::Comparison),
    Contents::Page(PageKind::Sweep),
    Contents::Trajectory,
    SWEEP_TABLE,
    COMPARISON_TABLE,
    DESIGN_TABLE,
    Contents::Parquet,
    Contents::Mat,
    Contents::FlightCode,
    Contents::Basilisk,
    Contents::Unit,
    Contents::Header,
    Contents::Sdpa,
];

/// Bytes at either end of a file that are looked at.
const ENDS: u64 = 1 << 16;

impl Contents {
    /// Its name with the article.
    pub fn name(self) -> String {
        match self {
            Contents::Document(kinds) => {
                let names: Vec<String> = kinds.iter().map(|kind| kind.with_article()).collect();
                format!("{} file", names.join(" or "))
            }
            Contents::Record(name, _) => format!("a {name} file"),
            Contents::Page(kind) => format!("the {} of this program", kind.name()),
            Contents::Trajectory => "a trajectory (CSV)".to_string(),
            Contents::Csv(name, _) => format!("a {name} (CSV)"),
            Contents::Journal => "the points of a sweep".to_string(),
            Contents::Parquet => "a Parquet table of this program".to_string(),
            Contents::Mat => "a MAT-file of this program".to_string(),
            Contents::Header => "a C header of this program".to_string(),
            Contents::FlightCode => "flight code of this program".to_string(),
            Contents::Basilisk => "a module for Basilisk of this program".to_string(),
            Contents::Unit => "a functional mock-up unit of this program".to_string(),
            Contents::Sdpa => "an SDPA file of this program".to_string(),
            Contents::Part(name) => format!("a {name}"),
        }
    }

    /// Whether there is a file of this kind that is not empty.
    pub fn stands_in(self, path: &Path) -> bool {
        path.metadata().is_ok_and(|about| about.len() > 0) && self.is_in(path)
    }

    /// Whether a file is of this kind. One that cannot be read is of none; an empty one has nothing to lose.
    pub fn is_in(self, path: &Path) -> bool {
        let Ok(length) = path.metadata().map(|about| about.len()) else {
            return false;
        };
        if length == 0 {
            return true;
        }
        let Some([head, tail]) = ends(path, length) else {
            return false;
        };
        let line = head.split(|byte| *byte == b'\n').next().unwrap_or(&[]);
        match self {
            Contents::Document(kinds) => whole(path, length).is_some_and(
                |text| matches!(recognise(&text), Recognised::Valid(kind) if kinds.contains(&kind)),
            ),
            Contents::Record(_, keys) => {
                whole(path, length).is_some_and(|text| is_record(&text, keys))
            }
            Contents::Page(kind) => {
                head.starts_with(b"<!DOCTYPE html>") && has(&head, &kind.mark())
            }
            Contents::Trajectory => is_head_of_trajectory(&head),
            Contents::Csv(_, columns) => {
                let line = String::from_utf8_lossy(line);
                let names: Vec<&str> = line.trim_end().split(',').collect();
                names.windows(columns.len()).any(|names| names == columns)
            }
            Contents::Journal => {
                line.starts_with(b"{\"sweep\":") && has(line, "\"generator\":\"steadfast ")
            }
            Contents::Parquet => head.starts_with(b"PAR1") && has(&tail, "steadfast"),
            Contents::Mat => head.starts_with(b"MATLAB 5.0") && has(line, "steadfast"),
            Contents::Header => has(&head, "#ifndef STEADFAST_") && !has(&head, MARK),
            Contents::FlightCode => has(&head, MARK) && !head.starts_with(b"PK"),
            Contents::Basilisk => has(&head, basilisk::MARK),
            Contents::Unit => head.starts_with(b"PK") && has(&head, MARK),
            Contents::Sdpa => has(line, "by steadfast "),
            Contents::Part(_) => false,
        }
    }
}

fn has(bytes: &[u8], text: &str) -> bool {
    bytes.windows(text.len()).any(|w| w == text.as_bytes())
}

/// Whether a text is a record of this program with these keys.
fn is_record(text: &str, keys: &[&str]) -> bool {
    let Ok(value) = serde_json::from_str::<Value>(text) else {
        return false;
    };
    // The generator stands at the top, or in what determines the work.
    let generator = value
        .get("generator")
        .or_else(|| value.get("inputs")?.get("generator"));
    let ours = generator.and_then(Value::as_str);
    ours.is_some_and(|name| name.starts_with("steadfast "))
        && keys.iter().all(|key| value.get(key).is_some())
}

/// Whether a file that begins so is a trajectory: its header and its first rows are.
fn is_head_of_trajectory(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    // The last line may be cut off.
    let lines = text.rfind('\n').map_or("", |end| &text[..end]);
    Table::from_csv(lines).is_ok_and(|table| check_trajectory(&table).is_ok())
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
pub fn found(path: &Path) -> String {
    let text = path
        .metadata()
        .ok()
        .and_then(|about| whole(path, about.len()));
    match text.map_or(Recognised::Unknown, |text| recognise(&text)) {
        Recognised::Valid(kind) => return format!("{} file", kind.with_article()),
        Recognised::Invalid(kind) => return format!("something that is no valid {kind} file"),
        Recognised::Unknown => {}
    }
    let known = RECOGNISED.into_iter().find(|contents| contents.is_in(path));
    known.map_or("something else".to_string(), Contents::name)
}
