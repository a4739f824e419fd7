//! Problem files on the command line: synthesis, proof, refusals.

use std::path::{Path, PathBuf};

use crate::support::json_schema::first_fault;
use crate::support::solvers::{csdp, sdpa};
use crate::support::*;
use serde_json::{json, Value};

/// The shipped problems with the number that each is known to guarantee, and how far above or below
/// it the design may stay, relative.
const KNOWN: [(&str, f64, f64); 3] = [
    ("uncertain-coupling.json", 1.0, 1e-3),
    ("buffer-network.json", 2.798_161_6, 1.1e-3),
    ("saturated-pendulum.json", 1.0, 1e-3),
];

const ALL: [&str; 4] = [
    "oscillator-stability.json",
    "uncertain-coupling.json",
    "buffer-network.json",
    "saturated-pendulum.json",
];

fn run(verb: &str, file: &Path, more: &[&str]) -> Run {
    let output = command().arg(verb).arg(file).args(more).output();
    Run::new(output.expect("the command runs"))
}

/// A design of a shipped problem in a folder.
fn designed(folder: &Path, name: &str) -> PathBuf {
    let design = folder.join("design.json");
    let output = ["-o", word(&design)];
    run("synthesize", &shipped(name), &output).ends_with(0);
    design
}

fn schema(kind: &str) -> Value {
    let run = steadfast(["schema", kind]).ends_with(0);
    serde_json::from_str(&run.stdout).expect("a JSON schema")
}

#[test]
fn the_shipped_problems_reach_their_known_answers_and_are_proved_again() {
    for (name, known, tolerance) in KNOWN {
        let folder = folder();
        let design = folder.path().join("design.json");
        let output = ["--json", "-o", word(&design)];
        let report = run("synthesize", &shipped(name), &output)
            .ends_with(0)
            .json();
        assert_eq!(report["status"], "solved");
        assert_eq!(report["verdict"], "proved");
        assert_relative(number(&report, "/guarantee"), known, tolerance);
        let again = run("verify", &design, &["--json"]).ends_with(0).json();
        for key in [
            "problem",
            "verdict",
            "guarantee",
            "gain",
            "conditions",
            "not_covered",
        ] {
            assert_eq!(again[key], report[key], "{name}: {key}");
        }
    }
}

#[test]
fn every_design_of_a_problem_fits_its_schema_and_round_trips() {
    let schema = schema("problem-design");
    for name in ALL {
        let folder = folder();
        let design = designed(folder.path(), name);
        assert_eq!(first_fault(&schema, &json(&design)), None, "{name}");
        let written = text(&design);
        let (file, _) = synth::problem::ProblemDesignFile::from_json(&written).expect("valid");
        assert_eq!(file.to_json(), written);
        let checked = run("check", &design, &["--json"]).ends_with(0).json();
        assert_eq!(checked["kind"], "problem design");
    }
}

#[test]
fn a_problem_is_answered_in_words() {
    let answer = run("synthesize", &shipped("saturated-pendulum.json"), &[]).ends_with(0);
    for part in [
        "saturated_region (analysis of a given feedback, 1 vertices)",
        "verdict: PROVED",
        "guarantee: 0.99",
        "a start in the region x'Px <= 1",
        "nothing written",
    ] {
        assert!(answer.stdout.contains(part), "{part} in {}", answer.stdout);
    }
}

#[test]
fn a_tampered_design_is_not_proved_and_the_condition_is_named() {
    let folder = folder();
    let path = designed(folder.path(), "buffer-network.json");
    let mut design = json(&path);
    set(&mut design, "/certificate/guarantee", json!(2.7));
    let path = write(folder.path(), "tampered.json", design.to_string());
    let report = run("verify", &path, &["--json"]).ends_with(2).json();
    assert_eq!(report["verdict"], "not_proved");
    assert_eq!(report["worst"]["name"], "bounded real vertex 1");
    assert!(run("verify", &path, &[])
        .ends_with(2)
        .stdout
        .contains("NOT PROVED"));
}

