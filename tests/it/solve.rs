//! `steadfast solve FILE.dat-s` and the solver options of `synthesize`.

use std::io::Write;
use std::path::PathBuf;
use std::process::Command;

use crate::support::solvers::csdp;
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
    let radius = number(&report, "/excluded_radius");
    assert!(radius > 1e6, "{report}");
    assert!(number(&report, "/certificate_residual") < 1e-8, "{report}");
    let words = solve(contradiction, &[]).ends_with(2).stdout;
    let proved = "proved: no point satisfies the conditions";
    assert!(words.contains(proved), "{words}");
    // With a third, the equations are met to rounding only; in words the radius is rounded down.
    let contradiction = "1\n2\n1 1\n1\n0 1 1 1 1\n1 1 1 1 0.3\n1 2 1 1 -0.1\n";
    let report = solve(contradiction, &["--json"]).ends_with(2).json();
    let radius = number(&report, "/excluded_radius");
    let words = solve(contradiction, &[]).ends_with(2).stdout;
    match words.split_once("every unknown below ") {
        Some((_, said)) => {
            let said = said.split(' ').next().expect("a number");
            let said: f64 = said.parse().expect(&words);
            assert!(said <= radius && said > 0.8 * radius, "{said} of {radius}");
        }
        None => assert!(words.contains(proved) && radius == f64::MAX, "{words}"),
    }
}

#[test]
fn a_problem_without_a_lower_bound_is_proved_so() {
    // min -y1 with [y1, 1; 1, y1 + y2] >= 0.
    let falling = "2\n1\n2\n-1 0\n0 1 1 2 -1\n1 1 1 1 1\n1 1 2 2 1\n2 1 2 2 1\n";
    for solver in ["auto", "structured", "clarabel"] {
        let report = solve(falling, &["--json", "--solver", solver])
            .ends_with(2)
            .json();
        assert_eq!(report["status"], "unbounded", "{report}");
        assert!(number(&report, "/certificate_residual") < 1e-8, "{report}");
    }
    // An unknown with a cost that no condition holds.
    let free = "2\n1\n1\n1 -1\n1 1 1 1 1\n";
    let report = solve(free, &["--json"]).ends_with(2).json();
    assert_eq!(report["status"], "unbounded", "{report}");
}

#[test]
fn a_problem_whose_points_are_very_large_is_not_called_infeasible() {
    // 1e-15 y >= 3 and y >= 1: 3e15. Clarabel claims that there is no point.
    let far = "1\n1\n-2\n5\n0 1 1 1 3\n0 1 2 2 1\n1 1 1 1 1e-15\n1 1 2 2 1\n";
    for solver in ["auto", "structured", "clarabel"] {
        let report = solve(far, &["--json", "--solver", solver]).json();
        assert_ne!(report["status"], "infeasible", "{report}");
    }
}

fn data(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/sdpa");
    folder.join(name)
}

fn solve_data(name: &str, more: &[&str]) -> Run {
    let output = command().arg("solve").arg(data(name)).args(more).output();
    Run::new(output.expect("the command runs"))
}

/// min y1 + 4 y2 + 5 y3 with [y1, 1; 1, y2] >= 0, y3 >= 3, y3 >= 1: 4 + 15.
#[test]
fn every_way_of_writing_a_problem_that_sdpa_defines_has_its_optimum() {
    let names = [
        "plain.dat-s",
        "plain.dat",
        "byte-order-mark.dat-s",
        "several-entries-a-line.dat-s",
        "remarks.dat-s",
    ];
    for name in names {
        let report = solve_data(name, &["--json"]).ends_with(0).json();
        assert_eq!(report["status"], "solved", "{name}: {report}");
        let objective = number(&report, "/objective");
        assert!((objective - 19.0).abs() < 1e-5, "{name}: {report}");
    }
    if let Some(optimum) = csdp(&data("plain.dat-s")) {
        assert!((optimum.primal - 19.0).abs() < 1e-5, "{optimum:?}");
    }
}

#[test]
fn a_compressed_file_is_read_as_what_it_holds() {
    let folder = folder();
    for name in ["plain.dat-s", "plain.dat"] {
        let plain = std::fs::read(data(name)).expect("a file");
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        packed.write_all(&plain).expect("compression");
        let packed = packed.finish().expect("compression");
        let file = folder.path().join(format!("{name}.gz"));
        std::fs::write(&file, &packed).expect("written");
        let run = |file: &std::path::Path| {
            let output = command().arg("solve").arg(file).arg("--json").output();
            Run::new(output.expect("the command runs"))
        };
        let report = run(&file).ends_with(0).json();
        assert!(
            (number(&report, "/objective") - 19.0).abs() < 1e-5,
            "{report}"
        );
        std::fs::write(&file, &packed[..packed.len() / 2]).expect("written");
        let message = run(&file).refusal();
        assert!(message.contains("cannot be decompressed"), "{message}");
    }
}

