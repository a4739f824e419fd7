//! What is printed and written claims what is proved, rounded to the safe side, and nothing else.

use std::path::{Path, PathBuf};

use crate::support::*;
use serde_json::{json, Value};

/// A proved design of two gains for a plant whose weights nobody knows.
fn two_gains(folder: &Path) -> PathBuf {
    let gains =
        json!({ "schema_version": 1, "name": "two", "gains": [[[-6, -8]], [[-5.5, -7.5]]] });
    let gains = write(folder, "gains.json", gains.to_string());
    let design = folder.join("two.json");
    let run = steadfast([
        "analyse".as_ref(),
        gains.as_os_str(),
        "--model".as_ref(),
        shipped("double-integrator.json").as_os_str(),
        "-o".as_ref(),
        design.as_os_str(),
    ]);
    run.ends_with(0);
    design
}

/// A design of two gains on the sixteen rules of a spacecraft, made up of another's numbers.
fn two_gains_of_a_spacecraft(folder: &Path) -> PathBuf {
    let mut file = json(xu2020_design());
    for pointer in ["/controller/gains", "/certificate/anti_windup"] {
        let one = file.pointer(pointer).expect("a list")[0].clone();
        set(&mut file, pointer, json!([one.clone(), one]));
    }
    write(folder, "spacecraft.json", file.to_string())
}

#[test]
fn a_design_whose_law_is_not_the_proved_one_is_refused_by_every_verb_that_would_fly_it() {
    let folder = folder();
    let cases = [
        (
            two_gains(folder.path()),
            "double-integrator-closed-loop.json",
            "0 rules",
        ),
        (
            two_gains_of_a_spacecraft(folder.path()),
            "xu2020-closed-loop.json",
            "16 rules",
        ),
    ];
    for (design, scenario, rules) in cases {
        let out = folder.path().join("out");
        let (design, out) = (design.to_str().unwrap(), out.to_str().unwrap());
        let scenario = shipped(scenario);
        let scenario = scenario.to_str().unwrap();
        let mut commands: Vec<Vec<&str>> = ["c", "csv", "mat"]
            .iter()
            .map(|format| vec!["export", design, "--format", format, "-o", out])
            .collect();
        let flown = ["--design", design, "-o", out];
        commands.push([&["simulate", scenario][..], &flown].concat());
        commands.push([&["campaign", scenario, "--runs", "3"][..], &flown].concat());
        let vary = ["sweep", scenario, "--vary", "duration_s=1,2"];
        commands.push([&vary[..], &flown].concat());
        if rules == "16 rules" {
            commands.push([&["compare", scenario, scenario][..], &flown].concat());
        }
        for arguments in commands {
            let run = steadfast(&arguments).ends_with(1);
            let complaint = run.stderr.lines().last().unwrap_or_default().to_string();
            assert!(
                complaint.contains("the design has 2 gains"),
                "{arguments:?}: {complaint}"
            );
            assert!(complaint.contains(rules), "{arguments:?}: {complaint}");
            assert!(!Path::new(out).exists(), "{arguments:?}");
        }
    }
}

/// The number after a word of the first line that holds the word.
#[track_caller]
fn printed(run: &Run, before: &str) -> f64 {
    let line = run.stdout.lines().find(|line| line.contains(before));
    let line = line.unwrap_or_else(|| panic!("no {before} in {run:#?}"));
    let (_, rest) = line.split_once(before).expect("it is there");
    let word = rest.split_whitespace().next().expect("a number");
    word.trim_end_matches(',').parse().expect("a number")
}

#[test]
fn gains_are_printed_rounded_up_and_sets_rounded_down() {
    for design in [xu2020_design(), double_integrator_design()] {
        let words = steadfast([Path::new("verify"), design]).ends_with(0);
        let exact = steadfast([Path::new("verify"), design, Path::new("--json")]);
        let exact = exact.ends_with(0).json();
        for (name, pointer) in [
            ("gamma: ", "/gamma"),
            ("guaranteed gain: ", "/guaranteed_gain"),
        ] {
            let (shown, exact) = (printed(&words, name), number(&exact, pointer));
            assert!(
                shown >= exact && shown < exact * (1.0 + 1e-5),
                "{shown} {exact}"
            );
        }
        if let Some(angle) = exact["certified_angle_deg"].as_f64() {
            let shown = printed(&words, "at rest up to ");
            assert!(
                shown <= angle && shown > angle * (1.0 - 1e-5),
                "{shown} {angle}"
            );
        }
        let margin = number(&exact, "/worst/margin");
        assert!(printed(&words, ", margin ") <= margin);
    }
}

