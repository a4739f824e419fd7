//! What the integration tests share: running the built command, temporary folders, edited files.

#![allow(dead_code)] // Each test file uses a part.

pub mod json_schema;
pub mod random;
pub mod refusals;
pub mod solvers;
pub mod sweeps;
pub mod tools;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;
use tempfile::TempDir;

/// What a command did.
#[derive(Debug)]
pub struct Run {
    /// Exit status; `None` when a signal ended it.
    pub status: Option<i32>,
    /// Standard output.
    pub stdout: String,
    /// Standard error.
    pub stderr: String,
}

impl Run {
    pub fn new(output: Output) -> Self {
        Run {
            status: output.status.code(),
            stdout: String::from_utf8(output.stdout).expect("standard output is text"),
            stderr: String::from_utf8(output.stderr).expect("standard error is text"),
        }
    }

    /// The run itself, when it ended with this status.
    #[track_caller]
    pub fn ends_with(self, status: i32) -> Self {
        assert_eq!(self.status, Some(status), "{self:#?}");
        self
    }

    /// Standard output, which must be one JSON object and nothing else.
    #[track_caller]
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout).expect("one JSON value");
        assert!(value.is_object(), "{value}");
        assert_eq!(self.stdout.trim_end().lines().count(), 1, "one line");
        value
    }

    /// The one error line of a command that refuses its input.
    #[track_caller]
    pub fn refusal(self) -> String {
        let run = self.ends_with(1);
        assert_eq!(run.stdout, "", "{run:#?}");
        assert_eq!(run.stderr.lines().count(), 1, "{run:#?}");
        let message = run.stderr.strip_prefix("error: ").expect("an error line");
        message.trim_end().to_string()
    }
}

/// The built command, in a folder of its choice.
pub fn command() -> Command {
    Command::new(env!("CARGO_BIN_EXE_steadfast"))
}

/// Runs the built command.
pub fn steadfast<I: IntoIterator<Item = S>, S: AsRef<OsStr>>(arguments: I) -> Run {
    Run::new(
        command()
            .args(arguments)
            .output()
            .expect("the command runs"),
    )
}

/// A path as an argument.
#[track_caller]
pub fn word(path: &Path) -> &str {
    path.to_str().expect("a name")
}

/// Simulates a scenario, with a design where there is one, into a folder. A missed requirement is no failure.
#[track_caller]
pub fn simulated(scenario: &Path, design: Option<&Path>, out: &Path) -> Run {
    let own = ["simulate", word(scenario), "-o", word(out)].map(Path::new);
    let design = design.map(|design| [Path::new("--design"), design]);
    let run = steadfast(own.into_iter().chain(design.into_iter().flatten()));
    assert!(matches!(run.status, Some(0 | 2)), "{run:#?}");
    run
}

/// The repository's folder.
pub fn repository() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A shipped file of `models/`.
pub fn shipped(name: &str) -> PathBuf {
    repository().join("models").join(name)
}

/// Every shipped file of `models/`, sorted.
pub fn all_shipped() -> Vec<PathBuf> {
    let names = names_in(&repository().join("models"));
    names.iter().map(|name| shipped(name)).collect()
}

/// What kind of file a shipped file is.
pub fn shipped_kind(file: &Value) -> &'static str {
    let has = |key| file.get(key).is_some();
    if has("duration_s") {
        "scenario"
    } else if has("problem") {
        "problem"
    } else if has("manoeuvre") {
        "requirements"
    } else if has("requirements") {
        "facts"
    } else if file["gains"].is_array() {
        "gains"
    } else {
        "model"
    }
}

/// An empty folder that goes away with the test.
pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// The names in a folder, sorted.
pub fn names_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry
            .expect("an entry")
            .file_name()
            .into_string()
            .expect("a plain name")
    };
    let mut names: Vec<String> = entries.map(name).collect();
    names.sort();
    names
}

/// A file's text.
#[track_caller]
pub fn text(path: &Path) -> String {
    std::fs::read_to_string(path).expect("a text file")
}

/// A file's JSON.
#[track_caller]
pub fn json(path: &Path) -> Value {
    serde_json::from_str(&text(path)).expect("a JSON file")
}

/// Writes `contents` under `name` in `folder`.
#[track_caller]
pub fn write(folder: &Path, name: &str, contents: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, contents).expect("a file is written");
    path
}

/// Sets the value at a JSON pointer, which must exist unless its last part is a new key.
#[track_caller]
pub fn set(file: &mut Value, pointer: &str, value: Value) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    match file.pointer_mut(parent).expect("the parent exists") {
        Value::Object(fields) => {
            fields.insert(key.to_string(), value);
        }
        Value::Array(entries) => entries[key.parse::<usize>().expect("an index")] = value,
        other => panic!("{other} has no entries"),
    }
}

