//! The book: every command that it shows runs and prints what it shows and nothing else, every link leads somewhere,
//! every page is listed.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::process::Command;

const FENCE: &str = "```";

/// Commands that are shown but not run: they build, fetch, or need other programs.
#[cfg(unix)]
const NOT_RUN: [&str; 8] = [
    "git clone ",
    "cd ",
    "cargo build",
    "cargo test",
    "cargo install",
    "cargo bench",
    "csdp ",
    "sdpa ",
];

/// Programs that a command may start with.
#[cfg(unix)]
const RUN: [&str; 6] = ["steadfast ", "sed ", "head ", "cp ", "cc ", "flight/"];

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn source() -> PathBuf {
    repository().join("docs/src")
}

fn text(page: &str) -> String {
    fs::read_to_string(source().join(page)).unwrap_or_else(|error| panic!("{page}: {error}"))
}

/// Every page on disk but the summary.
fn pages() -> BTreeSet<String> {
    let entries = fs::read_dir(source()).expect("docs/src is a folder");
    let names = entries.map(|entry| {
        let name = entry.expect("an entry").file_name();
        name.into_string().expect("a name in UTF-8")
    });
    names
        .filter(|name| name.ends_with(".md") && name != "SUMMARY.md")
        .collect()
}

/// The pages of the summary, in its order.
fn listed() -> Vec<String> {
    links(&text("SUMMARY.md"))
}

/// A fenced block with the comment on the line before it.
#[derive(Debug)]
struct Block {
    language: String,
    comment: String,
    lines: Vec<String>,
}

/// The fenced blocks of a page.
fn blocks(page: &str) -> Vec<Block> {
    let mut out = Vec::new();
    let mut open: Option<Block> = None;
    let mut previous = String::new();
    for line in text(page).lines() {
        match (&mut open, line.strip_prefix(FENCE)) {
            (None, Some(language)) => {
                open = Some(Block {
                    language: language.to_string(),
                    comment: previous.clone(),
                    lines: Vec::new(),
                });
            }
            (Some(_), Some(rest)) => {
                assert!(rest.is_empty(), "{page}: a fence is closed with {line}");
                out.extend(open.take());
            }
            (Some(block), None) => block.lines.push(line.to_string()),
            (None, None) => previous = line.to_string(),
        }
    }
    assert!(open.is_none(), "{page}: a fence is not closed");
    out
}

/// The page without its fenced blocks and code spans.
fn prose(page: &str) -> String {
    let mut fenced = false;
    let mut out = String::new();
    for line in text(page).lines() {
        if line.starts_with(FENCE) {
            fenced = !fenced;
        } else if !fenced {
            let outside = line.split('`').step_by(2);
            out.extend(outside.chain(["\n"]));
        }
    }
    out
}

/// Targets of the Markdown links of a text.
fn links(text: &str) -> Vec<String> {
    let rest = text.split("](").skip(1);
    rest.filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target.to_string())
        .collect()
}

/// The anchors that mdbook gives to the headings of a page.
fn anchors(page: &str) -> BTreeSet<String> {
    let mut fenced = false;
    let mut out = BTreeSet::new();
    for line in text(page).lines() {
        fenced ^= line.starts_with(FENCE);
        let heading = line.trim_start_matches('#');
        if !fenced && line.starts_with('#') {
            let kept = heading.trim().chars().filter_map(|c| match c {
                ' ' => Some('-'),
                c if c.is_alphanumeric() || c == '_' || c == '-' => Some(c.to_ascii_lowercase()),
                _ => None,
            });
            let anchor: String = kept.collect();
            assert!(
                out.insert(anchor),
                "{page}: the heading '{line}' occurs twice"
            );
        }
    }
    out
}

#[test]
fn the_summary_lists_every_page_once() {
    let listed = listed();
    let distinct: BTreeSet<String> = listed.iter().cloned().collect();
    assert_eq!(distinct.len(), listed.len(), "a page is listed twice");
    assert_eq!(distinct, pages());
}

