//! Nothing false is printed: a "no" that covers a part of the designs is UNDECIDED, both solvers are asked before any
//! "no", a poor design says so, and what is not proved claims nothing.

use std::path::{Path, PathBuf};

use crate::support::*;
use serde_json::{json, Value};

fn run(verb: &str, file: &Path, more: &[&str]) -> Run {
    let output = command().arg(verb).arg(file).args(more).output();
    Run::new(output.expect("the command runs"))
}

fn cart(folder: &Path, changes: &[(&str, Value)]) -> PathBuf {
    let mut model = json(&shipped("double-integrator.json"));
    for (pointer, value) in changes {
        set(&mut model, pointer, value.clone());
    }
    write(folder, "cart.json", model.to_string())
}

/// Solvers that were asked, each once.
fn solvers(report: &Value) -> Vec<String> {
    let runs = report["solver_runs"].as_array().expect("runs");
    let names = runs
        .iter()
        .map(|run| run["solver"].as_str().expect("a name"));
    let mut names: Vec<String> = names
        .filter_map(|name| name.split(' ').next().map(str::to_string))
        .collect();
    names.sort();
    names.dedup();
    names
}

#[test]
fn states_outside_of_the_box_are_refuted_for_some_rho_only_and_undecided() {
    let folder = folder();
    let model = cart(
        folder.path(),
        &[("/specs/must_contain", json!([[2.0, 0.0]]))],
    );
    let path = folder.path().join("certificate.json");
    let more = ["--json", "--no-relaxations", "-o", path.to_str().unwrap()];
    let report = run("feasibility", &model, &more).ends_with(2).json();
    assert_eq!(report["verdict"], "undecided");
    let shown = report["shown"].as_str().expect("what was shown");
    assert!(shown.contains("rho = 0.5, 1, 0.25, 2"), "{shown}");
    let again = run("verify", &path, &["--json"]).ends_with(2).json();
    assert_eq!(again["verdict"], "undecided");
    let words = run("verify", &path, &[]).ends_with(2).stdout;
    let last = words.lines().last().expect("a line");
    assert!(last.starts_with("verdict: UNDECIDED"), "{words}");
    // A certificate that keeps one of them says no more.
    let mut forged = json(&path);
    let first = forged["infeasibility"][0].clone();
    set(&mut forged, "/infeasibility", json!([first]));
    let forged = write(folder.path(), "forged.json", forged.to_string());
    let report = run("verify", &forged, &["--json"]).ends_with(2).json();
    assert_eq!(report["verdict"], "undecided");
    let words = run("synthesize", &model, &[]).ends_with(2).stdout;
    assert!(
        words.contains("UNDECIDED") && !words.contains("INFEASIBLE"),
        "{words}"
    );
}

/// Refuted for each rho that is tried, this set is contained by designs that no such weight gives.
#[test]
fn a_set_that_no_weight_rho_suits_is_contained_about_a_point() {
    let folder = folder();
    let model = cart(
        folder.path(),
        &[
            ("/specs/phi_per_s", json!(1.0)),
            ("/specs/xi_max", json!(100)),
            (
                "/specs/must_contain",
                json!([[0.64015625, 0.0], [0.0, 0.4]]),
            ),
            ("/specs/objective", json!("gain")),
            ("/specs/eps", json!([1, 1, 1])),
            ("/plant/vertices/input_limit", json!([0.6])),
            ("/plant/vertices/box/0/bound", json!(1)),
            ("/plant/vertices/box/1/bound", json!(1)),
        ],
    );
    let report = run("feasibility", &model, &["--json", "--no-relaxations"]).ends_with(0);
    assert_eq!(report.json()["verdict"], "feasible");
    for solver in ["auto", "structured"] {
        let design = folder.path().join(format!("{solver}.json"));
        let more = ["--json", "--solver", solver, "-o", design.to_str().unwrap()];
        let report = run("synthesize", &model, &more).ends_with(0).json();
        assert_eq!(report["verdict"], "proved", "{solver}");
        // The design made from the smallest slack has 11.45.
        let gain = report["guaranteed_gain"].as_f64().expect("a gain");
        assert!((7.5..8.1).contains(&gain), "{solver}: {gain}");
        let report = run("verify", &design, &["--json"]).ends_with(0).json();
        assert_eq!(report["verdict"], "proved", "{solver}");
    }
}