#[test]
fn what_sdpa_does_not_define_is_refused_with_line_and_reason() {
    let refused = [
        (
            "cost-missing.dat-s",
            "line 5: the costs must be 3 numbers, and 2",
        ),
        (
            "costs-line-missing.dat-s",
            "line 4: the costs must be 3 numbers, and 5",
        ),
        (
            "size-missing.dat-s",
            "line 4: the sizes of the blocks must be 2 numbers, and 4",
        ),
        (
            "entry-twice.dat-s",
            "line 12: entry (2, 2) of block 2 of matrix 3 was given on line 11",
        ),
        (
            "both-triangles.dat-s",
            "line 12: entry (2, 1) of block 1 of matrix 0 was given on line 5 as (1, 2)",
        ),
        (
            "number-in-remark.dat-s",
            "line 6: the number '2' stands in the remark",
        ),
        (
            "integer-section.dat-s",
            "line 12: a section *INTEGER is not supported",
        ),
        (
            "not-symmetric.dat",
            "line 6: matrix 0, block 1 is not symmetric",
        ),
        (
            "incomplete.dat",
            "the file ends within matrix 3, block 1: 0 of its 4 numbers",
        ),
    ];
    for (name, reason) in refused {
        let message = solve_data(name, &[]).refusal();
        assert!(message.contains(reason), "{name}: {message}");
        assert!(message.contains(name), "{message}");
    }
}

/// min sum of y with Diag(y) >= the Laplacian of a ring of n nodes, over 4: for even n the largest cut, n.
fn ring(nodes: usize) -> String {
    let costs = vec!["1"; nodes].join(" ");
    let mut text = format!("{nodes}\n1\n{nodes}\n{costs}\n");
    for node in 1..=nodes {
        let next = node % nodes + 1;
        text +=
            &format!("0 1 {node} {node} 0.5\n0 1 {node} {next} -0.25\n{node} 1 {node} {node} 1\n");
    }
    text
}

#[test]
#[cfg(target_os = "linux")]
fn a_cone_that_clarabel_has_no_memory_for_is_refused_and_left_to_the_structured_solver() {
    let folder = folder();
    let file = write(folder.path(), "ring.dat-s", ring(120));
    let limited = |solver: &str| {
        let binary = env!("CARGO_BIN_EXE_steadfast");
        // 2 GB of address space; Clarabel needs about 3.2 GB.
        let line = format!(
            "ulimit -v 2000000; exec {binary} solve {} --json --solver {solver}",
            file.display()
        );
        let output = Command::new("sh").arg("-c").arg(line).output();
        Run::new(output.expect("a shell"))
    };
    let message = limited("clarabel").refusal();
    assert!(
        message.contains("clarabel needs about 3.") && message.contains("side 120"),
        "{message}"
    );
    assert!(message.contains("bytes) are free"), "{message}");
    let report = limited("auto").ends_with(0).json();
    assert_eq!(report["status"], "solved", "{report}");
    assert!(
        (number(&report, "/objective") - 120.0).abs() < 1e-4,
        "{report}"
    );
}

#[test]
fn an_optimum_that_is_not_attained_is_reported_with_its_residuals() {
    // min y1 with [y1, 1; 1, y2] >= 0: 0, and no point has it.
    let not_attained = "2\n1\n2\n1 0\n0 1 1 2 -1\n1 1 1 1 1\n2 1 2 2 1\n";
    let run = solve(not_attained, &["--json"]);
    let report = run.json();
    let status = report["status"].as_str().expect("a status").to_string();
    assert!(status == "solved" || status == "inaccurate", "{report}");
    assert!(number(&report, "/objective").abs() < 1e-3, "{report}");
    assert!(number(&report, "/uncertainty") < 1e-2, "{report}");
    run.ends_with(0);
}

#[test]
fn a_named_solver_is_used_alone_and_auto_lists_both() {
    // An equation in two inequalities has no interior: y = 1.
    let equation = "1\n2\n1 1\n1\n0 1 1 1 1\n1 1 1 1 1\n0 2 1 1 -1\n1 2 1 1 -1\n";
    for solver in ["structured", "clarabel"] {
        let report = solve(equation, &["--json", "--solver", solver]).json();
        let runs = report["solver_runs"].as_array().expect("a list");
        assert_eq!(runs.len(), 1, "{report}");
        let name = runs[0]["solver"].as_str().expect("a name");
        assert!(name.starts_with(solver), "{report}");
    }
    let report = solve(equation, &["--json"]).ends_with(0).json();
    assert!(
        (number(&report, "/objective") - 1.0).abs() < 1e-4,
        "{report}"
    );
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
        message.contains("line 5: 'nan' is not a finite number"),
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
        number(&report, "/cross_check/relative_difference") < 1e-5,
        "{report}"
    );
}
