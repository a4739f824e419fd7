//! `steadfast campaign` and `merge`: the same bytes however the runs are made.

mod damaged;
mod disk;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use crate::support::*;
use serde_json::{json, Value};
use steadfast::batch::campaign::record::CampaignFile;
use steadfast::batch::campaign::statistics::quantiles;
use steadfast::batch::campaign::table::{column_f64, column_names, column_text};

/// Wu's campaign, shorter, with a requirement that some runs miss.
fn short(folder: &Path, sampling: &str) -> PathBuf {
    let mut file = json(&shipped("wu2018-campaign.json"));
    set(&mut file, "/duration_s", json!(60));
    set(&mut file, "/metrics/tail_s", json!(20));
    set(&mut file, "/output", json!({ "interval_s": 1 }));
    set(&mut file, "/dispersions/sampling", json!(sampling));
    let requirements = json!([
        { "metric": "triggers", "at_most": 21 },
        { "metric": "max_rate", "at_most": 0.009 },
    ]);
    set(&mut file, "/requirements", requirements);
    write(folder, "short.json", file.to_string())
}

fn arguments(file: &Path, runs: u64, output: &Path, more: &[&str]) -> Vec<String> {
    let mut arguments = vec!["campaign".to_string(), file.display().to_string()];
    arguments.extend(["--runs".to_string(), runs.to_string()]);
    arguments.extend(["-o".to_string(), output.display().to_string()]);
    arguments.extend(more.iter().map(|text| text.to_string()));
    arguments
}

fn campaign(file: &Path, runs: u64, output: &Path, more: &[&str]) -> Run {
    steadfast(arguments(file, runs, output, more))
}

/// Every file of a folder with its bytes.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut out = BTreeMap::new();
    for name in names_in(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            for (inner, bytes) in contents(&path) {
                out.insert(format!("{name}/{inner}"), bytes);
            }
        } else {
            out.insert(name, fs::read(&path).expect("a file"));
        }
    }
    out
}

#[track_caller]
fn assert_same(one: &Path, other: &Path) {
    let (one, other) = (contents(one), contents(other));
    let names = |all: &BTreeMap<String, Vec<u8>>| all.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&one), names(&other));
    for (name, bytes) in &one {
        assert!(other[name] == *bytes, "{name} differs");
    }
}