/// The dual solution has eigenvalues of very different sizes: its equations must hold to more digits than those of a
/// Newton step do.
#[test]
fn a_flexible_arm_a_tenth_beyond_its_edge_is_refuted_and_within_it_has_a_design() {
    let folder = folder();
    let arm = |stiff: f64, damped: f64| {
        let row = |size: f64, damping: f64| json!([-size, size, -damping, damping]);
        let motor = row(-stiff / 0.6, -damped / 0.6);
        json!([[0, 0, 1, 0], [0, 0, 0, 1], row(stiff, damped), motor])
    };
    for (interval, status, verdict) in [(0.1793, 2, "infeasible"), (0.16, 0, "feasible")] {
        let model = json!({
            "schema_version": 1,
            "name": "flexible arm",
            "source": "two masses and a spring",
            "plant": { "vertices": {
                "state_matrices": [arm(8.0, 0.1), arm(12.0, 0.1)],
                "input_matrix": [[0], [0], [0], [10.0 / 3.0]],
                "output_matrix": [[1, 0, 0, 0]],
                "input_limit": [7.5_f64.sqrt()],
                "disturbance_bound": 0.05,
                "box": []
            } },
            "specs": {
                "phi_per_s": 0.1,
                "hbar_s": interval,
                "nu": 0.005,
                "eps": [1, 0.2, 0.2],
                "xi_max": 200,
                "objective": "gain"
            }
        });
        let model = write(folder.path(), "arm.json", model.to_string());
        let path = folder.path().join(format!("{verdict}.json"));
        let more = ["--json", "--no-relaxations", "-o", path.to_str().unwrap()];
        let report = run("feasibility", &model, &more).ends_with(status).json();
        assert_eq!(report["verdict"], verdict, "{interval}");
        let report = run("verify", &path, &["--exact", "--json"])
            .ends_with(0)
            .json();
        assert_eq!(report["verdict"], "proved", "{interval}");
    }
}

#[test]
fn what_is_refuted_without_containment_is_infeasible_for_every_rho() {
    let folder = folder();
    let changes = [
        ("/specs/must_contain", json!([[0.3, 0.0]])),
        ("/plant/vertices/input_limit", json!([0.01])),
    ];
    let model = cart(folder.path(), &changes);
    let path = folder.path().join("certificate.json");
    let more = ["--json", "--no-relaxations", "-o", path.to_str().unwrap()];
    let report = run("feasibility", &model, &more).ends_with(2).json();
    assert_eq!(report["verdict"], "infeasible");
    let file = json(&path);
    let sets = file["infeasibility"].as_array().expect("sets");
    assert_eq!(sets.len(), 1);
    assert_eq!(sets[0].get("containment_weight"), None);
    let again = run("verify", &path, &["--json"]).ends_with(0).json();
    assert_eq!(again["verdict"], "proved");
    // The same weights under a rho would be about that rho.
    let mut other = file.clone();
    other["infeasibility"][0]["containment_weight"] = json!(1.0);
    let other = write(folder.path(), "other.json", other.to_string());
    assert!(run("verify", &other, &[])
        .refusal()
        .contains("must_contain"));
}

#[test]
fn a_refutation_covers_every_xi_however_large_xi_max_is() {
    let folder = folder();
    let changes = [
        ("/specs/xi_max", json!(1e6)),
        ("/plant/vertices/input_limit", json!([0.01])),
    ];
    let model = cart(folder.path(), &changes);
    let path = folder.path().join("certificate.json");
    let more = ["--json", "--no-relaxations", "-o", path.to_str().unwrap()];
    let report = run("feasibility", &model, &more).ends_with(2).json();
    assert_eq!(report["verdict"], "infeasible");
    let again = run("verify", &path, &["--json"]).ends_with(0).json();
    assert_eq!(again["limits"], json!([]));
    // With force enough there is a design, for any xi_max.
    let model = cart(folder.path(), &[("/specs/xi_max", json!(1e6))]);
    run("feasibility", &model, &["--no-relaxations"]).ends_with(0);
}

