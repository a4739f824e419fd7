//! What is said of a file and of a result: the right thing, once, and in the right place.

use std::path::{Path, PathBuf};

use serde_json::json;

use crate::support::refusals::assert_says;
use crate::support::*;

/// The double integrator with an output so large that gamma, which depends on its unit, is far from the gain.
fn other_units(folder: &Path) -> PathBuf {
    let mut model = json(&shipped("double-integrator.json"));
    set(
        &mut model,
        "/plant/vertices/output_matrix",
        json!([[0.001, 0]]),
    );
    set(&mut model, "/specs/objective", json!("gain"));
    write(folder, "units.json", model.to_string())
}

#[test]
fn a_controller_gain_is_not_taken_for_an_angle_and_warnings_are_on_standard_error() {
    let folder = folder();
    let mut scenario = json(&shipped("lei2022.json"));
    let gain = "/controller/lei2022/rate_gain_nm_s_rad";
    assert!(number(&scenario, gain) > 0.0);
    set(&mut scenario, gain, json!(219.2));
    let file = write(folder.path(), "large.json", scenario.to_string());
    let run = steadfast(["check", word(&file)]).ends_with(0);
    assert_eq!(run.stderr, "");
    let mut model = json(&shipped("xu2020.json"));
    set(&mut model, "/plant/exact/disturbance_bound_nm", json!(1e6));
    let file = write(folder.path(), "strong.json", model.to_string());
    let run = steadfast(["check", word(&file)]).ends_with(0);
    assert!(
        run.stderr.contains("warning: ") && !run.stdout.contains("warning"),
        "{run:?}"
    );
    let run = steadfast(["check", word(&file), "--json"]).ends_with(0);
    assert_eq!(run.json()["warnings"].as_array().map(Vec::len), Some(1));
}

