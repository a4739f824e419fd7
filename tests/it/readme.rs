//! The README: every command that it shows runs and prints what it shows.

use std::path::Path;

use crate::support::*;

/// The test command runs this very test.
const NOT_RUN: [&str; 1] = ["cargo test --release --workspace"];

/// A command of the README and the output shown below it, if any.
#[derive(Debug)]
struct Shown {
    command: String,
    output: Vec<String>,
}

/// The commands of ```sh blocks (every line) and ```console blocks (lines after `$ `).
fn shown_commands(readme: &str) -> Vec<Shown> {
    let mut out: Vec<Shown> = Vec::new();
    let mut block: Option<&str> = None;
    for line in readme.lines() {
        match (line.strip_prefix("```"), block) {
            (Some(language), None) => block = Some(language),
            (Some(_), Some(_)) => block = None,
            (None, Some("sh")) if !line.is_empty() => out.push(Shown::new(line)),
            (None, Some("console")) => match line.strip_prefix("$ ") {
                Some(command) => out.push(Shown::new(command)),
                None => out
                    .last_mut()
                    .expect("a command")
                    .output
                    .push(line.to_string()),
            },
            _ => {}
        }
    }
    out
}

impl Shown {
    fn new(command: &str) -> Self {
        Shown {
            command: command.to_string(),
            output: Vec::new(),
        }
    }

    fn run(&self, folder: &Path) -> Run {
        let words: Vec<&str> = self.command.split_whitespace().collect();
        let arguments = match words.as_slice() {
            ["cargo", "run", "--release", "--", rest @ ..] => rest,
            ["steadfast" | "target/release/steadfast", rest @ ..] => rest,
            _ => panic!("this test cannot run `{}`", self.command),
        };
        let run = command().args(arguments).current_dir(folder).output();
        Run::new(run.expect("the command runs"))
    }
}

/// The lines that do not depend on the solver's path.
fn lasting<'a>(lines: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let varies = |line: &str| {
        line.is_empty() || line.starts_with("solver:") || line.starts_with("worst condition:")
    };
    lines
        .map(str::trim_end)
        .filter(|line| !varies(line))
        .collect()
}

/// Word for word the same, numbers to one percent.
fn alike(found: &str, shown: &str) -> bool {
    let (found, shown): (Vec<&str>, Vec<&str>) = (
        found.split_whitespace().collect(),
        shown.split_whitespace().collect(),
    );
    let words_alike = |(a, b): (&&str, &&str)| {
        let close = |a: f64, b: f64| (a - b).abs() <= 0.01 * b.abs();
        match (a.parse::<f64>(), b.parse::<f64>()) {
            (Ok(a), Ok(b)) => close(a, b),
            _ => a == b,
        }
    };
    found.len() == shown.len() && found.iter().zip(&shown).all(words_alike)
}

fn assert_prints(shown: &Shown, run: &Run) {
    let found = lasting(run.stdout.lines());
    let expected = lasting(shown.output.iter().map(String::as_str));
    assert_eq!(
        found.len(),
        expected.len(),
        "`{}`: {found:#?}",
        shown.command
    );
    for (found, expected) in found.iter().zip(expected) {
        assert!(
            alike(found, expected),
            "`{}`: {found} against {expected}",
            shown.command
        );
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir(to).expect("a folder");
    for name in names_in(from) {
        let (from, to) = (from.join(&name), to.join(&name));
        match from.is_dir() {
            true => copy(&from, &to),
            false => drop(std::fs::copy(from, to).expect("a copy")),
        }
    }
}

#[test]
fn every_command_of_the_readme_runs_and_prints_what_is_shown() {
    let folder = folder();
    copy(&repository().join("models"), &folder.path().join("models"));
    let commands = shown_commands(&text(&repository().join("README.md")));
    for shown in &commands {
        if NOT_RUN.contains(&shown.command.as_str()) {
            continue;
        }
        let run = shown.run(folder.path()).ends_with(0);
        if !shown.output.is_empty() {
            assert_prints(shown, &run);
        }
    }
    let is_shown = |command: &str| commands.iter().any(|shown| shown.command == command);
    assert!(is_shown(
        "cargo run --release -- synthesize models/xu2020.json -o design.json"
    ));
    assert!(is_shown("cargo test --release --workspace"));
}

#[test]
fn every_file_that_the_readme_names_exists() {
    let readme = text(&repository().join("README.md"));
    let links = readme
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next());
    let local: Vec<&str> = links.filter(|link| !link.contains("://")).collect();
    assert!(!local.is_empty());
    for link in local {
        let path = link.split('#').next().unwrap_or(link);
        assert!(repository().join(path).exists(), "README.md names {link}");
    }
}