#[test]
fn a_stable_plant_in_unlike_units_is_proved_whatever_solver_is_asked_first() {
    // Triangular with negative diagonal: quadratically stable, with a P of entries far apart.
    let folder = folder();
    let problem = json!({
        "schema_version": 1,
        "name": "chain",
        "plant": { "vertices": {
            "state_matrices": [[[-0.03, 0, 0], [1e-6, -0.02, 0], [0, 1e4, -0.3]]],
            "input_matrix": [[1], [0], [0]],
        } },
        "gain": [[0, 0, 0]],
        "problem": { "quadratic_stabilisation": { "decay_rate_per_s": 0.001 } },
    });
    let problem = write(folder.path(), "chain.json", problem.to_string());
    // From x2 = 1 the third state reaches 1e4 / 0.28 (e^(-0.02 t) - e^(-0.3 t)) = 27,471 at t = ln(15) / 0.28 s.
    let least = 27_471.0;
    for solver in ["clarabel", "structured"] {
        let all = ["--solver", solver, "--json"];
        let report = run("synthesize", &problem, &all).ends_with(0).json();
        assert_eq!(report["verdict"], "proved", "{report}");
        let overshoot = number(&report, "/guarantee");
        assert!(
            (least..2.0 * least).contains(&overshoot),
            "{overshoot} with {solver}"
        );
    }
}

#[test]
fn modes_that_are_hardly_coupled_are_not_called_infeasible() {
    // Controllable, so that a feedback exists; the solutions have entries beyond 1e10.
    let folder = folder();
    for (coupling, input) in [(7.6e-6, [0.0, 1.0]), (1.0, [1e-6, 1.0])] {
        let problem = json!({
            "schema_version": 1,
            "name": "coupled",
            "plant": { "vertices": {
                "state_matrices": [[[1.0, coupling], [0.0, 0.5]]],
                "input_matrix": [[input[0]], [input[1]]],
            } },
            "problem": { "quadratic_stabilisation": {} },
        });
        let problem = write(folder.path(), "coupled.json", problem.to_string());
        let output = run("synthesize", &problem, &["--json"]);
        assert_ne!(output.json()["status"], "infeasible", "coupling {coupling}");
    }
}

#[test]
fn a_given_feedback_that_cannot_be_proved_is_refuted_for_every_size_of_p() {
    let folder = folder();
    let mut problem = json(&shipped("oscillator-stability.json"));
    let stiffness = "/plant/vertices/state_matrices/1/1/0";
    set(&mut problem, stiffness, json!(-9.1));
    let path = write(folder.path(), "soft.json", problem.to_string());
    let report = run("synthesize", &path, &["--json"]).ends_with(2).json();
    assert_eq!(report["status"], "infeasible");
    assert_eq!(number(&report, "/excluded_radius"), f64::MAX);
    assert_eq!(number(&report, "/excluded_margin"), 0.0);
}

#[test]
fn a_design_beyond_the_models_largest_weight_is_none_for_the_model() {
    let folder = folder();
    // The limit is active: without it the weight is larger.
    let mut model = json(&shipped("saturating-cart.json"));
    set(&mut model, "/specs/xi_max", json!(1.3));
    let model = write(folder.path(), "model.json", model.to_string());
    let design = folder.path().join("design.json");
    let more = ["--json", "-o", design.to_str().unwrap()];
    let report = run("synthesize", &model, &more).ends_with(0).json();
    assert!(number(&report, "/xi") <= 1.3, "{report}");
    let mut file = json(&design);
    set(&mut file, "/model/specs/xi_max", json!(1.0));
    let path = write(folder.path(), "beyond.json", file.to_string());
    let report = run("verify", &path, &["--json"]).ends_with(2).json();
    assert_eq!(report["worst"]["name"], "disturbance weight within xi_max");
}

