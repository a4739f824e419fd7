//! The files of a run say what happened when: they can be replayed, and the rows do not mix two instants.

use std::path::Path;

use crate::support::tools::python;
use crate::support::*;
use serde_json::{json, Value};
use steadfast::base::table::Table;
use steadfast::batch::campaign::table::column_f64;

/// Simulates a scenario into a folder and reads its summary and its trajectory.
fn recorded(scenario: &Path, design: Option<&Path>, out: &Path) -> (Value, Table) {
    simulated(scenario, design, out);
    let table = Table::from_csv(&text(&out.join("trajectory.csv"))).expect("a table");
    (json(&out.join("summary.json")), table)
}

fn column(table: &Table, name: &str) -> Vec<f64> {
    table.column(name).unwrap_or_else(|| panic!("no {name}"))
}

#[test]
fn an_outside_simulator_replays_a_run_from_its_files_alone() {
    let folder = folder();
    let (scenario, out) = (
        shipped("xu2020-closed-loop.json"),
        folder.path().join("run"),
    );
    let (summary, _) = recorded(&scenario, Some(xu2020_design()), &out);
    let script = include_str!("../data/replay.py");
    let files = [
        scenario.as_path(),
        xu2020_design(),
        &out.join("trajectory.csv"),
    ];
    let Some(printed) = python(&["csv", "json", "math"], script, &files) else {
        return;
    };
    let found: Value = serde_json::from_str(&printed).expect("one JSON object");
    assert_eq!(found["wrong"], 0, "{found}");
    assert_eq!(found["samples"], summary["samples"]);
    assert_eq!(found["messages"], summary["triggers"]);
    for (key, most) in [("attitude", 1e-11), ("rate", 1e-12), ("torque", 1e-8)] {
        assert!(number(&found, &format!("/{key}")) < most, "{found}");
    }
}

#[test]
fn every_sample_has_its_row_in_csv_and_in_parquet() {
    let folder = folder();
    let scenario = cut("wu2018.json", 20.0, folder.path());
    let out = folder.path().join("run");
    let (summary, table) = recorded(&scenario, None, &out);
    let samples = column(&table, "sample");
    assert_eq!(samples.iter().sum::<f64>(), number(&summary, "/samples"));
    // 32 samples per second, the first at 0.
    let times = column(&table, "time_s").into_iter().zip(&samples);
    let sampled = times.filter(|(_, sample)| **sample == 1.0);
    for (index, (time, _)) in sampled.enumerate() {
        assert_eq!(time, index as f64 / 32.0);
    }
    let sent = column(&table, "sent");
    assert!(sent
        .iter()
        .zip(&samples)
        .all(|(sent, sample)| sent <= sample));
    let parquet = folder.path().join("run.parquet");
    let export = [
        Path::new("export"),
        &out,
        Path::new("--format"),
        Path::new("parquet"),
    ];
    steadfast(export.into_iter().chain([Path::new("-o"), &parquet])).ends_with(0);
    let read = column_f64(&parquet, "sample").expect("a column");
    assert_eq!(read, samples.into_iter().map(Some).collect::<Vec<_>>());
}

/// (16) of Yang et al. with p/q = 5/3 and k1 = 0.02: the columns of one row belong together, whether or not a message
/// was sent.
#[test]
fn the_controllers_columns_are_those_of_the_rows_own_sample() {
    let folder = folder();
    let scenario = cut("yang2025.json", 5.0, folder.path());
    let (_, table) = recorded(&scenario, None, &folder.path().join("run"));
    let samples = column(&table, "sample");
    let sent = column(&table, "sent");
    let silent = samples
        .iter()
        .zip(&sent)
        .filter(|(sample, sent)| **sample > **sent);
    assert!(silent.count() > 100);
    for axis in 1..=3 {
        let of = |name: &str| column(&table, &name.replace('#', &axis.to_string()));
        let (lower, upper) = (of("envelope_lower_#"), of("envelope_upper_#"));
        let (error, rate) = (of("envelope_error_#"), of("rate_#_rad_s"));
        let sliding = of("sliding_#_rad_s");
        for row in (0..samples.len()).filter(|&row| samples[row] == 1.0) {
            let transformed = ((error[row] - lower[row]) / (upper[row] - error[row])).ln();
            let surface = 0.02 * transformed.abs().powf(5.0 / 3.0).copysign(transformed);
            let difference = sliding[row] - (rate[row] + surface);
            assert!(
                difference.abs() < 1e-12,
                "axis {axis}, row {row}: {difference:e}"
            );
        }
    }
}