#[test]
fn an_infeasible_problem_ends_with_2_names_what_blocks_and_writes_nothing() {
    let folder = folder();
    let mut problem = json(&shipped("oscillator-stability.json"));
    let stiffness = "/plant/vertices/state_matrices/1/1/0";
    set(&mut problem, stiffness, json!(-9.1));
    let path = write(folder.path(), "soft.json", problem.to_string());
    let design = folder.path().join("design.json");
    let output = ["--json", "-o", word(&design)];
    let report = run("synthesize", &path, &output).ends_with(2).json();
    assert_eq!(report["status"], "infeasible");
    assert_eq!(report["verdict"], "not_proved");
    assert_eq!(report["guarantee"], Value::Null);
    assert!(number(&report, "/slack") > 0.0);
    assert!(!report["blocking"].as_array().expect("a list").is_empty());
    assert!(!design.exists());
    let words = run("synthesize", &path, &[]).ends_with(2).stdout;
    assert!(words.contains("INFEASIBLE, proved"), "{words}");
    // What no feedback within the radius satisfies, others, far larger or with a smaller margin, might.
    assert!(number(&report, "/excluded_radius") > 1e3, "{report}");
}

#[test]
fn a_mode_that_no_input_reaches_is_named_and_no_solver_is_asked() {
    let folder = folder();
    let mut problem = json(&shipped("uncertain-coupling.json"));
    let rate = "/problem/quadratic_stabilisation/decay_rate_per_s";
    set(&mut problem, rate, json!(1.01));
    let path = write(folder.path(), "fast.json", problem.to_string());
    let report = run("synthesize", &path, &["--json"]).ends_with(2).json();
    assert_eq!(report["status"], "infeasible");
    assert_eq!(report["solver_runs"], json!([]));
    assert_eq!(number(&report, "/excluded_radius"), f64::MAX);
    let mode =
        "between vertices 1 and 2 no input reaches a mode with growth rate at least -1.01 1/s";
    assert_eq!(report["unreachable_mode"], mode);
    let words = run("synthesize", &path, &[]).ends_with(2).stdout;
    let proved = format!("INFEASIBLE, proved in exact arithmetic: {mode}");
    assert!(words.contains(&proved), "{words}");
}

#[test]
fn independent_solvers_reach_the_same_optimum() {
    for name in ALL {
        let folder = folder();
        let path = folder.path().join("problem.dat-s");
        let more = ["--format", "sdpa", "-o", word(&path)];
        run("export", &shipped(name), &more).ends_with(0);
        let report = run("synthesize", &shipped(name), &["--json"])
            .ends_with(0)
            .json();
        // The optimum of the exported problem is c^2, gamma or 1/beta^2; the design stays 0.1 % above it.
        let guarantee = number(&report, "/guarantee");
        let found = match report["problem"].as_str() {
            Some("quadratic_stabilisation") => guarantee * guarantee,
            Some("saturated_region") => 1.0 / (guarantee * guarantee),
            _ => guarantee,
        };
        for optimum in [csdp(&path), sdpa(&path)].into_iter().flatten() {
            assert_relative(optimum.primal, found, 1.5e-3);
            assert_relative(optimum.dual, found, 1.5e-3);
        }
    }
}

/// The shipped network with a key of its problem changed.
fn network_with(folder: &Path, key: &str, value: f64) -> PathBuf {
    let mut problem = json(&shipped("buffer-network.json"));
    set(
        &mut problem,
        &format!("/problem/h_infinity/{key}"),
        json!(value),
    );
    write(folder, "network.json", problem.to_string())
}