#[test]
fn every_link_inside_the_book_leads_to_a_page_and_a_heading() {
    let mut followed = 0;
    for page in pages() {
        for link in links(&prose(&page)) {
            if link.contains("://") {
                continue;
            }
            let (file, anchor) = link.split_once('#').unwrap_or((&link, ""));
            let target = if file.is_empty() { &page } else { file };
            assert!(pages().contains(target), "{page} links to {link}");
            let found = anchor.is_empty() || anchors(target).contains(anchor);
            assert!(
                found,
                "{page} links to {link}, but {target} has {:#?}",
                anchors(target)
            );
            followed += 1;
        }
    }
    assert!(followed > 20, "{followed} links");
}

/// A command of a console block with the output shown below it.
#[cfg(unix)]
#[derive(Debug)]
struct Shown {
    command: String,
    output: Vec<String>,
}

#[cfg(unix)]
fn shown(block: &Block) -> Vec<Shown> {
    let mut out: Vec<Shown> = Vec::new();
    for line in &block.lines {
        match (line.strip_prefix("$ "), out.last_mut()) {
            (Some(command), _) => out.push(Shown {
                command: command.replace("cargo run --release -- ", "steadfast "),
                output: Vec::new(),
            }),
            (None, Some(last)) => last.output.push(line.clone()),
            (None, None) => panic!("a console block starts with '{line}'"),
        }
    }
    out
}

/// What a comment such as `<!-- exit: 2 -->` says about a block.
fn comment<'a>(block: &'a Block, key: &str) -> Option<&'a str> {
    let inner = block.comment.strip_prefix("<!-- ")?.strip_suffix(" -->")?;
    inner.strip_prefix(key)?.strip_prefix(": ")
}

/// A line with its numbers, its runs of spaces and the solver's own words taken out, and a worst
/// condition's name.
#[cfg(unix)]
fn essence(line: &str) -> String {
    let line = match line.strip_prefix("worst condition:") {
        Some(_) => "worst condition: some",
        None => line,
    };
    let line = match line.split_once("smallest margin") {
        Some((start, _)) => start,
        None => line,
    };
    let number = |word: &str| {
        let bare = word.trim_matches(|c: char| ",;:()[]%".contains(c));
        let solver = [
            "Solved",
            "AlmostSolved",
            "NumericalError",
            "InsufficientProgress",
        ];
        bare.parse::<f64>().is_ok() || solver.contains(&bare)
    };
    let words = line.split_whitespace();
    let kept: Vec<&str> = words
        .map(|word| if number(word) { "#" } else { word })
        .collect();
    kept.join(" ")
}

/// What differs between the lines shown and those printed: every line shown is printed, and every line printed is
/// shown, where any is. A line of three dots stands for any others, and one line of a solver for all of its lines: how
/// many there are depends on the processor.
#[cfg(unix)]
fn differences(shown: &[String], printed: &str) -> Vec<String> {
    const OTHERS: &str = "...";
    let essences = |lines: &mut dyn Iterator<Item = &str>| -> BTreeSet<String> {
        lines.map(essence).collect()
    };
    let all_printed = essences(&mut printed.lines());
    let all_shown = essences(&mut shown.iter().map(String::as_str));
    let missing = shown.iter().map(String::as_str);
    let missing = missing.filter(|line| *line != OTHERS && !all_printed.contains(&essence(line)));
    let mut out: Vec<String> = missing
        .map(|line| format!("shown, not printed: {line}"))
        .collect();
    if shown.is_empty() || shown.iter().any(|line| line == OTHERS) {
        return out;
    }
    let solver = |line: &str| line.starts_with("solver: ");
    let any_solver = shown.iter().any(|line| solver(line));
    let unseen = printed.lines();
    let unseen = unseen.filter(|line| !all_shown.contains(&essence(line)));
    let unseen = unseen.filter(|line| !(any_solver && solver(line)));
    out.extend(unseen.map(|line| format!("printed, not shown: {line}")));
    out
}