/// Removes the key at a JSON pointer.
#[track_caller]
pub fn remove(file: &mut Value, pointer: &str) {
    let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
    let fields = file
        .pointer_mut(parent)
        .and_then(Value::as_object_mut)
        .expect("an object");
    fields.remove(key).expect("the key exists");
}

/// The number at a JSON pointer.
#[track_caller]
pub fn number(file: &Value, pointer: &str) -> f64 {
    let found = file.pointer(pointer).and_then(Value::as_f64);
    found.unwrap_or_else(|| panic!("no number at {pointer}"))
}

/// Whether two numbers agree to a relative tolerance.
#[track_caller]
pub fn assert_relative(found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs() / expected.abs();
    assert!(
        error <= tolerance,
        "{found} against {expected}: relative error {error:e}"
    );
}

/// A design that is checked in; `fixtures.rs` proves it again and makes it anew.
pub fn fixture(name: &str) -> PathBuf {
    repository().join("tests/data").join(name)
}

/// The design of `models/xu2020.json`.
pub fn xu2020_design() -> &'static Path {
    static DESIGN: OnceLock<PathBuf> = OnceLock::new();
    DESIGN.get_or_init(|| fixture("xu2020-design.json"))
}

/// `steadfast synthesize` of a file, with further arguments.
pub fn synthesize(model: &Path, more: &[&str]) -> Run {
    let output = command().arg("synthesize").arg(model).args(more).output();
    Run::new(output.expect("the command runs"))
}

/// A file with requirements, with the first change that the answer of `synthesize` offers; `None` where it offers none.
pub fn with_first_change(file: &Value, answer: &Value) -> Option<Value> {
    let mut file = file.clone();
    let change = answer["changes"].as_array()?.first()?;
    for one in change["fields"].as_array().expect("fields") {
        let field = one["field"].as_str().expect("a field");
        let pointer = format!("/{}", field.replace('.', "/"));
        let mut values = one["values"].clone();
        if file.pointer(&pointer).expect("a value").is_number() {
            values = values[0].clone();
        }
        set(&mut file, &pointer, values);
    }
    Some(file)
}

/// The design of `models/xu2020.json` with the form of the gyroscopic torque that the paper has, K = 0.
pub fn design_in_the_papers_form() -> &'static Path {
    static DESIGN: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let (_, design) = DESIGN.get_or_init(|| {
        let folder = folder();
        let mut model = json(&shipped("xu2020.json"));
        let form = serde_json::json!(vec![[0.0; 3]; 3]);
        set(&mut model, "/plant/exact/gyroscopic_form_kg_m2", form);
        let model = write(folder.path(), "model.json", model.to_string());
        let design = folder.path().join("design.json");
        let arguments = [Path::new("synthesize"), &model, Path::new("-o"), &design];
        steadfast(arguments).ends_with(0);
        (folder, design)
    });
    design
}

/// The design of `models/double-integrator.json`.
pub fn double_integrator_design() -> &'static Path {
    static DESIGN: OnceLock<PathBuf> = OnceLock::new();
    DESIGN.get_or_init(|| fixture("double-integrator-design.json"))
}

/// A shipped scenario cut to a length.
pub fn cut(name: &str, duration_s: f64, folder: &Path) -> PathBuf {
    let mut scenario = json(&shipped(name));
    scenario["duration_s"] = duration_s.into();
    if let Some(metrics) = scenario.get_mut("metrics").and_then(Value::as_object_mut) {
        metrics.remove("tail_s");
    }
    write(folder, name, scenario.to_string())
}

/// Two linear rules of two states whose actuator is far too weak for any design.
pub fn weak_rules(folder: &Path) -> PathBuf {
    let mut model = json(&shipped("two-rules.json"));
    let limit = "/plant/rules/system/linear/input_limit";
    set(&mut model, limit, serde_json::json!([0.001]));
    write(folder, "weak.json", model.to_string())
}

/// Keys of a JSON report that claim something of a design.
pub const CLAIMS: [&str; 7] = [
    "gamma",
    "guaranteed_gain",
    "xi",
    "certified_angle_deg",
    "certified_angle_any_axis_deg",
    "min_inter_event_s",
    "outer",
];

/// Checks that a report claims nothing.
#[track_caller]
pub fn assert_claims_nothing(report: &Value) {
    for key in CLAIMS {
        assert_eq!(report[key], Value::Null, "{key}");
    }
}
