//! Wrong input to every verb: one line with file, field, value and what is allowed, exit status 1, nothing written and
//! nothing replaced.

mod usage;
mod values;

use std::path::{Path, PathBuf};

use crate::support::refusals::assert_plain;
use crate::support::*;
use usage::USAGE;
use values::{readers, wrong_values};

/// A folder with one file of every kind, and what is in it before a command runs.
struct Inputs {
    folder: tempfile::TempDir,
}

impl Inputs {
    fn new() -> Self {
        let inputs = Inputs { folder: folder() };
        let kinds = [
            ("model", "double-integrator.json"),
            ("craft", "xu2020.json"),
            ("scenario", "wu2018.json"),
            ("lei", "lei2022.json"),
            ("yang", "yang2025.json"),
            ("linked", "wu2018-link.json"),
            ("campaign", "wu2018-campaign.json"),
            ("loop", "xu2020-closed-loop.json"),
            ("cart", "double-integrator-closed-loop.json"),
            ("gains", "saturating-gains.json"),
            ("problem", "buffer-network.json"),
            ("region", "saturated-pendulum.json"),
            ("rules", "two-rules.json"),
            ("requirements", "requirements-large.json"),
        ];
        for (name, shipped_name) in kinds {
            inputs.put(&format!("{name}.json"), &text(&shipped(shipped_name)));
        }
        inputs.put("design.json", &text(xu2020_design()));
        inputs.put("cart-design.json", &text(double_integrator_design()));
        inputs.put("notes.txt", "mine\n");
        inputs.put("broken.json", "{ \"schema_version\": 1,");
        inputs.put("empty.json", "");
        inputs.put("list.json", "[1, 2]");
        inputs.put("run.csv", "time_s,x\n0,1\n1,one\n");
        inputs.put("program.dat-s", "1\n1\n2\n1\n1 1 1 1 x\n");
        inputs
    }

    fn put(&self, name: &str, contents: &str) -> PathBuf {
        write(self.folder.path(), name, contents)
    }

    /// Every file below the folder with its bytes.
    fn state(&self) -> Vec<(PathBuf, Vec<u8>)> {
        fn below(folder: &Path, out: &mut Vec<(PathBuf, Vec<u8>)>) {
            for name in names_in(folder) {
                let path = folder.join(name);
                match path.is_dir() {
                    true => {
                        out.push((path.clone(), Vec::new()));
                        below(&path, out);
                    }
                    false => out.push((path.clone(), std::fs::read(&path).expect("a file"))),
                }
            }
        }
        let mut out = Vec::new();
        below(self.folder.path(), &mut out);
        out
    }

    /// What is wrong with how a command refuses its arguments; `None` when nothing is.
    fn fault(&self, arguments: &[&str], said: &[&str]) -> Option<String> {
        let before = self.state();
        let output = command()
            .args(arguments)
            .current_dir(self.folder.path())
            .output();
        let run = Run::new(output.expect("the command runs"));
        let unmet = |what: &str| Some(format!("{arguments:?}: {what}: {run:#?}"));
        if run.status != Some(1) {
            return unmet("the exit status is not 1");
        }
        if !run.stdout.is_empty() || run.stderr.lines().count() != 1 {
            return unmet("more or less than one line");
        }
        if !run.stderr.starts_with("error: ") || run.stderr.contains("panicked") {
            return unmet("not an error line");
        }
        if let Some(part) = said.iter().find(|part| !run.stderr.contains(**part)) {
            return unmet(&format!("'{part}' is not said"));
        }
        // The name of a solver is no word of the implementation's language.
        assert_plain(&run.stderr.replace("structured", ""));
        (self.state() != before).then(|| format!("{arguments:?}: something was written"))
    }
}

#[track_caller]
fn assert_none(faults: Vec<String>, cases: usize, least: usize) {
    assert!(
        faults.is_empty(),
        "{} of {cases}:\n{}",
        faults.len(),
        faults.join("\n")
    );
    assert!(cases >= least, "{cases} cases");
}

#[test]
fn wrong_usage_of_every_verb_is_refused_in_one_line() {
    let inputs = Inputs::new();
    let faults = USAGE.iter().filter_map(|(arguments, said)| {
        let words: Vec<&str> = arguments.split_whitespace().collect();
        inputs.fault(&words, said)
    });
    assert_none(faults.collect(), USAGE.len(), 90);
}

#[test]
fn a_wrong_value_is_refused_by_every_verb_with_file_field_value_and_range() {
    let inputs = Inputs::new();
    let mut faults = Vec::new();
    let mut cases = 0;
    for (name, pointer, value, allowed) in wrong_values() {
        let mut file = json(&inputs.folder.path().join(format!("{name}.json")));
        set(&mut file, pointer, value);
        let path = inputs.put("wrong.json", &file.to_string());
        // The key that the line must name: the last of the place that is none of a list's numbers.
        let keys = pointer.rsplit('/');
        let key = keys.clone().find(|key| key.parse::<usize>().is_err());
        for reader in readers(name) {
            let (verb, more) = reader.split_first().expect("a verb");
            let arguments = [&[*verb, "wrong.json"][..], more].concat();
            let fault = inputs.fault(&arguments, &["wrong.json", allowed]);
            let named = |fault: &String| format!("{pointer} ({key:?}): {fault}");
            faults.extend(fault.as_ref().map(named));
            cases += 1;
        }
        std::fs::remove_file(path).expect("it is there");
    }
    assert_none(faults, cases, 250);
}