#[test]
fn a_requirement_that_is_missed_is_said_on_the_verdict_line() {
    let folder = folder();
    let met = network_with(folder.path(), "gamma_max", 2.9);
    let report = run("synthesize", &met, &["--json"]).ends_with(0).json();
    assert_eq!(report["requirements"][0]["met"], json!(true));
    let missed = network_with(folder.path(), "gamma_max", 2.7);
    let words = run("synthesize", &missed, &[]).ends_with(2).stdout;
    let verdict = "verdict: PROVED, gamma_max 2.7 is not met";
    assert!(words.contains(verdict), "{words}");
    let report = run("synthesize", &missed, &["--json"]).ends_with(2).json();
    assert_eq!(report["requirements"][0]["limit"], json!(2.7));
    assert_eq!(report["requirements"][0]["met"], json!(false));
}

#[test]
fn a_gain_that_is_asked_for_is_had_or_answered_with_the_nearest() {
    let folder = folder();
    let wanted = network_with(folder.path(), "gamma", 3.5);
    let report = run("synthesize", &wanted, &["--json"]).ends_with(0).json();
    assert_relative(number(&report, "/guarantee"), 3.5, 1e-6);
    let below = network_with(folder.path(), "gamma", 2.7);
    let words = run("synthesize", &below, &[]).ends_with(2).stdout;
    let answer = "UNDECIDED: no feedback with gamma 2.7 was found; the smallest gain of a proved feedback is 2.80";
    assert!(words.contains(answer), "{words}");
    // The nearest is rounded up.
    let report = run("synthesize", &below, &["--json"]).ends_with(2).json();
    let nearest = number(&report, "/wanted/value");
    let said = words.split_once("feedback is ").expect(&words).1;
    let said: f64 = said.lines().next().expect(&words).parse().expect(&words);
    assert!(
        said >= nearest && said < nearest * 1.000_01,
        "{said} of {nearest}"
    );
    let mut both = json(&wanted);
    set(&mut both, "/problem/h_infinity/gamma_max", json!(4));
    set(&mut both, "/problem/h_infinity/gamma", json!(3));
    let both = write(folder.path(), "both.json", both.to_string());
    let message = run("synthesize", &both, &[]).refusal();
    let expected = "'problem.h_infinity.gamma_max': the value 4 is not allowed; it must be left out where gamma is given";
    assert!(message.contains(expected), "{message}");
}

/// Verbs and options that have no meaning for these files.
#[test]
fn what_a_problem_cannot_do_is_said_in_one_sentence() {
    let folder = folder();
    let problem = shipped("saturated-pendulum.json");
    let design = designed(folder.path(), "saturated-pendulum.json");
    let scenario = shipped("double-integrator-closed-loop.json");
    let given = ["--design", word(&design)];
    let cases: [(Run, &str); 7] = [
        (
            run("simulate", &problem, &[]),
            "this is a problem file; a scenario file is expected here",
        ),
        (
            run("simulate", &scenario, &given),
            "this is a problem design file; a design file is expected here",
        ),
        (
            run("synthesize", &design, &[]),
            "this is a problem design file; a model file is expected here",
        ),
        (
            run("verify", &problem, &[]),
            "this is a problem file; a design file is expected here",
        ),
        (
            run("synthesize", &problem, &["--form", "full"]),
            "for which --form has no meaning",
        ),
        (
            run("synthesize", &problem, &["--objective", "gain"]),
            "for which --objective has no meaning",
        ),
        (
            run("export", &design, &["--format", "sdpa", "--form", "full"]),
            "for which --form has no meaning",
        ),
    ];
    for (run, sentence) in cases {
        let message = run.refusal();
        assert!(message.contains(sentence), "{message}");
    }
}