/// A problem whose guarantee is so small that six decimal places show nothing of it.
#[test]
fn a_tiny_guarantee_is_not_printed_as_zero() {
    let folder = folder();
    let mut problem = json(&shipped("buffer-network.json"));
    let rows = problem
        .pointer_mut("/problem/h_infinity")
        .expect("a problem");
    for (_, matrix) in rows.as_object_mut().expect("an object").iter_mut() {
        if let Value::Array(rows) = matrix {
            for entry in rows
                .iter_mut()
                .flat_map(|row| row.as_array_mut().into_iter().flatten())
            {
                *entry = json!(entry.as_f64().unwrap_or(0.0) * 1e-4);
            }
        }
    }
    let path = write(folder.path(), "small.json", problem.to_string());
    let run = steadfast([Path::new("synthesize"), &path]).ends_with(0);
    let gamma = printed(&run, "guarantee: ");
    assert!(gamma > 0.0 && gamma < 5e-7, "{run:#?}");
}

#[test]
fn the_verdict_comes_last_and_what_is_not_proved_claims_nothing() {
    let proved = steadfast([Path::new("verify"), xu2020_design()]).ends_with(0);
    let last = proved.stdout.trim_end().lines().last();
    assert_eq!(last, Some("verdict: PROVED"));
    let folder = folder();
    let mut file = json(xu2020_design());
    let gain = number(&file, "/controller/gains/0/0/0");
    set(&mut file, "/controller/gains/0/0/0", json!(-gain));
    let path = write(folder.path(), "broken.json", file.to_string());
    let words = steadfast([Path::new("verify"), &path]).ends_with(2).stdout;
    assert_eq!(words.trim_end().lines().last(), Some("verdict: NOT PROVED"));
    for claim in ["gamma", "gain:", "set", "assumes", "transmissions"] {
        let told = words.lines().filter(|line| !line.contains("not proved:"));
        assert!(
            !told.clone().any(|line| line.contains(claim)),
            "{claim} in {words}"
        );
    }
    let report = steadfast([Path::new("verify"), &path, Path::new("--json")]);
    let report = report.ends_with(2).json();
    assert_claims_nothing(&report);
    assert_eq!(report["not_covered"], json!([]));
    // A run under it claims no gain either.
    let scenario = shipped("xu2020-closed-loop.json");
    let simulate = [
        "simulate".as_ref(),
        scenario.as_os_str(),
        "--design".as_ref(),
    ];
    let run = steadfast(
        simulate
            .into_iter()
            .chain([path.as_os_str(), "--json".as_ref()]),
    );
    let summary: Value = serde_json::from_str(&run.stdout).expect("a summary");
    let certificate = &summary["certificate"];
    assert_eq!(certificate["proved"], false);
    assert_eq!(certificate["gamma"], Value::Null);
    assert_eq!(certificate["guaranteed_gain"], Value::Null);
}

#[test]
fn no_rate_is_printed_where_no_shortest_interval_was_given() {
    let words = |design: &Path| steadfast([Path::new("verify"), design]).ends_with(0).stdout;
    let given = words(xu2020_design());
    assert!(given.contains("transmissions: at least 0.001 s apart, so at most 1000 per second"));
    assert!(
        given.contains("  - no two samples closer than 0.001 s"),
        "{given}"
    );
    let silent = words(double_integrator_design());
    for invented in ["transmissions", "apart", "closer than", "per second"] {
        assert!(!silent.contains(invented), "{silent}");
    }
    for text in [given, silent] {
        assert!(
            text.contains("  - a first sample at the start, t = 0, that is sent"),
            "{text}"
        );
    }
    let header = steadfast([
        "export",
        double_integrator_design().to_str().unwrap(),
        "--format",
        "c",
    ]);
    assert!(!header.ends_with(0).stdout.contains("hmin_s"));
}