#[cfg(unix)]
#[test]
fn a_line_that_the_book_lacks_and_one_that_is_not_printed_are_found() {
    let lines = |text: &str| -> Vec<String> { text.lines().map(str::to_string).collect() };
    let printed = "solver: a\nsolver: b\ngamma: 1.5\nverdict: PROVED\n";
    let whole = lines("solver: a\ngamma: 1.4\nverdict: PROVED");
    assert_eq!(differences(&whole, printed), Vec::<String>::new());
    let lacking = lines("solver: a\nverdict: PROVED");
    assert_eq!(
        differences(&lacking, printed),
        ["printed, not shown: gamma: 1.5"]
    );
    let wrong = lines("solver: a\ngamma: 1.4\nxi: 3\nverdict: PROVED");
    assert_eq!(differences(&wrong, printed), ["shown, not printed: xi: 3"]);
    for open in ["verdict: PROVED\n...", ""] {
        assert_eq!(differences(&lines(open), printed), Vec::<String>::new());
    }
}

#[cfg(unix)]
fn assert_prints(page: &str, shown: &Shown, printed: &str) {
    let found = differences(&shown.output, printed);
    assert!(
        found.is_empty(),
        "{page}: `{}`: {found:#?}; it prints\n{printed}",
        shown.command
    );
}

#[cfg(unix)]
fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("an entry");
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy_folder(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).expect("a copy");
        }
    }
}

/// A copy of models/ with the built program on the path.
#[cfg(unix)]
struct Desk {
    folder: tempfile::TempDir,
}

#[cfg(unix)]
impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        copy_folder(&repository().join("models"), &folder.path().join("models"));
        let programs = folder.path().join("programs");
        fs::create_dir(&programs).expect("a folder");
        let program = env!("CARGO_BIN_EXE_steadfast");
        std::os::unix::fs::symlink(program, programs.join("steadfast")).expect("a link");
        Desk { folder }
    }

    /// Runs a command line; its exit status and what it prints.
    fn run(&self, command: &str) -> (Option<i32>, String) {
        let path = std::env::var("PATH").unwrap_or_default();
        let programs = self.folder.path().join("programs");
        let run = Command::new("sh")
            .args(["-c", command])
            .current_dir(self.folder.path())
            .env("PATH", format!("{}:{path}", programs.display()))
            .output();
        let run = run.expect("a shell");
        let out = String::from_utf8(run.stdout).expect("text");
        let err = String::from_utf8(run.stderr).expect("text");
        (run.status.code(), out + &err)
    }

    /// Runs the commands of a console block. The status in its comment is that of its last command.
    fn check(&self, page: &str, block: &Block) -> usize {
        let expected = comment(block, "exit").map_or(0, |status| status.parse().expect("a status"));
        let commands = shown(block);
        let mut runs = 0;
        for (index, shown) in commands.iter().enumerate() {
            let command = shown.command.as_str();
            if NOT_RUN.iter().any(|start| command.starts_with(start)) {
                assert!(shown.output.is_empty(), "{page}: `{command}` is not run");
                continue;
            }
            let known = RUN.iter().any(|start| command.starts_with(start));
            assert!(known, "{page}: this test cannot run `{command}`");
            let status = if index + 1 == commands.len() {
                expected
            } else {
                0
            };
            let (found, printed) = self.run(command);
            assert_eq!(found, Some(status), "{page}: `{command}` prints {printed}");
            assert_prints(page, shown, &printed);
            runs += usize::from(command.starts_with("steadfast "));
        }
        runs
    }
}

/// The pages are read in their order, by one reader: a later page may use files of an earlier one.
#[cfg(unix)]
#[test]
fn every_command_of_the_book_runs_and_prints_what_is_shown() {
    let desk = Desk::new();
    let mut runs = 0;
    for page in listed() {
        for block in blocks(&page) {
            if block.language == "console" {
                runs += desk.check(&page, &block);
            } else if let Some(name) = comment(&block, "file") {
                let contents = block.lines.join("\n") + "\n";
                fs::write(desk.folder.path().join(name), contents).expect("a file");
            }
        }
    }
    assert!(runs >= 10, "{runs} commands");
}
