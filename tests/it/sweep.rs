//! `steadfast sweep`: a row for each point of a grid.

use std::path::Path;

use crate::support::sweeps::{everything_in, scenario, sweep, Rows};
use crate::support::*;
use serde_json::{json, Value};

#[test]
fn a_grid_has_a_row_for_each_point_and_the_last_number_changes_fastest() {
    let folder = folder();
    let file = scenario(folder.path());
    let out = folder.path().join("out");
    let vary = [
        "relative=0.4:0.6:3",
        "controller.wu2018.torque_limit_nm[0]=0.1,0.2",
    ];
    let run = sweep(&file, &vary, &out, &["--json"]).ends_with(0);
    assert_eq!(run.json()["points"], 6);
    assert_eq!(
        names_in(&out),
        [
            "points.jsonl",
            "sweep.csv",
            "sweep.html",
            "sweep.json",
            "sweep.parquet"
        ]
    );
    let rows = Rows::read(&out);
    assert_eq!(rows.rows.len(), 6);
    let name = "controller.wu2018.trigger.relative.relative";
    let found: Vec<(f64, f64)> = (0..6)
        .map(|row| {
            (
                rows.number(row, name),
                rows.number(row, "controller.wu2018.torque_limit_nm[0]"),
            )
        })
        .collect();
    let expected = [
        (0.4, 0.1),
        (0.4, 0.2),
        (0.5, 0.1),
        (0.5, 0.2),
        (0.6, 0.1),
        (0.6, 0.2),
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_row_holds_what_a_run_of_that_variant_gives() {
    let folder = folder();
    let file = scenario(folder.path());
    let out = folder.path().join("out");
    sweep(&file, &["relative=0.3,0.6"], &out, &[]).ends_with(0);
    let rows = Rows::read(&out);
    for (row, relative) in [(0, 0.3), (1, 0.6)] {
        let mut variant = json(&file);
        set(
            &mut variant,
            "/controller/wu2018/trigger/relative/relative",
            json!(relative),
        );
        let path = write(folder.path(), "variant.json", variant.to_string());
        let summary = steadfast(["simulate".as_ref(), path.as_os_str(), "--json".as_ref()]);
        let summary: Value = serde_json::from_str(&summary.stdout).unwrap();
        assert_eq!(summary["verdict"], rows.text(row, "verdict"));
        for metric in [
            "triggers",
            "impulse",
            "final_error_deg",
            "max_rate",
            "max_torque",
        ] {
            assert_eq!(
                summary[metric].as_f64(),
                Some(rows.number(row, metric)),
                "{metric}"
            );
        }
    }
    // The looser trigger sends less, and the limit on messages lies between.
    assert_eq!(rows.text(0, "verdict"), "requirements_missed");
    let reason = rows.text(0, "reason");
    assert!(reason.starts_with("triggers at most 25: "), "{reason}");
    assert_eq!(
        (rows.text(1, "verdict"), rows.text(1, "reason")),
        ("requirements_met", "")
    );
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let folder = folder();
    let file = scenario(folder.path());
    let tables = ["1", "3"].map(|jobs| {
        let out = folder.path().join(jobs);
        sweep(&file, &["relative=0.3:0.7:5"], &out, &["--jobs", jobs]).ends_with(0);
        everything_in(&out)
    });
    assert_eq!(tables[0], tables[1]);
}

#[test]
fn a_point_whose_file_is_not_valid_says_why_and_the_others_go_on() {
    let folder = folder();
    let file = scenario(folder.path());
    let out = folder.path().join("out");
    sweep(&file, &["relative=0.6,1.5"], &out, &[]).ends_with(0);
    let rows = Rows::read(&out);
    assert_eq!(rows.text(0, "verdict"), "requirements_met");
    assert_eq!(rows.text(1, "verdict"), "invalid");
    let reason = rows.text(1, "reason");
    assert!(
        reason.contains("the value 1.5 is not allowed; it must be in (0, 1)"),
        "{reason}"
    );
    assert_eq!(rows.text(1, "triggers"), "");
}

#[test]
fn numbers_that_the_file_leaves_out_have_their_default_and_can_be_varied() {
    let folder = folder();
    let file = scenario(folder.path());
    let out = folder.path().join("out");
    let name = "system.rigid_body.sensors.rate_noise_deg_s";
    assert!(json(&file).pointer("/system/rigid_body/sensors").is_none());
    sweep(&file, &[&format!("{name}=0,0.001")], &out, &[]).ends_with(0);
    let rows = Rows::read(&out);
    assert!(rows.number(1, "triggers") > rows.number(0, "triggers"));
}

#[test]
fn a_model_is_synthesized_at_each_point() {
    let folder = folder();
    let out = folder.path().join("out");
    let file = shipped("double-integrator.json");
    sweep(&file, &["phi=0.1,0.3,50"], &out, &[]).ends_with(0);
    let rows = Rows::read(&out);
    assert_eq!(rows.columns[0], "specs.phi_per_s");
    for row in 0..2 {
        assert_eq!(rows.text(row, "verdict"), "proved");
        let gamma = rows.number(row, "gamma");
        assert!(rows.number(row, "guaranteed_gain") <= gamma);
        assert!(rows.number(row, "worst_margin") >= 0.0);
    }
    // No feedback with this torque lets the state decay that fast.
    assert!(["infeasible", "solver_failed"].contains(&rows.text(2, "verdict")));
    assert!(!rows.text(2, "reason").is_empty());
    assert_eq!(rows.text(2, "gamma"), "");
    let design = json(double_integrator_design());
    let phi = number(&design, "/model/specs/phi_per_s");
    let out = folder.path().join("another");
    sweep(&file, &[&format!("phi={phi}")], &out, &[]).ends_with(0);
    let found = Rows::read(&out).number(0, "gamma");
    assert_relative(found, number(&design, "/certificate/gamma"), 1e-6);
}

#[test]
fn an_intermittent_controller_is_swept_over_its_own_parameters() {
    let folder = folder();
    let out = folder.path().join("out");
    let vary = ["performance.initial[0]=0.45,0.47", "longest_on=0.5,1"];
    sweep(&shipped("lei2022.json"), &vary, &out, &[]).ends_with(0);
    let rows = Rows::read(&out);
    // rho_0 below the start: no point of that row can be run.
    for row in 0..2 {
        assert_eq!(rows.text(row, "verdict"), "invalid");
        assert!(rows.text(row, "reason").contains("performance.initial[0]"));
    }
    assert_eq!(rows.text(3, "verdict"), "requirements_met");
    assert!(rows.number(2, "turn_ons") > rows.number(3, "turn_ons"));
    assert!(rows.number(3, "threshold.largest_ratio") <= 1.0);
}

#[track_caller]
fn refusal(file: &Path, vary: &[&str]) -> String {
    let folder = folder();
    let out = folder.path().join("out");
    let message = sweep(file, vary, &out, &[]).refusal();
    assert_eq!(names_in(folder.path()), Vec::<String>::new(), "{message}");
    message
}

#[test]
fn a_name_that_is_no_number_of_the_file_is_refused_with_names_like_it() {
    let file = shipped("wu2018.json");
    let cases = [
        (
            "controller.wu2018.trigger.relative.relativ=1",
            "similar: controller.wu2018.trigger.relative.relative",
        ),
        (
            "torque_limit=1",
            "similar: controller.wu2018.torque_limit_nm[*], controller.wu2018.torque_limit_nm[0]",
        ),
        (
            "sampling=1",
            "'sampling' is an object, not a number; similar: sampling.dropout_probability",
        ),
        ("name=1", "'name' is a text, not a number"),
        ("xyzzy=1", "there is no number 'xyzzy' in the file"),
        (
            "at_most=1",
            "is the end of several names: requirements[0].at_most",
        ),
        (
            "random.seed=0.5",
            "'random.seed' is a whole number; 0.5 is not",
        ),
    ];
    for (axis, part) in cases {
        let message = refusal(&file, &[axis]);
        assert!(message.contains(part), "{axis}: {message}");
    }
}

#[test]
fn an_axis_of_another_form_is_refused() {
    let file = shipped("wu2018.json");
    let cases = [
        ("relative", "is not of the form key=lo:hi:n or key=a,b,c"),
        ("=1", "is not of the form"),
        ("relative=1:2", "is not of the form"),
        ("relative=1:2:3:4", "is not of the form"),
        ("relative=1,x", "'x' is not a finite number"),
        ("relative=inf", "'inf' is not a finite number"),
        ("relative=0:1:1", "'1' is not a number of points"),
        ("relative=0:1:-3", "'-3' is not a number of points"),
        ("relative=1:1:3", "the range from 1 to 1 is empty"),
        (
            "relative=0:1:3:log",
            "a logarithmic range needs both ends above 0",
        ),
        ("relative=0.5,0.6,0.5", "the value 0.5 is given twice"),
    ];
    for (axis, part) in cases {
        let message = refusal(&file, &[axis]);
        assert!(message.contains(part), "{axis}: {message}");
    }
    let message = refusal(&file, &["relative=0.5", "trigger.relative.relative=0.6"]);
    assert!(message.contains("is varied twice"), "{message}");
    let large = ["relative=0:1:10000", "torque_limit_nm[0]=0:1:10000"];
    let message = refusal(&file, &large);
    assert!(
        message.contains("the grid has 10000 x 10000 points"),
        "{message}"
    );
}

#[test]
fn a_scenario_without_the_design_that_it_needs_is_refused_before_any_run() {
    let message = refusal(&shipped("xu2020-closed-loop.json"), &["duration_s=10,20"]);
    assert!(message.contains("no design file is given"), "{message}");
    let folder = folder();
    let out = folder.path().join("out");
    let design = xu2020_design().display().to_string();
    let file = shipped("xu2020-closed-loop.json");
    sweep(&file, &["duration_s=5,10"], &out, &["--design", &design]).ends_with(0);
    assert_eq!(Rows::read(&out).rows.len(), 2);
    let more = ["--design", design.as_str()];
    let run = sweep(&shipped("wu2018.json"), &["duration_s=5"], &out, &more);
    assert!(run
        .ends_with(1)
        .stderr
        .contains("the controller is not 'design'"));
}

#[test]
fn a_folder_that_cannot_be_made_is_named_once() {
    let folder = folder();
    let file = write(folder.path(), "file", "");
    let message = sweep(&scenario(folder.path()), &["relative=0.5"], &file, &[]).refusal();
    assert_eq!(
        message.matches(&file.display().to_string()).count(),
        1,
        "{message}"
    );
}

#[test]
fn every_entry_of_a_list_is_varied_at_once() {
    let folder = folder();
    let file = scenario(folder.path());
    let out = folder.path().join("out");
    sweep(&file, &["torque_limit_nm[*]=0.05,0.2"], &out, &[]).ends_with(0);
    let rows = Rows::read(&out);
    assert_eq!(rows.columns[0], "controller.wu2018.torque_limit_nm[*]");
    let mut variant = json(&file);
    set(
        &mut variant,
        "/controller/wu2018/torque_limit_nm",
        json!([0.05, 0.05, 0.05]),
    );
    let path = write(folder.path(), "variant.json", variant.to_string());
    let run = steadfast(["simulate".as_ref(), path.as_os_str(), "--json".as_ref()]);
    let summary: Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(summary["impulse"].as_f64(), Some(rows.number(0, "impulse")));
    assert_ne!(rows.number(0, "impulse"), rows.number(1, "impulse"));
    let both = ["torque_limit_nm[*]=0.1", "torque_limit_nm[1]=0.2"];
    let message = refusal(&file, &both);
    assert!(message.contains("is varied twice"), "{message}");
}

#[test]
fn a_list_of_one_entry_can_be_varied_as_a_list() {
    let folder = folder();
    let file = shipped("double-integrator.json");
    let out = folder.path().join("out");
    sweep(&file, &["input_limit[*]=1,2"], &out, &[]).ends_with(0);
    let rows = Rows::read(&out);
    assert_eq!(rows.columns[0], "plant.vertices.input_limit[*]");
    assert_ne!(rows.number(0, "gamma"), rows.number(1, "gamma"));
}

#[test]
fn a_logarithmic_range_has_equal_ratios() {
    let folder = folder();
    let out = folder.path().join("out");
    let file = scenario(folder.path());
    sweep(&file, &["absolute=1e-6:1e-4:3:log"], &out, &[]).ends_with(0);
    let rows = Rows::read(&out);
    let name = "controller.wu2018.trigger.relative.absolute_rad_s";
    assert_relative(rows.number(1, name), 1e-5, 1e-12);
}

#[test]
fn a_sweep_without_axes_or_of_a_bad_file_is_refused() {
    let folder = folder();
    let run = steadfast(["sweep".as_ref(), shipped("wu2018.json").as_os_str()]);
    assert!(run.ends_with(1).stderr.contains("--vary"));
    let file = write(folder.path(), "bad.json", "{ \"duration_s\": 1 }");
    let message = sweep(&file, &["duration_s=1"], &folder.path().join("out"), &[]).refusal();
    assert!(message.contains("schema_version"), "{message}");
    assert_eq!(names_in(folder.path()), ["bad.json"]);
}
