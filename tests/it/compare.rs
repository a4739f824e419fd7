//! `steadfast compare`: several controllers on one task.

use std::path::{Path, PathBuf};

use crate::support::*;
use serde_json::{json, Value};

const CONTROLLERS: [&str; 4] = ["wu2018", "xu2020", "lei2022", "yang2025"];

fn shipped_scenarios() -> Vec<PathBuf> {
    let files = CONTROLLERS.map(|name| shipped(&format!("compare-{name}.json")));
    files.into()
}

/// Runs `compare` on files with more arguments.
fn compare(files: &[PathBuf], more: &[&Path]) -> Run {
    let mut arguments = vec![Path::new("compare")];
    arguments.extend(files.iter().map(PathBuf::as_path));
    arguments.extend(more);
    steadfast(arguments)
}

/// Short scenarios of two controllers with one task, the second changed at `pointer`.
fn pair(folder: &Path, pointer: &str, value: Value) -> Vec<PathBuf> {
    let file = |name: &str, change: Option<Value>| {
        let mut file = json(&shipped(&format!("compare-{name}.json")));
        set(&mut file, "/duration_s", json!(40));
        set(&mut file, "/metrics/tail_s", json!(5));
        set(&mut file, "/requirements/0/at_most", json!(20));
        if let Some(value) = change {
            set(&mut file, pointer, value);
        }
        write(folder, &format!("{name}.json"), file.to_string())
    };
    vec![file("wu2018", None), file("xu2020", Some(value))]
}

#[test]
fn four_controllers_on_one_task_fill_a_table_with_a_chart() {
    let folder = folder();
    let out = folder.path().join("out");
    let files = shipped_scenarios();
    let run = compare(&files, &[Path::new("-o"), &out, Path::new("--json")]).ends_with(0);
    let table = run.json();
    assert_eq!(table, json(&out.join("comparison.json")));
    let runs = table["runs"].as_array().expect("rows");
    assert_eq!(table["faults"].as_array().map(Vec::len), Some(6));
    for (row, name) in runs.iter().zip(CONTROLLERS) {
        assert_eq!(row["label"], name);
        assert_eq!(row["verdict"], "requirements_met", "{name}");
        for key in [
            "settle_seconds",
            "final_error_deg",
            "rms_error_deg",
            "impulse",
            "shortest_interval_s",
        ] {
            assert!(row[key].as_f64().expect(key) > 0.0, "{name}: {key}");
        }
        let outcomes = row["faults"].as_array().expect("outcomes");
        let survived = outcomes
            .iter()
            .filter(|outcome| outcome["survived"] == true);
        assert_eq!(row["faults_survived"], survived.count(), "{name}");
        assert_eq!(outcomes.len(), 6);
        for outcome in outcomes {
            let silent = outcome["reason"] == "";
            assert_eq!(outcome["survived"] == true, silent, "{name}: {outcome}");
        }
    }
    let page = text(&out.join("comparison.html"));
    assert_eq!(page.matches("<svg").count(), 3);
    for outside in ["<script", "<link", "src=", "url(", "@import"] {
        assert!(!page.contains(outside), "{outside}");
    }
    let csv = text(&out.join("comparison.csv"));
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), 5);
    let columns = lines[0].split(',').count();
    assert!(
        lines.iter().all(|line| line.split(',').count() == columns),
        "{csv}"
    );
    assert!(lines[0].contains("settle_seconds") && lines[0].contains("fault_dead_axis"));
    assert_eq!(names_in(&out).len(), 3);
}

#[test]
fn a_row_is_what_simulate_says() {
    let files = shipped_scenarios();
    let table = compare(
        &files,
        &[Path::new("--without-faults"), Path::new("--json")],
    );
    let table = table.ends_with(0).json();
    assert_eq!(table["faults"], json!([]));
    for (row, file) in table["runs"].as_array().expect("rows").iter().zip(&files) {
        let run = steadfast([Path::new("simulate"), file, Path::new("--json")]).ends_with(0);
        let summary: Value = serde_json::from_str(&run.stdout).expect("a summary");
        for key in [
            "controller",
            "settle_seconds",
            "final_error_deg",
            "rms_error_deg",
            "max_rate",
            "max_torque",
            "impulse",
            "updates",
            "triggers",
            "bits",
            "bytes",
            "shortest_interval_s",
            "mean_interval_s",
            "violations",
            "link",
            "verdict",
        ] {
            assert_eq!(row[key], summary[key], "{}: {key}", file.display());
        }
        let sha256 = &summary["provenance"]["scenario_sha256"];
        assert_eq!(&row["scenario_sha256"], sha256);
    }
}