#[test]
fn the_cross_check_and_the_export_say_what_their_optimum_bounds_in_units_where_gamma_is_another_number(
) {
    let folder = folder();
    let model = other_units(folder.path());
    let command = [
        "synthesize",
        word(&model),
        "--solver",
        "structured",
        "--cross-check",
        "--json",
    ];
    let report = steadfast(command).ends_with(0).json();
    let proved = number(&report, "/guaranteed_gain");
    for found in report["cross_check"]["found"].as_array().expect("a list") {
        assert!(found["gamma"].is_null());
        // The design is found with a back-off of a thousandth from the optimum.
        assert_relative(number(found, "/guaranteed_gain"), proved, 0.01);
    }
    let program = folder.path().join("p.dat-s");
    steadfast([
        "export",
        word(&model),
        "--format",
        "sdpa",
        "-o",
        word(&program),
    ])
    .ends_with(0);
    let text = text(&program);
    let head = text.lines().next().expect("a line");
    let factor = head
        .split("optimum ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next());
    let factor: f64 = factor
        .and_then(|factor| factor.parse().ok())
        .expect("a factor");
    assert!(
        head.contains("times a bound of the guaranteed gain"),
        "{head}"
    );
    let solved = steadfast(["solve", word(&program), "--json"])
        .ends_with(0)
        .json();
    assert_relative(number(&solved, "/objective") / factor, proved, 0.01);
    // With the objective gamma it is gamma.
    let command = [&command[..], &["--objective", "gamma"]].concat();
    let report = steadfast(command).ends_with(0).json();
    let gamma = number(&report, "/gamma");
    assert_relative(number(&report, "/cross_check/found/0/gamma"), gamma, 0.01);
}

#[test]
fn an_output_that_is_always_0_is_refused_as_an_input() {
    let folder = folder();
    let mut model = json(&shipped("double-integrator.json"));
    set(&mut model, "/plant/vertices/output_matrix", json!([[0, 0]]));
    let file = write(folder.path(), "blind.json", model.to_string());
    for verb in ["check", "synthesize", "feasibility"] {
        let message = steadfast([verb, word(&file)]).refusal();
        assert_says(
            &message,
            &["plant.vertices.output_matrix", "no gain to bound"],
        );
    }
}

#[test]
fn a_gain_that_was_asked_for_and_is_met_is_not_called_worse_than_the_best() {
    let folder = folder();
    let mut model = json(&shipped("double-integrator.json"));
    set(&mut model, "/specs/gamma", json!(500));
    let file = write(folder.path(), "asked.json", model.to_string());
    let run = steadfast(["synthesize", word(&file)]).ends_with(0);
    assert!(
        run.stdout.contains("PROVED") && !run.stdout.contains("worse"),
        "{run:?}"
    );
}

#[test]
fn a_number_that_is_too_small_to_be_read_is_not_taken_for_0() {
    let folder = folder();
    let model = text(&shipped("double-integrator.json"));
    let bound = "\"disturbance_bound\":";
    let at = model.find(bound).expect("a bound") + bound.len();
    let end = at + model[at..].find([',', '\n', '}']).expect("an end");
    let changed = format!("{} 1e-400{}", &model[..at], &model[end..]);
    let file = write(folder.path(), "tiny.json", changed);
    let message = steadfast(["check", word(&file)]).refusal();
    assert_says(&message, &["disturbance_bound", "1e-400", "1e-30 to 1e30"]);
}

#[test]
fn a_sampling_interval_longer_than_the_time_to_settle_is_refused_before_the_search() {
    let folder = folder();
    let mut requirements = json(&shipped("requirements-large.json"));
    set(&mut requirements, "/sampling_interval_s", json!(1e9));
    let file = write(folder.path(), "slow.json", requirements.to_string());
    let message = steadfast(["check", word(&file)]).refusal();
    assert_says(
        &message,
        &["sampling_interval_s", "at most limits.settle_s"],
    );
}

#[test]
fn what_is_no_json_is_said_before_what_its_first_part_would_mean() {
    let folder = folder();
    let model = text(&shipped("double-integrator.json"));
    let key = "\"phi_per_s\":";
    let at = model.find(key).expect("a rate") + key.len();
    let end = at + model[at..].find([',', '\n', '}']).expect("an end");
    for value in ["0x10", "1_000", "0.05 0.06"] {
        let changed = format!("{} {value}{}", &model[..at], &model[end..]);
        let file = write(folder.path(), "odd.json", changed);
        let message = steadfast(["check", word(&file)]).refusal();
        assert!(
            !message.contains("the value 0 is") && !message.contains('?'),
            "{message}"
        );
    }
    let file = write(folder.path(), "table.json", "time_s,error_deg\n0,1\n");
    let message = steadfast(["check", word(&file)]).refusal();
    assert_says(
        &message,
        &["not JSON: the file begins with \"time_s,error_deg"],
    );
}

#[test]
fn where_one_name_is_expected_it_is_said_what_was_found() {
    let folder = folder();
    let cases = [
        (
            "/plant",
            json!({}),
            "found an object without a name, expected one name",
        ),
        ("/plant", json!([]), "found a list, expected one name"),
        ("/specs/objective", json!(3), "found the number 3"),
    ];
    for (place, value, expected) in cases {
        let mut model = json(&shipped("double-integrator.json"));
        if model.pointer(place).is_none() {
            model["specs"]["objective"] = json!("gain");
        }
        set(&mut model, place, value);
        let file = write(folder.path(), "one.json", model.to_string());
        assert_says(&steadfast(["check", word(&file)]).refusal(), &[expected]);
    }
    let mut model = json(&shipped("double-integrator.json"));
    model["problem"] = json!({});
    let file = write(folder.path(), "both.json", model.to_string());
    assert_says(
        &steadfast(["check", word(&file)]).refusal(),
        &["unknown field", "problem"],
    );
}

#[test]
fn the_limits_of_whole_numbers_are_named() {
    let folder = folder();
    let mut scenario = json(&shipped("wu2018.json"));
    set(&mut scenario, "/random/seed", json!(1.8446744073709552e19));
    let file = write(folder.path(), "seed.json", scenario.to_string());
    let message = steadfast(["check", word(&file)]).refusal();
    assert_says(&message, &["a whole number from 0 to 18446744073709551615"]);
    let wu = shipped("wu2018.json");
    for runs in ["99999999999999999999999", "0", "2.5"] {
        let command = ["campaign", word(&wu), "--runs", runs, "-o", "nowhere"];
        assert_says(
            &steadfast(command).refusal(),
            &["--runs", "from 1 to 10000000"],
        );
    }
}

#[test]
fn a_file_in_the_place_of_a_folder_and_a_temporary_name_are_not_passed_on() {
    let folder = folder();
    let file = write(folder.path(), "unrelated.txt", "mine");
    let cart = shipped("double-integrator.json");
    let target = file.join("o");
    let message = steadfast(["synthesize", word(&cart), "-o", word(&target)]).refusal();
    assert_says(&message, &["unrelated.txt is a file, not a folder"]);
    let message = steadfast(["synthesize", word(&cart), "-o", "/proc/o.json"]).refusal();
    assert!(!message.contains(".tmp"), "{message}");
}

#[test]
#[cfg(target_os = "linux")]
fn where_standard_output_is_full_it_is_said_what_was_written() {
    let folder = folder();
    let full = || std::fs::File::create("/dev/full").expect("a device");
    let design = folder.path().join("design.json");
    let cart = shipped("double-integrator.json");
    let written = command()
        .args(["synthesize", word(&cart), "-o", word(&design)])
        .stdout(full())
        .output();
    let run = Run::new(written.expect("it runs"));
    assert_eq!(run.status, Some(1));
    assert!(
        run.stderr
            .contains(&format!("written before: {}", design.display())),
        "{run:?}"
    );
    let help = command()
        .arg("--help")
        .stdout(full())
        .output()
        .expect("it runs");
    assert_eq!(Run::new(help).status, Some(1));
}

#[test]
fn a_comparison_says_of_its_design_whether_it_is_proved_and_an_export_where_it_is() {
    let folder = folder();
    let design = double_integrator_design();
    let header = folder.path().join("design.h");
    let run =
        steadfast(["export", word(design), "--format", "c", "-o", word(&header)]).ends_with(0);
    assert_eq!(run.stderr.trim(), format!("written: {}", header.display()));
    let mut tampered = json(xu2020_design());
    set(&mut tampered, "/certificate/gamma", json!(1e-9));
    let tampered = write(folder.path(), "tampered.json", tampered.to_string());
    let scenario = cut("xu2020-closed-loop.json", 3.0, folder.path());
    let command = [
        "compare",
        word(&scenario),
        word(&scenario),
        "--without-faults",
        "--design",
        word(&tampered),
    ];
    let run = steadfast(command);
    assert!(run.stderr.contains("NOT PROVED"), "{run:?}");
}

#[test]
fn one_settling_time_has_one_rendering_that_is_rounded_up() {
    let folder = folder();
    let scenario = shipped("double-integrator-closed-loop.json");
    let design = double_integrator_design();
    let out = folder.path().join("run");
    let run = simulated(&scenario, Some(design), &out);
    let settled = run
        .stdout
        .lines()
        .find_map(|line| line.strip_prefix("settled: from "));
    let Some(shown) = settled.and_then(|rest| rest.strip_suffix(" s on")) else {
        panic!("{run:?}");
    };
    let exact = number(&json(&out.join("summary.json")), "/settle_seconds");
    let rounded: f64 = shown.parse().expect("a number");
    assert!(
        rounded >= exact && rounded < exact * 1.00001,
        "{shown} {exact}"
    );
    assert!(text(&out.join("report.html")).contains(&format!("<td>{shown}</td>")));
    for line in run
        .stdout
        .lines()
        .filter(|line| line.starts_with("requirement settle_seconds"))
    {
        assert!(line.contains(&format!(": {shown} s, met")), "{line}");
    }
}