#[test]
fn a_no_of_the_first_solver_is_followed_by_the_other() {
    let folder = folder();
    // Nearly too weak: no design with a trigger this coarse is found.
    let changes = [
        ("/specs/nu", json!(0.9999)),
        ("/specs/nu_min", json!(0.9999)),
    ];
    let model = cart(folder.path(), &changes);
    let report = run("synthesize", &model, &["--json"]).ends_with(2).json();
    assert_eq!(solvers(&report), ["clarabel", "structured"], "{report}");
}

#[test]
fn a_named_solver_is_the_only_one_that_is_asked_and_the_answer_says_so() {
    let folder = folder();
    // A set that no design is found for, and that cannot be refuted for every rho.
    let outside = ("/specs/must_contain", json!([[2.0, 0.0]]));
    let model = cart(folder.path(), &[outside]);
    for solver in ["clarabel", "structured"] {
        let more = ["--json", "--solver", solver];
        let report = run("synthesize", &model, &more).ends_with(2).json();
        assert_eq!(solvers(&report), [solver], "{report}");
        let words = run("synthesize", &model, &["--solver", solver])
            .ends_with(2)
            .stdout;
        let only =
            format!("only {solver} was asked; with --solver auto the other one is asked too");
        assert!(words.contains(&only), "{words}");
    }
}

#[test]
fn a_design_far_from_the_best_objective_seen_says_so() {
    let folder = folder();
    let changes = [
        ("/specs/eps", json!([16, 16, 16])),
        ("/specs/must_contain", json!([[0.5, 0.0]])),
    ];
    let model = cart(folder.path(), &changes);
    let report = run("synthesize", &model, &["--json"]).ends_with(0).json();
    let gap = number(&report, "/optimality/relative_gap");
    assert!(gap > 0.0, "{gap}");
    let best = number(&report, "/optimality/best_seen");
    assert_relative(number(&report, "/gamma"), best * (1.0 + gap), 1e-12);
    let words = run("synthesize", &model, &[]).ends_with(0).stdout;
    let line = words.lines().find(|line| line.starts_with("verdict: "));
    let says = line
        .expect("a verdict")
        .contains("times worse than the best objective");
    assert_eq!(says, gap > 0.01, "{words}");
    let report = run(
        "synthesize",
        &shipped("double-integrator.json"),
        &["--json"],
    );
    let gap = number(&report.ends_with(0).json(), "/optimality/relative_gap");
    assert!(gap < 0.01, "{gap}");
}

#[test]
fn gains_that_nobody_mixes_are_proved_but_not_exported() {
    let folder = folder();
    let gains = json!({
        "schema_version": 1,
        "name": "two gains",
        "gains": [[[-1.0, -1.5]], [[-1.1, -1.6]]],
    });
    let gains = write(folder.path(), "gains.json", gains.to_string());
    let design = folder.path().join("design.json");
    let model = shipped("double-integrator.json");
    let more = [
        "--model",
        model.to_str().unwrap(),
        "-o",
        design.to_str().unwrap(),
    ];
    run("analyse", &gains, &more).ends_with(0);
    for format in ["c", "csv", "mat"] {
        let output = folder.path().join("out");
        let more = ["--format", format, "-o", output.to_str().unwrap()];
        let message = run("export", &design, &more).refusal();
        assert!(message.contains("2 gains"), "{message}");
        assert!(!output.exists());
    }
}

#[test]
fn a_linear_plant_of_two_rules_is_refuted_without_a_panic() {
    let folder = folder();
    let model = weak_rules(folder.path());
    let certificate = folder.path().join("certificate.json");
    let more = [
        "--json",
        "--no-relaxations",
        "-o",
        certificate.to_str().unwrap(),
    ];
    let report = run("feasibility", &model, &more).ends_with(2).json();
    assert_eq!(report["verdict"], "infeasible");
    run("verify", &certificate, &[]).ends_with(0);
    let gains = json!({ "schema_version": 1, "name": "one", "gains": [[[-1.0, -1.5]]] });
    let gains = write(folder.path(), "gains.json", gains.to_string());
    let more = ["--json", "--model", model.to_str().unwrap()];
    let report = run("analyse", &gains, &more).ends_with(2).json();
    assert_eq!(report["feasibility"], "infeasible");
}

