//! A result replaces files of its own kind only; targets are tried before long work; Ctrl-C says what is on the disk.

use std::path::{Path, PathBuf};
#[cfg(unix)]
use std::process::{Child, Command, Stdio};
#[cfg(unix)]
use std::time::{Duration, Instant};

use crate::support::refusals::assert_says;
use crate::support::*;
use serde_json::{json, Value};

/// A folder of a run of wu2018 of 5 seconds, and its scenario.
fn short_run(folder: &Path) -> (PathBuf, PathBuf) {
    let scenario = cut("wu2018.json", 5.0, folder);
    let run = folder.join("run");
    simulated(&scenario, None, &run);
    (scenario, run)
}

/// Commands that write one file, without it.
fn writers(folder: &Path) -> Vec<Vec<String>> {
    let (_, run) = short_run(folder);
    let cart = shipped("double-integrator.json");
    let cart = word(&cart);
    let network = shipped("buffer-network.json");
    let design = word(double_integrator_design());
    let gains = shipped("saturating-gains.json");
    let gains = word(&gains);
    let run = word(&run);
    let commands: [&[&str]; 10] = [
        &["synthesize", cart],
        &["synthesize", word(&network)],
        &["feasibility", cart],
        &["analyse", gains, "--model", cart],
        &["export", design, "--format", "c"],
        &["export", design, "--format", "csv"],
        &["export", design, "--format", "mat"],
        &["export", design, "--format", "sdpa"],
        &["export", run, "--format", "parquet"],
        &["report", run],
    ];
    let owned = commands
        .iter()
        .map(|words| words.iter().map(|word| word.to_string()).collect());
    owned.collect()
}

#[test]
fn a_file_of_another_kind_stays_as_it_is_unless_it_is_forced() {
    let folder = folder();
    let kept = [
        "notes.txt",
        "scenario.json",
        "table.csv",
        "index.html",
        "data.bin",
    ];
    let scenario = text(&shipped("wu2018.json"));
    let contents: [&[u8]; 5] = [
        b"remember the milk\n",
        scenario.as_bytes(),
        b"a,b\n1,2\n",
        b"<!DOCTYPE html>\n<html><body>mine</body></html>\n",
        &[0, 159, 146, 150, 255],
    ];
    for command in writers(folder.path()) {
        for (name, contents) in kept.into_iter().zip(contents) {
            let target = write(folder.path(), name, contents);
            let arguments = [
                command.clone(),
                vec!["-o".into(), word(&target).to_string()],
            ]
            .concat();
            let message = steadfast(&arguments).refusal();
            assert_says(&message, &[name, "holds", "--force"]);
            if name == "scenario.json" {
                assert_says(&message, &["holds a scenario file"]);
            }
            assert_eq!(std::fs::read(&target).unwrap(), contents, "{arguments:?}");
        }
        // What is empty has nothing to lose; the second time the file is of the verb's own kind.
        let target = write(folder.path(), "empty", "");
        let arguments = [
            command.clone(),
            vec!["-o".into(), word(&target).to_string()],
        ]
        .concat();
        for _ in 0..2 {
            let run = steadfast(&arguments);
            assert_eq!(run.status, Some(0), "{arguments:?}: {run:#?}");
        }
        let target = write(folder.path(), "forced.txt", "not for long");
        let forced = ["-o", word(&target), "--force"].map(String::from);
        steadfast([command, forced.to_vec()].concat()).ends_with(0);
        assert_ne!(std::fs::read(&target).unwrap(), b"not for long");
        for name in ["empty", "forced.txt"] {
            std::fs::remove_file(folder.path().join(name)).expect("it is there");
        }
    }
}

#[test]
fn files_of_another_kind_in_an_output_folder_stay_as_they_are() {
    let folder = folder();
    let (scenario, _) = short_run(folder.path());
    let scenario = word(&scenario);
    let compared = shipped("compare-wu2018.json");
    let compared = word(&compared);
    let other = shipped("compare-lei2022.json");
    let other = word(&other);
    let cases: [(&[&str], &str); 8] = [
        (&["simulate", scenario], "trajectory.csv"),
        (&["simulate", scenario], "report.html"),
        (
            &["sweep", scenario, "--vary", "duration_s=1,2"],
            "sweep.csv",
        ),
        (
            &["sweep", scenario, "--vary", "duration_s=1,2"],
            "sweep.json",
        ),
        (&["campaign", scenario, "--runs", "2"], "scenario.json"),
        (&["campaign", scenario, "--runs", "2"], "runs.parquet"),
        (
            &["compare", compared, other, "--without-faults"],
            "comparison.json",
        ),
        (
            &["compare", compared, other, "--without-faults"],
            "comparison.html",
        ),
    ];
    for (number, (command, name)) in cases.into_iter().enumerate() {
        let out = folder.path().join(format!("out{number}"));
        std::fs::create_dir(&out).expect("a folder");
        let mine = write(&out, name, "{\"mine\": 1}");
        let arguments = [command, &["-o", out.to_str().unwrap()]].concat();
        let message = steadfast(&arguments).refusal();
        assert_says(&message, &[name, "holds something else", "--force"]);
        assert_eq!(text(&mine), "{\"mine\": 1}");
        assert_eq!(names_in(&out), [name], "{arguments:?}");
    }
}

