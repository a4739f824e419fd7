//! `steadfast solve FILE.dat-s` and the solver options of `synthesize`.

use crate::support::*;

/// min y1 + y2 with [y1, 1; 1, y2] >= 0: 2.
const HYPERBOLA: &str = "2\n1\n2\n1 1\n0 1 1 2 -1\n1 1 1 1 1\n2 1 2 2 1\n";

fn solve(contents: &str, more: &[&str]) -> Run {
    let folder = folder();
    let file = write(folder.path(), "problem.dat-s", contents);
    let output = command().arg("solve").arg(file).args(more).output();
    Run::new(output.expect("the command runs"))
}

#[test]
fn both_solvers_find_a_known_optimum() {
    for solver in ["structured", "clarabel"] {
        let report = solve(HYPERBOLA, &["--json", "--solver", solver])
            .ends_with(0)
            .json();
        assert_eq!(report["status"], "solved");
        assert!(
            (number(&report, "/objective") - 2.0).abs() < 1e-6,
            "{report}"
        );
        assert!(number(&report, "/violation") < 1e-7, "{report}");
        assert_eq!(report["unknowns"], 2);
    }
    let text = solve(HYPERBOLA, &[]).ends_with(0).stdout;
    assert!(
        text.contains("objective: 2.0000000") || text.contains("objective: 1.9999999"),
        "{text}"
    );
}

#[test]
fn an_infeasible_problem_is_proved_so() {
    // y >= 1 and -y >= 0.
    let contradiction = "1\n2\n1 1\n1\n0 1 1 1 1\n1 1 1 1 1\n1 2 1 1 -1\n";
    let report = solve(contradiction, &["--json"]).ends_with(2).json();
    assert_eq!(report["status"], "infeasible");
    assert_eq!(report["objective"], serde_json::Value::Null);
    assert!(number(&report, "/excluded_radius") > 1e6, "{report}");
}

#[test]
fn wrong_files_are_refused_with_the_line() {
    let message = solve("2\n1\n2\n1 1\n0 1 1 3 -1\n", &[]).refusal();
    assert!(
        message.contains("line 5") && message.contains("the column is 3"),
        "{message}"
    );
    let message = solve("1\n1\n1\n1\n0 1 1 1 nan\n", &[]).refusal();
    assert!(
        message.contains("not finite") && message.contains("block 1"),
        "{message}"
    );
    solve("", &[]).refusal();
}

#[test]
fn the_structured_solver_designs_and_the_cross_check_agrees() {
    let model = shipped("double-integrator.json");
    let more = ["--solver", "structured", "--cross-check", "--json"];
    let output = command().arg("synthesize").arg(model).args(more).output();
    let report = Run::new(output.expect("the command runs"))
        .ends_with(0)
        .json();
    assert_eq!(report["verdict"], "proved");
    assert_eq!(report["form"], "slack");
    assert!(
        number(&report, "/cross_check/relative_difference") < 1e-6,
        "{report}"
    );
}