/// A torque of 0.3 N m on axis 2 from 1.001 to 1.507 s, between the samples, which halves what the actuator gives.
#[test]
fn a_row_at_the_edge_of_a_fault_shows_the_side_that_begins() {
    let folder = folder();
    let mut scenario = json(&cut("wu2018.json", 3.0, folder.path()));
    let body = &mut scenario["system"]["rigid_body"];
    body["disturbance"] = json!({});
    body["faults"] = json!([
        { "axis": 2, "from_s": 1.001, "until_s": 1.507, "effectiveness": 0.5, "additive_nm": 0.3 }
    ]);
    let path = write(folder.path(), "fault.json", scenario.to_string());
    let (_, table) = recorded(&path, None, &folder.path().join("run"));
    let times = column(&table, "time_s");
    let (disturbance, torque) = (
        column(&table, "disturbance_2_nm"),
        column(&table, "torque_2_nm"),
    );
    let row = |time: f64| {
        let found = times.iter().position(|own| *own == time);
        found.unwrap_or_else(|| panic!("no row at {time}"))
    };
    for (row, time) in times.iter().enumerate().take(times.len() - 1) {
        let during = (1.001..1.507).contains(time);
        assert_eq!(disturbance[row], if during { 0.3 } else { 0.0 }, "{time}");
    }
    let (begins, ends) = (row(1.001), row(1.507));
    assert_eq!(torque[begins], 0.5 * torque[begins - 1]);
    assert_eq!(torque[ends], 2.0 * torque[ends - 1]);
}

#[test]
fn settling_is_the_first_instant_inside_and_its_root_lies_before_it() {
    // The ends of the integration's steps, and the roots of runs with steps of 1/4096 s.
    let cases = [
        (
            "xu2020-closed-loop.json",
            Some(xu2020_design()),
            59.231_51,
            59.223_48,
        ),
        (
            "xu2020-closed-loop.json",
            Some(design_in_the_papers_form()),
            63.211_92,
            63.209_6,
        ),
        ("wu2018.json", None, 83.281_25, 83.276_4),
        ("lei2022.json", None, 42.993_8, 42.964_2),
    ];
    for (name, design, instant, root) in cases {
        let mut arguments = vec![Path::new("simulate").to_path_buf(), shipped(name)];
        arguments.extend(
            design
                .into_iter()
                .flat_map(|design| [Path::new("--design").to_path_buf(), design.to_path_buf()]),
        );
        arguments.push("--json".into());
        let printed = steadfast(&arguments).ends_with(0).stdout;
        let summary: Value = serde_json::from_str(&printed).expect("a summary");
        let seconds = number(&summary, "/settle_seconds");
        let crossing = number(&summary, "/settle_crossing_s");
        assert!((seconds - instant).abs() < 2e-5, "{name}: {seconds}");
        assert!((crossing - root).abs() < 3e-4, "{name}: {crossing}");
        assert!(crossing <= seconds && seconds - crossing < 0.031_26);
    }
}

/// The controller of Yang et al. is told the fault that acts: the same one, whichever method integrates the plant.
#[test]
fn a_controller_that_is_told_its_fault_is_told_the_same_by_both_integrators() {
    let folder = folder();
    let mut scenario = json(&cut("yang2025.json", 50.0, folder.path()));
    let mut ran = |integrator: Value| -> Value {
        set(&mut scenario, "/integrator", integrator);
        let path = write(folder.path(), "told.json", scenario.to_string());
        let run = steadfast([Path::new("simulate"), &path, Path::new("--json")]);
        serde_json::from_str(&run.stdout).expect("a summary")
    };
    let fixed = ran(json!({ "runge_kutta4": { "step_s": 0.01 } }));
    let adaptive = ran(json!({ "dormand_prince853": { "tolerance": 1e-12 } }));
    assert_eq!(fixed["triggers"], adaptive["triggers"]);
    let error = |summary: &Value| number(summary, "/final_error_deg");
    assert_relative(error(&adaptive), error(&fixed), 1e-6);
}

#[test]
fn a_run_of_more_than_a_million_samples_keeps_rows_of_messages_and_says_so() {
    let folder = folder();
    let mut scenario = json(&cut("wu2018.json", 2.1, folder.path()));
    set(
        &mut scenario,
        "/sampling/instants",
        json!({ "periodic": { "interval_s": 2e-6 } }),
    );
    set(&mut scenario, "/output", json!({ "interval_s": 0.01 }));
    let path = write(folder.path(), "fast.json", scenario.to_string());
    let (summary, table) = recorded(&path, None, &folder.path().join("run"));
    assert!(table.rows() < 100_000, "{}", table.rows());
    let sent: f64 = column(&table, "sent").iter().sum();
    assert_eq!(sent, number(&summary, "/triggers"));
    let notes = summary["notes"].to_string();
    assert!(notes.contains("too many samples for a row each"), "{notes}");
}