/// A proportional-derivative law under a constant torque rests where its gain balances it: far out
/// with weak gains, near with strong ones.
#[test]
fn a_bias_is_survived_with_strong_gains_only() {
    let folder = folder();
    let file = |seconds: f64| {
        let mut file = json(&shipped("compare-wu2018.json"));
        let place = "/controller/wu2018/gains/settling_time/settling_time_s";
        set(&mut file, place, json!(seconds));
        set(&mut file, "/name", json!(format!("{seconds} s")));
        write(folder.path(), &format!("{seconds}.json"), file.to_string())
    };
    let table = compare(&[file(15.0), file(25.0)], &[Path::new("--json")])
        .ends_with(0)
        .json();
    let index = table["faults"].as_array().expect("faults");
    let index = index
        .iter()
        .position(|fault| fault[0] == "bias")
        .expect("a bias");
    let mut errors = Vec::new();
    for (row, seconds) in [(0, 15.0), (1, 25.0)] {
        let outcome = &table["runs"][row]["faults"][index];
        // omega_n = 8 / settling time; k beta = 2 omega_n^2 J; |q| = torque / (k beta), with 0.2 of the
        // limit and the disturbance's own 1.4e-3 N m. The trigger holds an s that differs from the
        // true one by up to half of that.
        let natural: f64 = 8.0 / seconds;
        let stiffness = 2.0 * natural * natural * 2.8;
        let angle = |torque: f64| 2.0 * (torque / stiffness).asin().to_degrees();
        let error = number(outcome, "/rms_error_deg");
        let (least, most) = (angle((0.01 - 1.5e-3) / 1.5), angle((0.01 + 1.5e-3) / 0.5));
        assert!((least..most).contains(&error), "{error} in {least}..{most}");
        assert_eq!(outcome["survived"], error <= 1.0);
        errors.push(error);
    }
    // Stiffness goes with the inverse square of the settling time.
    let ratio = errors[1] / errors[0];
    assert!((2.0..4.0).contains(&ratio), "{errors:?}");
}

#[test]
fn tasks_that_differ_are_refused_with_the_field() {
    let body = "/system/rigid_body";
    let cases = [
        (
            format!("{body}/inertia_kg_m2/1/1"),
            json!(2.6),
            "system.rigid_body.inertia_kg_m2[1][1]' is 2.6, but 2.5 in ",
        ),
        (
            format!("{body}/initial_attitude/axis_angle/angle_deg"),
            json!(26),
            "system.rigid_body.initial_attitude.axis_angle.angle_deg",
        ),
        (
            format!("{body}/initial_rate_rad_s/2"),
            json!(1e-3),
            "system.rigid_body.initial_rate_rad_s[2]",
        ),
        (
            format!("{body}/disturbance/bias_nm/0"),
            json!(0),
            "system.rigid_body.disturbance.bias_nm[0]",
        ),
        (
            format!("{body}/disturbance/sines"),
            json!([]),
            "system.rigid_body.disturbance.sines",
        ),
        (
            format!("{body}/faults"),
            json!([{ "axis": 1, "from_s": 1, "until_s": 2, "effectiveness": 0 }]),
            "system.rigid_body.faults",
        ),
        (
            format!("{body}/sensors"),
            json!({ "attitude_noise_deg": 0.1 }),
            "system.rigid_body.sensors.attitude_noise_deg",
        ),
        ("/duration_s".to_string(), json!(41), "duration_s"),
        (
            "/metrics/settle_tolerance_deg".to_string(),
            json!(2),
            "metrics.settle_tolerance_deg",
        ),
        (
            "/requirements/0/at_most".to_string(),
            json!(2),
            "requirements[0].at_most",
        ),
        (
            format!("{body}/actuators/torque_limit_nm"),
            json!([0.05, 0.05, 0.04]),
            "torque limit of axis 3' is 0.04 N m, but 0.05 N m in ",
        ),
        (
            "/controller/xu2020/torque_limit_nm/0".to_string(),
            json!(0.03),
            "torque limit of axis 1",
        ),
    ];
    for (pointer, value, expected) in cases {
        let folder = folder();
        let files = pair(folder.path(), &pointer, value);
        let message = compare(&files, &[]).refusal();
        assert!(
            message.contains(&format!("field '{expected}")),
            "{expected}: {message}"
        );
        assert!(message.contains("--take-system-from"), "{message}");
    }
}