#[test]
fn an_input_is_never_replaced_not_even_by_force() {
    let folder = folder();
    let model = write(
        folder.path(),
        "model.json",
        text(&shipped("double-integrator.json")),
    );
    let model = word(&model);
    for verb in ["synthesize", "feasibility"] {
        let message = steadfast([verb, model, "-o", model, "--force"]).refusal();
        assert_says(&message, &["this is the input; it would be overwritten"]);
    }
}

/// Nothing can be written in /proc, whoever asks: the search of `tune` takes many seconds, its refusal none.
#[test]
#[cfg(target_os = "linux")]
fn a_target_that_cannot_be_written_is_refused_before_any_work() {
    let cart = shipped("double-integrator.json");
    let cart = word(&cart);
    let wu = shipped("wu2018.json");
    let wu = word(&wu);
    let large = shipped("requirements-large.json");
    let large = word(&large);
    let commands: [&[&str]; 6] = [
        &["tune", large, "-o", "/proc/out.json"],
        &["synthesize", cart, "-o", "/proc/out.json"],
        &["feasibility", cart, "-o", "/proc/out.json"],
        &["simulate", wu, "-o", "/proc/out"],
        &["campaign", wu, "--runs", "9", "-o", "/proc/out/deep"],
        &["sweep", wu, "--vary", "duration_s=1,2", "-o", "/proc/out"],
    ];
    for arguments in commands {
        let message = steadfast(arguments).refusal();
        assert_says(&message, &["/proc/out", "cannot be written"]);
    }
}

#[cfg(unix)]
fn started(arguments: &[&str]) -> Child {
    let mut command: Command = command();
    command
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command.spawn().expect("the command runs")
}

/// Sends Ctrl-C once something is there, and returns how the command ended.
#[cfg(unix)]
fn interrupted_when(child: Child, mut there: impl FnMut() -> bool) -> Run {
    let begun = Instant::now();
    while !there() {
        assert!(
            begun.elapsed() < Duration::from_secs(120),
            "it never was there"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    let id = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status();
    assert!(sent.expect("kill runs").success());
    Run::new(child.wait_with_output().expect("it ends"))
}

/// A cart that no force holds: the verdict is written at once, the search for what to relax takes longer.
#[cfg(unix)]
fn infeasible_cart(folder: &Path) -> PathBuf {
    let mut model = json(&shipped("double-integrator.json"));
    set(&mut model, "/plant/vertices/input_limit", json!([0.001]));
    set(&mut model, "/specs/must_contain", json!([[0.9, 0.9]]));
    write(folder, "weak.json", model.to_string())
}

#[test]
#[cfg(unix)]
fn an_interrupted_feasibility_names_the_certificate_that_it_has_written() {
    let folder = folder();
    let (model, out) = (
        infeasible_cart(folder.path()),
        folder.path().join("proof.json"),
    );
    let child = started(&["feasibility", word(&model), "-o", word(&out)]);
    let run = interrupted_when(child, || out.exists());
    if run.status == Some(2) {
        eprintln!("SKIPPED: the verb had ended before it could be interrupted");
        return;
    }
    let message = run.refusal();
    assert_eq!(
        message,
        format!("interrupted; written before: {}", out.display())
    );
    steadfast([Path::new("verify"), &out]).ends_with(0);
}

#[test]
#[cfg(unix)]
fn an_interrupted_search_says_that_nothing_was_written() {
    let folder = folder();
    let out = folder.path().join("tuned.json");
    // No candidate points so well, so that all are tried.
    let mut requirements = json(&shipped("requirements-large.json"));
    set(&mut requirements, "/limits/accuracy_deg", json!(0.0001));
    set(
        &mut requirements,
        "/search",
        json!({ "candidates": 100_000 }),
    );
    let requirements = write(folder.path(), "requirements.json", requirements.to_string());
    let child = started(&["tune", word(&requirements), "-o", word(&out)]);
    let begun = Instant::now();
    let run = interrupted_when(child, || begun.elapsed() > Duration::from_secs(1));
    assert_eq!(run.refusal(), "interrupted; nothing was written");
    assert_eq!(names_in(folder.path()), ["requirements.json"]);
}

#[test]
#[cfg(unix)]
fn an_interrupted_run_says_that_nothing_was_written() {
    let folder = folder();
    let mut scenario: Value = json(&shipped("wu2018.json"));
    scenario["duration_s"] = json!(1_000_000);
    scenario
        .as_object_mut()
        .expect("an object")
        .remove("metrics");
    let scenario = write(folder.path(), "long.json", scenario.to_string());
    let out = folder.path().join("run");
    let child = started(&["simulate", word(&scenario), "-o", word(&out)]);
    let begun = Instant::now();
    let run = interrupted_when(child, || begun.elapsed() > Duration::from_secs(1));
    assert_eq!(run.refusal(), "interrupted; nothing was written");
    assert!(!out.exists());
}