#[test]
fn a_wrong_value_of_a_problem_is_named_with_what_is_allowed() {
    let pendulum = "saturated-pendulum.json";
    let network = "buffer-network.json";
    let region = "/problem/saturated_region";
    let gain = "/problem/h_infinity";
    let cases: [(&str, String, Value, &str); 20] = [
        (pendulum, "/schema_version".into(), json!(2), "the value 2 is not allowed; it must be 1"),
        (pendulum, "/name".into(), json!("a\nb"), "'name': character 2"),
        (pendulum, "/specs".into(), json!({}), "unknown field `specs`"),
        (pendulum, "/plant".into(), json!({ "exact": {} }), "unknown name `exact`, expected `vertices`"),
        (pendulum, "/plant/vertices/state_matrices".into(), json!([]), "1 to 4096 matrices"),
        (pendulum, "/plant/vertices/input_matrix".into(), json!([[1]]), "2 x at least 1"),
        (pendulum, "/gain".into(), json!([[1, 2, 3]]), "field 'gain': found 3 entries in row 1, expected 1 x 2"),
        (pendulum, "/problem".into(), json!({ "pole_placement": {} }), "unknown name `pole_placement`"),
        (pendulum, format!("{region}/input_limit"), json!([1, 1]), "found 2 entries, expected 1 entry, one for each input"),
        (pendulum, format!("{region}/input_limit"), json!([0]), "'problem.saturated_region.input_limit[0]': the value 0 is not allowed; it must be above 0"),
        (pendulum, format!("{region}/decay_rate_per_s"), json!(-1), "0 or above"),
        (pendulum, format!("{region}/reference"), json!({ "ellipsoid": [[1, 2], [2, 1]] }), "positive definite"),
        (pendulum, format!("{region}/reference"), json!({ "points": [[1, 0], [0, 0]] }), "points[1]': the value 0"),
        (pendulum, format!("{region}/box"), json!([{ "row": [1], "bound": 1 }]), "1 x 2"),
        (network, format!("{gain}/disturbance_matrix"), json!([[1]]), "3 x at least 1"),
        (network, format!("{gain}/output_matrix"), json!([[1, 0]]), "at least 1 x 3"),
        (network, format!("{gain}/input_to_output_matrix"), json!([[1, 0]]), "found 1 x 2, expected 5 x 2"),
        (network, format!("{gain}/gamma"), json!(0), "'problem.h_infinity.gamma': the value 0 is not allowed; it must be above 0"),
        (network, format!("{gain}/feedthrough"), json!([[1]]), "unknown field `feedthrough`"),
        (network, format!("{gain}/output_matrix"), json!([["a", 0, 0]]), "expected a number"),
    ];
    for (name, pointer, value, expected) in cases {
        let folder = folder();
        let mut problem = json(&shipped(name));
        set(&mut problem, &pointer, value);
        let path = write(folder.path(), "problem.json", problem.to_string());
        for verb in ["check", "synthesize"] {
            let message = run(verb, &path, &[]).refusal();
            assert!(
                message.contains(expected),
                "'{expected}' is not in: {message}"
            );
        }
    }
}

#[test]
fn a_damaged_design_of_a_problem_is_refused_with_its_field() {
    let folder = folder();
    let path = designed(folder.path(), "saturated-pendulum.json");
    let cases = [
        ("/controller/gain", json!([[-2, -1.5]]), "'controller.gain[0][1]': the value -1.5 is not allowed; it must be -1, as in model.gain"),
        ("/certificate/guarantee", json!(-1), "'certificate.guarantee': the value -1"),
        ("/certificate/lyapunov/0/1", json!(0.5), "the matrix must be symmetric"),
        ("/certificate/auxiliary", json!({}), "'certificate.auxiliary': found no gains, expected saturation_gain"),
        ("/certificate/auxiliary/saturation_gain", json!([[1]]), "'certificate.auxiliary.saturation_gain'"),
        ("/model/problem/saturated_region/input_limit", json!([-1]), "'model.problem.saturated_region.input_limit[0]'"),
    ];
    for (pointer, value, expected) in cases {
        let mut design = json(&path);
        set(&mut design, pointer, value);
        let damaged = write(folder.path(), "damaged.json", design.to_string());
        let message = run("verify", &damaged, &[]).refusal();
        assert!(
            message.contains(expected),
            "'{expected}' is not in: {message}"
        );
    }
}