#[test]
fn the_result_does_not_depend_on_threads_or_shards() {
    let folder = folder();
    let file = short(folder.path(), "latin_hypercube");
    let at = |name: &str| folder.path().join(name);
    let keep = ["--seed", "5", "--keep", "4"];
    let more = |others: &[&'static str]| [&keep[..], others].concat();
    campaign(&file, 300, &at("one"), &more(&["--jobs", "1"])).ends_with(2);
    campaign(&file, 300, &at("two"), &more(&["--jobs", "2"])).ends_with(2);
    assert_same(&at("one"), &at("two"));
    let record = CampaignFile::read(&at("one")).expect("a record");
    let results = record.results.expect("complete");
    assert!(
        results.failures > 4 && results.failures < 296,
        "{results:?}"
    );
    assert_eq!(
        (results.kept.len() as u64, results.not_kept),
        (4, results.failures - 4)
    );
    assert_eq!(names_in(&at("one/failed")).len(), 4);
    for shard in ["1/3", "2/3", "3/3"] {
        let name = format!("shard{}", &shard[..1]);
        let run = campaign(&file, 300, &at(&name), &more(&["--shard", shard]));
        assert!(matches!(run.status, Some(0 | 2)), "{run:?}");
    }
    let merge = |names: &[&str], to: &str| {
        let mut arguments = vec!["merge".to_string()];
        arguments.extend(names.iter().map(|name| at(name).display().to_string()));
        let to = at(to).display().to_string();
        arguments.extend(["--keep".into(), "4".into(), "-o".into(), to]);
        steadfast(arguments)
    };
    merge(&["shard3", "shard1", "shard2"], "merged").ends_with(2);
    assert_same(&at("one"), &at("merged"));
    let refusal = merge(&["shard3", "shard1"], "gap").refusal();
    assert!(refusal.contains("no folder holds the runs"), "{refusal}");
    let refusal = merge(&["shard1", "shard2", "shard2", "shard3"], "twice").refusal();
    assert!(refusal.contains("both hold run"), "{refusal}");
    campaign(&file, 300, &at("other"), &["--seed", "6", "--shard", "2/3"]);
    let refusal = merge(&["shard1", "other", "shard3"], "mixed").refusal();
    assert!(refusal.contains("another campaign"), "{refusal}");
    assert!(refusal.contains("seed"), "{refusal}");
}

#[test]
fn every_run_can_be_made_alone_and_is_the_very_same() {
    for sampling in ["independent", "latin_hypercube", "sobol"] {
        let folder = folder();
        let file = short(folder.path(), sampling);
        let out = folder.path().join("out");
        let run = campaign(&file, 40, &out, &["--seed", "9", "--json"]).ends_with(2);
        let results = run.json();
        let runs = out.join("runs.parquet");
        for index in [0usize, 17, 39] {
            let text = index.to_string();
            let alone = steadfast([
                "simulate",
                word(&file),
                "--run-index",
                &text,
                "--seed",
                "9",
                "--runs",
                "40",
                "--json",
            ]);
            let summary: Value = serde_json::from_str(&alone.stdout).expect("a summary");
            for metric in [
                "triggers",
                "max_rate",
                "impulse",
                "final_error_deg",
                "settle_seconds",
            ] {
                let column = column_f64(&runs, metric).expect("a column");
                assert_eq!(
                    column[index],
                    summary[metric].as_f64(),
                    "{sampling} {index} {metric}"
                );
            }
            let verdict = column_text(&runs, "verdict").expect("a column");
            assert_eq!(verdict[index].as_deref(), summary["verdict"].as_str());
        }
        let kept = results["kept"][0].as_u64().expect("a failed run");
        let kept_folder = out.join(format!("failed/run-{kept:06}"));
        let again = folder.path().join("again");
        let (text, to) = (kept.to_string(), again.display().to_string());
        let file = file.display().to_string();
        let index = [
            "--run-index",
            &text,
            "--seed",
            "9",
            "--runs",
            "40",
            "-o",
            &to,
        ];
        steadfast([&["simulate", &file][..], &index].concat()).ends_with(2);
        let same = |name: &str, other: &Path| {
            let bytes = fs::read(kept_folder.join(name)).expect("a kept file");
            assert!(
                bytes == fs::read(other.join(name)).expect("a file"),
                "{name}"
            );
        };
        same("trajectory.csv", &again);
        same("summary.json", &again);
        let resolved = kept_folder.join("scenario.json").display().to_string();
        let third = folder.path().join("third");
        let to = third.display().to_string();
        steadfast(["simulate", &resolved, "-o", &to]).ends_with(2);
        same("trajectory.csv", &third);
        same("summary.json", &third);
    }
}

#[test]
fn the_record_says_what_the_table_holds() {
    let folder = folder();
    let file = short(folder.path(), "sobol");
    let out = folder.path().join("out");
    let run = campaign(&file, 64, &out, &["--json"]).ends_with(2);
    let report = run.json();
    let runs = out.join("runs.parquet");
    assert_eq!(report["runs"], 64);
    let passed = column_f64(&runs, "passed").expect("a column");
    let passes = passed.iter().flatten().sum::<f64>();
    assert_eq!(report["failures"].as_f64(), Some(64.0 - passes));
    assert_eq!(report["pass_rate"].as_f64(), Some(passes / 64.0));
    let (low, high) = (
        number(&report, "/pass_rate_interval/lower"),
        number(&report, "/pass_rate_interval/upper"),
    );
    assert!(low < passes / 64.0 && passes / 64.0 < high);
    let triggers = column_f64(&runs, "triggers").expect("a column");
    let found = quantiles(&triggers).expect("values");
    for (name, value) in [
        ("min", found.min),
        ("median", found.median),
        ("p95", found.p95),
        ("max", found.max),
    ] {
        assert_eq!(report["metrics"]["triggers"][name].as_f64(), Some(value));
    }
    let over = triggers
        .iter()
        .flatten()
        .filter(|count| **count > 21.0)
        .count();
    assert_eq!(report["requirements"][0]["missed"], over);
    let margin = column_f64(&runs, "worst_margin").expect("a column");
    for (margin, passed) in margin.iter().zip(&passed) {
        assert_eq!(margin.expect("a margin") >= 0.0, *passed == Some(1.0));
    }
    // The last time of the profile is the end of the run.
    let profiles = out.join("profiles.parquet");
    let last = column_f64(&profiles, "error_deg_100").expect("a column");
    let ends = column_f64(&runs, "final_error_deg").expect("a column");
    for (profile, summary) in last.iter().zip(&ends) {
        let (profile, summary) = (profile.expect("a value"), summary.expect("a value"));
        assert!(
            (profile - summary).abs() <= 1e-6 * summary,
            "{profile} {summary}"
        );
    }
    let start = column_f64(&profiles, "error_deg_000").expect("a column");
    assert!(start
        .iter()
        .flatten()
        .all(|angle| (0.0..=20.0).contains(angle)));
    let names = column_names(&runs).expect("a table");
    assert_eq!(
        names
            .iter()
            .filter(|name| name.starts_with("drawn."))
            .count(),
        4 + 3 + 6 + 1 + 1
    );
}

#[test]
fn a_campaign_killed_again_and_again_ends_with_the_same_bytes() {
    let folder = folder();
    let file = short(folder.path(), "independent");
    let (whole, broken) = (folder.path().join("whole"), folder.path().join("broken"));
    let keep = ["--keep", "2", "--jobs", "2"];
    campaign(&file, 600, &whole, &keep).ends_with(2);
    let parts = || fs::read_dir(broken.join("parts")).map_or(0, Iterator::count);
    let mut interrupted = 0;
    for _ in 0..5 {
        let mut child = command()
            .args(arguments(&file, 600, &broken, &keep))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the command runs");
        let before = parts();
        while child.try_wait().expect("a status").is_none() && parts() < before + 20 {
            std::thread::sleep(Duration::from_millis(2));
        }
        interrupted += i32::from(child.try_wait().expect("a status").is_none());
        // SIGKILL: the program cannot tidy up.
        let _ = child.kill();
        child.wait().expect("a status");
    }
    assert!(
        interrupted >= 3,
        "only {interrupted} times was there something to kill"
    );
    campaign(&file, 600, &broken, &keep).ends_with(2);
    assert_same(&whole, &broken);
    // Once more: nothing is left to do, nothing changes.
    campaign(&file, 600, &broken, &keep).ends_with(2);
    assert_same(&whole, &broken);
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_what_is_done() {
    let folder = folder();
    let file = short(folder.path(), "independent");
    let out = folder.path().join("out");
    let mut child = command()
        .args(arguments(&file, 20_000, &out, &["--jobs", "1"]))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs");
    let parts = || fs::read_dir(out.join("parts")).map_or(0, Iterator::count);
    while child.try_wait().expect("a status").is_none() && parts() < 2 {
        std::thread::sleep(Duration::from_millis(5));
    }
    let interrupt = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(interrupt.expect("kill runs").success());
    let run = Run::new(child.wait_with_output().expect("an end"));
    let refusal = run.refusal();
    assert!(refusal.starts_with("interrupted; "), "{refusal}");
    let done = refusal
        .split(&[' ', ';'][..])
        .find_map(|word| word.parse::<u64>().ok());
    let done = done.expect("a number of runs");
    assert!(done > 0 && done < 20_000, "{refusal}");
    let kept: usize = names_in(&out.join("parts"))
        .iter()
        .map(|name| {
            column_f64(&out.join("parts").join(name), "run")
                .expect("a part")
                .len()
        })
        .sum();
    assert_eq!(kept as u64, done);
    let record = CampaignFile::read(&out).expect("a record");
    assert!(record.results.is_none());
    let refusal = campaign(&file, 19_999, &out, &[]).refusal();
    assert!(
        refusal.contains("holds another campaign: its runs is 20000, not 19999"),
        "{refusal}"
    );
    let merge = steadfast(["merge", out.to_str().unwrap(), "-o", "nowhere"]).refusal();
    assert!(merge.contains("is not complete"), "{merge}");
}

#[cfg(unix)]
#[test]
fn two_campaigns_do_not_write_into_one_folder() {
    use rustix::fs::{flock, FlockOperation};
    let folder = folder();
    let file = short(folder.path(), "independent");
    let out = folder.path().join("out");
    fs::create_dir(&out).expect("a folder");
    let held = fs::File::open(&out).expect("a folder");
    flock(&held, FlockOperation::NonBlockingLockExclusive).expect("a lock");
    let refusal = campaign(&file, 2, &out, &[]).refusal();
    assert!(refusal.contains("in use by another campaign"), "{refusal}");
    assert!(names_in(&out).is_empty());
    drop(held);
    let status = campaign(&file, 2, &out, &[]).status;
    assert!(matches!(status, Some(0 | 2)), "{status:?}");
}

/// What `values` of the dispersions say is drawn, and what the command says to it.
#[test]
fn wrong_input_is_refused_in_one_sentence() {
    let folder = folder();
    let good = json(&shipped("wu2018-campaign.json"));
    let out = folder.path().join("out");
    let refused = |dispersions: Value| {
        let mut file = good.clone();
        set(&mut file, "/dispersions", dispersions);
        let path = write(folder.path(), "bad.json", file.to_string());
        campaign(&path, 10, &out, &[]).refusal()
    };
    let normal = |deviation: f64| json!({ "normal": { "standard_deviation": deviation } });
    for (dispersions, part) in [
        (
            json!({ "initial_atitude": {} }),
            "unknown field `initial_atitude`",
        ),
        (
            json!({ "initial_rate_rad_s": normal(-1.0) }),
            "field 'dispersions.initial_rate_rad_s.normal.standard_deviation': the value -1",
        ),
        (
            json!({ "initial_rate_rad_s": { "uniform": { "from": 2, "to": 1 } } }),
            "uniform.to",
        ),
        (
            json!({ "initial_state": normal(1.0) }),
            "dispersions.initial_state",
        ),
        (
            json!({ "certified_boundary": {} }),
            "dispersions.certified_boundary",
        ),
        (
            json!({ "values": [{ "name": "sampling.jiter_s", "distribution": normal(1.0) }] }),
            "there is no number 'sampling.jiter_s'",
        ),
        (
            json!({ "values": [{ "name": "random.seed", "distribution": normal(1.0) }] }),
            "dispersions.values[0].name",
        ),
        (
            json!({ "values": [{ "name": "jitter_s", "distribution": normal(1.0) }] }),
            "run ",
        ),
        (
            json!({ "inertia": { "moments_percent": normal(200.0) } }),
            "run ",
        ),
        (
            json!({ "initial_rate_rad_s": { "normal": { "standard_deviation": 1, "at_least": 40 } } }),
            "at_least",
        ),
        (
            json!({ "faults": [{ "from_s": normal(0.0), "effectiveness": normal(1.0) }] }),
            "faults[0].effectiveness",
        ),
        (
            json!({ "faults": [{ "probability": 2, "from_s": normal(0.0), "effectiveness": { "choice": [0] } }] }),
            "faults[0].probability",
        ),
        (
            json!({ "disturbance": { "phase_deg": { "choice": [] } } }),
            "at least one",
        ),
    ] {
        let refusal = refused(dispersions.clone());
        assert!(refusal.contains(part), "{dispersions}: {refusal}");
        assert!(!out.join("runs.parquet").exists());
    }
    let mut model = json(&shipped("double-integrator-closed-loop.json"));
    set(
        &mut model,
        "/dispersions",
        json!({ "initial_attitude": { "uniform": {} } }),
    );
    let path = write(folder.path(), "model.json", model.to_string());
    let refusal = campaign(&path, 10, &out, &[]).refusal();
    assert!(
        refusal.contains("dispersions.initial_attitude"),
        "{refusal}"
    );
    let good = shipped("wu2018-campaign.json");
    for (runs, more, part) in [
        (0, &[][..], "from 1 to 10000000"),
        (10, &["--shard", "3/2"], "--shard: '3/2'"),
        (10, &["--shard", "0/2"], "--shard: '0/2'"),
        (10, &["--shard", "half"], "--shard: 'half'"),
        (10, &["--shard", "1/11"], "at most 10 shards"),
    ] {
        let refusal = campaign(&good, runs, &folder.path().join("none"), more).refusal();
        assert!(refusal.contains(part), "{refusal}");
    }
    let good = good.display().to_string();
    let index = |more: &[&str]| {
        steadfast([&["simulate", &good, "--run-index"][..], more].concat()).refusal()
    };
    assert!(index(&["10", "--runs", "10"]).contains("--run-index: 10 is not allowed"));
    let hypercube = short(folder.path(), "latin_hypercube")
        .display()
        .to_string();
    let refusal = steadfast(["simulate", &hypercube, "--run-index", "1"]).refusal();
    assert!(refusal.contains("--runs"), "{refusal}");
    let file = write(folder.path(), "a-file", "");
    let refusal = campaign(&shipped("wu2018-campaign.json"), 10, &file.join("out"), &[]).refusal();
    assert!(refusal.contains("cannot be created"), "{refusal}");
    let refusal = steadfast(["merge", "nowhere", "-o", "out"]).refusal();
    assert!(refusal.contains("nowhere/campaign.json"), "{refusal}");
}