#[test]
fn what_is_not_proved_claims_nothing_and_ends_with_its_verdict() {
    let folder = folder();
    let mut design = json(double_integrator_design());
    let gamma = 0.5 * number(&design, "/certificate/gamma");
    set(&mut design, "/certificate/gamma", json!(gamma));
    let path = write(folder.path(), "tampered.json", design.to_string());
    let words = run("verify", &path, &[]).ends_with(2).stdout;
    assert_eq!(words.lines().last(), Some("verdict: NOT PROVED"), "{words}");
    for claim in [
        "gamma",
        "guaranteed",
        "certified set",
        "transmissions",
        "assumes",
    ] {
        assert!(
            !words.contains(claim) || words.contains("not proved: "),
            "{claim}: {words}"
        );
        assert!(!words.contains(&format!("{claim}:")), "{claim}: {words}");
    }
    let report = run("verify", &path, &["--json"]).ends_with(2).json();
    assert_claims_nothing(&report);
    assert_eq!(report["max_transmissions_per_s"], Value::Null);
}

#[test]
fn a_header_with_a_missing_or_a_further_number_is_refused() {
    let folder = folder();
    let entries = "0 1 1 2 3.0\n1 1 1 1 1.0\n2 1 2 2 1.0\n3 1 1 2 1.0\n";
    let refusal = |name: &str, header: &str| {
        let path = write(folder.path(), name, format!("{header}\n{entries}"));
        run("solve", &path, &[]).refusal()
    };
    let short = refusal("costs.dat-s", "3\n1\n2\n1000 900");
    assert!(
        short.contains("line 5: the costs must be 3 numbers, and 2"),
        "{short}"
    );
    let short = refusal("sizes.dat-s", "3\n2\n2\n1000 900 5");
    assert!(
        short.contains("the sizes of the blocks must be 2 numbers"),
        "{short}"
    );
    let long = refusal("long.dat-s", "3\n1\n2\n1000 900 5 7");
    assert!(
        long.contains("line 4: the costs must be 3 numbers, and 4"),
        "{long}"
    );
    // On more than one line, and with remarks, they are all there.
    let path = write(
        folder.path(),
        "whole.dat-s",
        format!("3 = m\n1 = blocks\n(2) = sizes\n{{1000, 900,\n5}}\n{entries}"),
    );
    run("solve", &path, &["--json"]).ends_with(0);
}

/// The JSON files of a folder that a variable of the environment names.
fn outside_files(variable: &str) -> Vec<PathBuf> {
    let Some(folder) = std::env::var_os(variable) else {
        eprintln!("SKIPPED: {variable} names no folder; nothing was checked");
        return Vec::new();
    };
    let entries = std::fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let mut paths: Vec<PathBuf> = paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "json"))
        .collect();
    paths.sort();
    paths
}

#[test]
fn stabilisable_plants_of_compleib_are_never_called_infeasible() {
    for path in outside_files("STEADFAST_COMPLEIB") {
        for solver in ["clarabel", "structured"] {
            let output = command()
                .args([Path::new("synthesize"), &path, Path::new("--json")])
                .args(["--solver", solver])
                .output();
            let run = Run::new(output.expect("the command runs"));
            let report = run.json();
            assert_ne!(
                report["status"],
                "infeasible",
                "{} {solver}",
                path.display()
            );
        }
    }
}

#[test]
fn certificates_beside_a_proved_design_are_undecided() {
    for path in outside_files("STEADFAST_FAULTS") {
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .to_string();
        if json(&path).get("infeasibility").is_none() {
            continue;
        }
        let report = run("verify", &path, &["--json"]).ends_with(2).json();
        let expected = match name.starts_with("panic") {
            true => "not_proved",
            false => "undecided",
        };
        assert_eq!(report["verdict"], expected, "{name}");
    }
}
