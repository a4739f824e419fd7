//! Pages and tables say point by point whether the proof covers what they show, and are not green where they should
//! not be.

use std::path::Path;

use crate::support::sweeps::{sweep, Rows};
use crate::support::*;
use serde_json::{json, Value};

/// The shipped closed loop, 20 s of it.
fn closed_loop() -> Value {
    let mut scenario = json(&shipped("xu2020-closed-loop.json"));
    scenario["duration_s"] = json!(20);
    scenario["metrics"] = json!({ "settle_tolerance_deg": 6.5 });
    scenario["requirements"] = json!([{ "metric": "max_torque", "at_most": 2 }]);
    scenario
}

/// Three runs of a scenario with the design of xu2020.
fn campaign(scenario: &Path, out: &Path) -> Run {
    let arguments = [
        Path::new("campaign"),
        scenario,
        Path::new("--runs"),
        Path::new("3"),
        Path::new("--design"),
        xu2020_design(),
        Path::new("-o"),
        out,
    ];
    steadfast(arguments).ends_with(0)
}

#[test]
fn a_sweep_says_of_every_point_whether_the_proof_covers_it() {
    let folder = folder();
    let file = write(folder.path(), "scenario.json", closed_loop().to_string());
    let design = ["--design", xu2020_design().to_str().unwrap()];
    // The proof is for 0.01 N m, an inertia of 350 kg m^2 about axis 1, and gaps of 0.1 s.
    let axes = [
        (
            "disturbance.bias_nm[1]=0.002,0.012",
            "the disturbance reaches 0.0",
        ),
        (
            "inertia_kg_m2[0][0]=350,352",
            "the plant's moments of inertia are",
        ),
        (
            "longest_s=0.1,0.11",
            "samples are up to 0.11 s apart; the proof allows 0.1 s",
        ),
    ];
    for (number, (axis, reason)) in axes.into_iter().enumerate() {
        let out = folder.path().join(format!("out{number}"));
        let run = sweep(&file, &[axis], &out, &design).ends_with(0);
        assert!(
            run.stdout.contains("points that the proof covers: 1 of 2"),
            "{run:#?}"
        );
        let rows = Rows::read(&out);
        let said = |row: usize, name: &str| rows.text(row, name).to_string();
        assert_eq!(
            [said(0, "verdict"), said(1, "verdict")],
            ["requirements_met"; 2]
        );
        assert_eq!(
            [said(0, "proof_covers"), said(1, "proof_covers")],
            ["yes", "no"]
        );
        assert_eq!(said(0, "not_covered"), "");
        assert!(
            said(1, "not_covered").contains(reason),
            "{}",
            said(1, "not_covered")
        );
        let page = text(&out.join("sweep.html"));
        assert!(page.contains("<p class=\"verdict caution\">"), "not green");
        assert!(page.contains("The proof covers 1 of 2 points"));
        assert!(page.contains("requirements met, not covered by the proof"));
    }
}

#[test]
fn a_sweep_without_a_design_says_that_nothing_is_proved() {
    let folder = folder();
    let file = cut("wu2018.json", 5.0, folder.path());
    let mut scenario = json(&file);
    scenario["requirements"] = json!([]);
    let file = write(folder.path(), "scenario.json", scenario.to_string());
    let out = folder.path().join("out");
    sweep(&file, &["relative=0.3,0.6"], &out, &[]).ends_with(0);
    assert!(text(&out.join("sweep.html")).contains("Nothing is proved for this controller."));
    let header = text(&out.join("sweep.csv"));
    assert!(!header
        .lines()
        .next()
        .unwrap_or_default()
        .contains("proof_covers"));
    // A unit is written once, after the name without it.
    let page = text(&out.join("sweep.html"));
    assert!(!page.contains("econds (s)"), "a unit was cut out of a name");
}

#[test]
fn a_campaign_and_a_comparison_say_it_too() {
    let folder = folder();
    let mut scenario = closed_loop();
    set(
        &mut scenario,
        "/system/rigid_body/disturbance/bias_nm",
        json!([0, 0.012, 0]),
    );
    let file = write(folder.path(), "scenario.json", scenario.to_string());
    let out = folder.path().join("campaign");
    let run = campaign(&file, &out);
    assert!(
        run.stdout.contains("runs that the proof covers: 0"),
        "{run:#?}"
    );
    steadfast([Path::new("report"), &out]).ends_with(0);
    let page = text(&out.join("report.html"));
    assert!(page.contains("<p class=\"verdict caution\">"));
    assert!(page.contains("The proof covers 0 of 3 runs"), "{page}");

    let out = folder.path().join("comparison");
    let file = file.to_str().unwrap();
    let arguments = [
        "compare",
        file,
        file,
        "--design",
        xu2020_design().to_str().unwrap(),
        "-o",
        out.to_str().unwrap(),
    ];
    let run = steadfast(arguments).ends_with(0);
    let line = run
        .stdout
        .lines()
        .find(|line| line.starts_with("proof_covers"));
    assert_eq!(
        line.expect("a line").split_whitespace().collect::<Vec<_>>(),
        ["proof_covers", "no", "no"]
    );
    let table = json(&out.join("comparison.json"));
    for row in table["runs"].as_array().expect("rows") {
        assert_eq!(row["proof_covers"], false);
        for fault in row["faults"].as_array().expect("faults") {
            let proof = fault["proof"].as_str().expect("a sentence");
            assert!(proof.contains("does not cover this run"), "{proof}");
        }
    }
}

#[test]
fn a_run_that_does_not_settle_is_not_green_though_no_requirement_asks_for_it() {
    let folder = folder();
    let out = folder.path().join("yang");
    let yang = shipped("yang2025.json");
    let run = steadfast([Path::new("simulate"), &yang, Path::new("-o"), &out]).ends_with(0);
    let said = "The run did not settle within 1 deg, the largest error of its last 30 s is ";
    assert!(run.stdout.contains(said), "{run:#?}");
    let page = text(&out.join("report.html"));
    assert!(page.contains("<p class=\"verdict caution\">"));
    assert!(page.contains(said));
    // One that settles is green.
    let out = folder.path().join("wu");
    let wu = shipped("wu2018.json");
    steadfast([Path::new("simulate"), &wu, Path::new("-o"), &out]).ends_with(0);
    assert!(text(&out.join("report.html")).contains("<p class=\"verdict good\">"));
}

#[test]
fn the_closest_requirement_of_a_campaign_is_none_with_a_limit_of_zero_that_is_met() {
    let folder = folder();
    let mut scenario = closed_loop();
    scenario["requirements"] = json!([
        { "metric": "violations", "at_most": 0 },
        { "metric": "max_torque", "at_most": 2 },
        { "metric": "settle_seconds", "at_most": 1000 }
    ]);
    let file = write(folder.path(), "scenario.json", scenario.to_string());
    let out = folder.path().join("out");
    campaign(&file, &out);
    let runs = out.join("runs.parquet");
    let closest = steadfast::batch::campaign::table::column_text(&runs, "worst_requirement");
    for name in closest.expect("a column") {
        assert_eq!(name.as_deref(), Some("max_torque at most"));
    }
}
