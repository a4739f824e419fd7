//! `steadfast sweep`: a sweep that was ended goes on, and its files do not tell.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::Arc;
use std::time::{Duration, Instant};

use steadfast::batch::engine::{Control, Threads};
use steadfast::batch::sweep::points::{PointStore, SweepIdentity};
use steadfast::batch::sweep::subject::Subject;
use steadfast::batch::sweep::{run, SweepError};
use steadfast::batch::variation::axis::Axis;
use steadfast::batch::variation::grid::Grid;
use steadfast::scenario::Scenario;

use crate::support::sweeps::{everything_in, scenario, sweep};
use crate::support::*;

const JOURNAL: &str = "points.jsonl";

/// Starts a sweep and does not wait for it.
#[cfg(unix)]
fn start(file: &Path, vary: &str, output: &Path) -> Child {
    let mut command = command();
    let command = command.arg("sweep").arg(file).args(["--vary", vary]);
    let command = command.arg("-o").arg(output).args(["--jobs", "2"]);
    let command = command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the command runs")
}

/// Whole lines of the journal.
fn lines(output: &Path) -> usize {
    let bytes = fs::read(output.join(JOURNAL)).unwrap_or_default();
    bytes.iter().filter(|byte| **byte == b'\n').count()
}

/// Waits for so many lines, or for the end of the sweep.
fn wait_for(child: &mut Child, output: &Path, count: usize) {
    let begun = Instant::now();
    while lines(output) < count && child.try_wait().expect("a process").is_none() {
        assert!(begun.elapsed() < Duration::from_secs(100), "too slow");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A finished sweep: the folder, the scenario, the files.
fn finished(folder: &Path, vary: &str) -> (PathBuf, PathBuf) {
    let file = scenario(folder);
    let output = folder.join("whole");
    sweep(&file, &[vary], &output, &[]).ends_with(0);
    (file, output)
}

/// A sweep that the kernel kills (SIGXFSZ) in the middle of the write that takes the journal past so many blocks of
/// 512 bytes.
#[cfg(target_os = "linux")]
fn killed_at(file: &Path, vary: &str, output: &Path, blocks: u64) {
    use std::os::unix::process::ExitStatusExt;
    let limited = format!("ulimit -f {blocks}; exec \"$0\" \"$@\"");
    let mut shell = std::process::Command::new("sh");
    let shell = shell.args(["-c", &limited, env!("CARGO_BIN_EXE_steadfast"), "sweep"]);
    let shell = shell.arg(file).args(["--vary", vary, "--jobs", "2", "-o"]);
    let run = shell.arg(output).output().expect("a shell");
    assert!(run.status.signal().is_some(), "{run:?}");
    let journal = fs::metadata(output.join(JOURNAL)).expect("a journal");
    assert!(journal.len() <= blocks * 512, "{journal:?}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_sweep_killed_again_and_again_ends_with_the_same_bytes() {
    let folder = folder();
    let vary = "relative=0.3:0.7:40";
    let (file, whole) = finished(folder.path(), vary);
    let output = folder.path().join("killed");
    let blocks = fs::metadata(whole.join(JOURNAL)).expect("a journal").len() / 512;
    for part in [0.1, 0.3, 0.32, 0.6, 0.9] {
        killed_at(&file, vary, &output, (blocks as f64 * part) as u64);
        assert!(!output.join("sweep.csv").exists());
    }
    let run = sweep(&file, &[vary], &output, &["--json"]).ends_with(0);
    assert!(run.json()["resumed"].as_u64() >= Some(24), "{run:?}");
    assert_eq!(everything_in(&output), everything_in(&whole));
}

#[cfg(target_os = "linux")]
#[test]
fn a_killed_sweep_of_a_model_ends_with_the_same_bytes() {
    let folder = folder();
    let (vary, file) = ("phi=0.1:0.3:9", shipped("double-integrator.json"));
    let whole = folder.path().join("whole");
    sweep(&file, &[vary], &whole, &["--jobs", "1"]).ends_with(0);
    let blocks = fs::metadata(whole.join(JOURNAL)).expect("a journal").len() / 512;
    let output = folder.path().join("killed");
    killed_at(&file, vary, &output, blocks / 2);
    assert!(!output.join("sweep.csv").exists());
    sweep(&file, &[vary], &output, &[]).ends_with(0);
    assert_eq!(everything_in(&output), everything_in(&whole));
}

#[test]
fn a_torn_last_line_is_dropped() {
    let folder = folder();
    let vary = "relative=0.4:0.6:4";
    let (file, whole) = finished(folder.path(), vary);
    let journal = text(&whole.join(JOURNAL));
    let output = folder.path().join("torn");
    let header = journal.find('\n').expect("a line") + 1;
    // In the header, after it, in the first point, before its line's end, in the last point.
    let first = header + journal[header..].find('\n').expect("a line");
    for cut in [5, header, header + 20, first, journal.len() - 3] {
        fs::create_dir_all(&output).expect("a folder");
        write(&output, JOURNAL, &journal[..cut]);
        let run = sweep(&file, &[vary], &output, &["--json"]).ends_with(0);
        let whole_lines = journal[..cut].matches('\n').count();
        assert_eq!(run.json()["resumed"], whole_lines.saturating_sub(1));
        assert_eq!(
            everything_in(&output),
            everything_in(&whole),
            "cut at {cut}"
        );
        fs::remove_dir_all(&output).expect("removed");
    }
}

#[test]
fn a_finished_sweep_is_not_run_again_but_its_files_are_restored() {
    let folder = folder();
    let vary = "relative=0.4:0.6:3";
    let (file, whole) = finished(folder.path(), vary);
    let before = everything_in(&whole);
    fs::remove_file(whole.join("sweep.html")).expect("removed");
    write(&whole, "sweep.csv", "spoilt");
    let run = sweep(&file, &[vary], &whole, &[]).ends_with(0);
    assert!(
        run.stdout.contains("points: 3 (3 were done before)"),
        "{run:?}"
    );
    assert_eq!(everything_in(&whole), before);
}

#[test]
fn the_points_of_another_sweep_are_refused_unless_they_are_to_go() {
    let folder = folder();
    let vary = "relative=0.4,0.5";
    let (file, output) = finished(folder.path(), vary);
    let before = everything_in(&output);
    let other = write(folder.path(), "other.json", text(&file) + "\n");
    let cases = [
        (&file, "relative=0.4,0.6", "the --vary differs"),
        (&other, vary, "the file differs"),
    ];
    for (file, vary, difference) in cases {
        let message = sweep(file, &[vary], &output, &[]).refusal();
        assert!(message.contains(difference), "{message}");
        assert!(message.contains("--restart"), "{message}");
        assert_eq!(everything_in(&output), before);
    }
    sweep(&file, &["relative=0.4,0.6"], &output, &["--restart"]).ends_with(0);
    assert_ne!(everything_in(&output), before);
    assert_eq!(lines(&output), 3);
}

#[test]
fn another_solver_is_another_sweep() {
    let folder = folder();
    let output = folder.path().join("out");
    let file = shipped("double-integrator.json");
    sweep(&file, &["phi=0.1"], &output, &[]).ends_with(0);
    let more = ["--solver", "structured"];
    let message = sweep(&file, &["phi=0.1"], &output, &more).refusal();
    assert!(message.contains("the solver differs"), "{message}");
}

#[test]
fn a_damaged_journal_is_refused_with_its_line() {
    let folder = folder();
    let vary = "relative=0.4:0.6:3";
    let (file, output) = finished(folder.path(), vary);
    let journal = text(&output.join(JOURNAL));
    let lines: Vec<&str> = journal.lines().collect();
    let with = |line: &str| [lines[0], lines[1], line, lines[3]].join("\n") + "\n";
    let cases = [
        (with("{\"point\": 1"), "line 3"),
        (
            with(&lines[2].replace("\"point\":1", "\"point\":7")),
            "no point 7",
        ),
        (with(&lines[2].replace("\"point\"", "\"pint\"")), "line 3"),
        ("hello\n".to_string(), "line 1"),
    ];
    for (contents, part) in cases {
        write(&output, JOURNAL, contents);
        let message = sweep(&file, &[vary], &output, &[]).refusal();
        assert!(message.contains(part), "{message}");
    }
}

#[cfg(unix)]
#[test]
fn two_sweeps_do_not_write_into_one_folder() {
    use rustix::fs::{flock, FlockOperation};
    let folder = folder();
    let vary = "relative=0.4,0.5";
    let (file, output) = finished(folder.path(), vary);
    let journal = fs::File::open(output.join(JOURNAL)).expect("a file");
    flock(&journal, FlockOperation::NonBlockingLockExclusive).expect("a lock");
    let message = sweep(&file, &[vary], &output, &[]).refusal();
    assert!(message.contains("in use by another sweep"), "{message}");
    drop(journal);
    sweep(&file, &[vary], &output, &[]).ends_with(0);
}

/// Stopped by its own flag as soon as the fourth point is done: no clock plays a part.
#[test]
fn a_sweep_stopped_after_four_points_keeps_four_and_goes_on_from_them() {
    let folder = folder();
    let vary = "relative=0.4:0.6:9";
    let (file, whole) = finished(folder.path(), vary);
    let output = folder.path().join("stopped");
    fs::create_dir(&output).expect("a folder");
    let text = text(&file);
    let (content, _) = Scenario::read(&text).expect("a scenario");
    let subject = Subject::scenario(&content, None);
    let axis = Axis::parse(vary).expect("an axis");
    let grid = Grid::new(&subject.file, &[axis]).expect("a grid");
    let identity = SweepIdentity::new(&text, &subject, &grid);
    let store = PointStore::open(&output, &identity, &grid, false).expect("a journal");
    let (count, stop) = (AtomicUsize::new(0), Arc::new(AtomicBool::new(false)));
    let done = || {
        if count.fetch_add(1, Ordering::Relaxed) == 3 {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let control = Control {
        done: &done,
        stop: Arc::clone(&stop),
    };
    let threads = Threads::new(1).expect("a thread");
    let ended = run(&subject, &grid, &threads, &store, &control);
    assert!(
        matches!(ended, Err(SweepError::Interrupted(_))),
        "{ended:?}"
    );
    assert_eq!((store.done(), lines(&output)), (4, 5));
    drop(store);
    let again = sweep(&file, &[vary], &output, &["--json"]).ends_with(0);
    assert_eq!(again.json()["resumed"], 4);
    assert_eq!(everything_in(&output), everything_in(&whole));
}

/// So many points that the sweep cannot end before the signal comes, whenever that is.
#[cfg(unix)]
#[test]
fn control_c_keeps_what_is_done_and_says_how_to_go_on() {
    let folder = folder();
    let (vary, file) = ("phi=0.1:0.3:50000", shipped("double-integrator.json"));
    let output = folder.path().join("out");
    let mut child = start(&file, vary, &output);
    wait_for(&mut child, &output, 4);
    let kill = format!("kill -INT {}", child.id());
    let sent = std::process::Command::new("sh")
        .args(["-c", &kill])
        .status();
    assert!(sent.expect("a shell").success());
    let message = Run::new(child.wait_with_output().expect("an end")).refusal();
    let done = lines(&output) - 1;
    assert!((3..50_000).contains(&done), "{done} points are done");
    let expected = format!("interrupted; {done} of 50000 points are done and kept in");
    assert!(message.contains(&expected), "{message}");
    assert!(
        message.contains("the same command resumes there"),
        "{message}"
    );
    assert_eq!(names_in(&output), [JOURNAL]);
}

/// A limit on the size of files stands in for a full disk: a line is cut in two in both cases.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_one_clear_sentence_and_costs_no_point() {
    let folder = folder();
    let vary = "relative=0.4:0.6:12";
    let (file, whole) = finished(folder.path(), vary);
    let output = folder.path().join("full");
    let limited = "trap '' XFSZ; ulimit -f 8; exec \"$0\" \"$@\"";
    let mut shell = std::process::Command::new("sh");
    let shell = shell.args(["-c", limited, env!("CARGO_BIN_EXE_steadfast"), "sweep"]);
    let shell = shell.arg(&file).args(["--vary", vary, "-o"]).arg(&output);
    let message = Run::new(shell.output().expect("a shell")).refusal();
    assert!(
        message.contains("points.jsonl: cannot be written"),
        "{message}"
    );
    assert!(message.contains("the same command goes on"), "{message}");
    let kept = lines(&output).saturating_sub(1);
    assert!((1..12).contains(&kept), "{kept} points are kept");
    let run = sweep(&file, &[vary], &output, &["--json"]).ends_with(0);
    assert_eq!(run.json()["resumed"], kept);
    assert_eq!(everything_in(&output), everything_in(&whole));
}

#[cfg(target_os = "linux")]
#[test]
fn a_journal_that_is_a_device_is_refused() {
    let folder = folder();
    let file = scenario(folder.path());
    let output = folder.path().join("out");
    fs::create_dir(&output).expect("a folder");
    std::os::unix::fs::symlink("/dev/full", output.join(JOURNAL)).expect("a link");
    let message = sweep(&file, &["relative=0.4,0.5"], &output, &[]).refusal();
    assert!(message.contains("it is not an ordinary file"), "{message}");
}