#[test]
fn what_makes_the_controller_may_differ() {
    let cases = [
        ("/name", json!("other")),
        ("/random/seed", json!(7)),
        (
            "/sampling/instants",
            json!({ "periodic": { "interval_s": 0.05 } }),
        ),
        (
            "/system/rigid_body/actuators/torque_limit_nm",
            json!([0.1, 0.1, 0.1]),
        ),
    ];
    for (pointer, value) in cases {
        let folder = folder();
        let files = pair(folder.path(), pointer, value);
        compare(&files, &[Path::new("--without-faults")]).ends_with(0);
    }
}

#[test]
fn one_task_can_be_imposed_on_all() {
    let files = [shipped("wu2018.json"), shipped("xu2020-closed-loop.json")];
    let message = compare(&files, &[Path::new("--design"), xu2020_design()]).refusal();
    assert!(message.contains("field 'system."), "{message}");
    let source = shipped("xu2020-closed-loop.json");
    let more = [
        Path::new("--take-system-from"),
        &source,
        Path::new("--design"),
        xu2020_design(),
        Path::new("--json"),
        Path::new("--without-faults"),
    ];
    // Xu's requirements need a certificate, which Wu's run does not have: the answer is no.
    let table = compare(&files, &more).ends_with(2).json();
    assert_eq!(table["task"]["taken_from"], source.display().to_string());
    assert_eq!(table["task"]["torque_limit_nm"], json!([2.0, 2.0, 2.0]));
    assert_eq!(table["task"]["duration_s"], 200.0);
    let [wu, xu] = [&table["runs"][0], &table["runs"][1]];
    assert_eq!(wu["verdict"], "requirements_missed");
    assert_eq!(wu["proof"], Value::Null);
    assert_eq!(xu["verdict"], "requirements_met");
    assert_eq!(xu["proof"], "proved; the proof covers this run");
    let note = "The controller itself commands at most 0.2, 0.2 and 0.2 N m, less than can act.";
    assert_eq!(wu["notes"], json!([note]));
    assert!(number(wu, "/max_torque") <= 0.2);
}

#[test]
fn the_same_files_give_the_same_bytes() {
    let folder = folder();
    let files = pair(folder.path(), "/name", json!("other"));
    let run = |name: &str| {
        let out = folder.path().join(name);
        compare(&files, &[Path::new("-o"), &out]).ends_with(0);
        let contents = |file: &String| text(&out.join(file));
        names_in(&out).iter().map(contents).collect::<Vec<_>>()
    };
    assert_eq!(run("first"), run("second"));
}

#[test]
fn two_scenarios_of_the_same_name_are_told_apart() {
    let folder = folder();
    let files = pair(folder.path(), "/name", json!("wu2018"));
    let table = compare(
        &files,
        &[Path::new("--json"), Path::new("--without-faults")],
    );
    let table = table.ends_with(0).json();
    for (row, file) in table["runs"].as_array().expect("rows").iter().zip(&files) {
        assert_eq!(row["label"], format!("wu2018 ({})", file.display()));
    }
}

#[test]
fn what_cannot_be_compared_is_said() {
    let [wu, xu] = [
        shipped("compare-wu2018.json"),
        shipped("compare-xu2020.json"),
    ];
    let alone = compare(std::slice::from_ref(&wu), &[]).ends_with(1);
    assert!(
        alone.stderr.contains("2 values required"),
        "{}",
        alone.stderr
    );
    let refusal = |other: PathBuf, more: &[&Path]| compare(&[wu.clone(), other], more).refusal();
    let model = refusal(shipped("small-spacecraft.json"), &[]);
    assert!(
        model.contains("this is a model file; a scenario file is expected"),
        "{model}"
    );
    let cart = refusal(shipped("double-integrator-closed-loop.json"), &[]);
    assert!(
        cart.contains("only scenarios of a rigid_body can be compared"),
        "{cart}"
    );
    let design = [Path::new("--design"), xu2020_design()];
    let unused = refusal(xu.clone(), &design);
    assert!(unused.contains("no scenario uses this design"), "{unused}");
    let missing = refusal(shipped("small-spacecraft-closed-loop.json"), &[]);
    assert!(missing.contains("no design file is given"), "{missing}");
    let other = refusal(shipped("small-spacecraft-closed-loop.json"), &design);
    assert!(
        other.contains("the design does not fit the scenario"),
        "{other}"
    );
    let absent = refusal(
        xu,
        &[Path::new("--take-system-from"), Path::new("none.json")],
    );
    assert!(absent.contains("none.json"), "{absent}");
}
