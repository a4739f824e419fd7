//! Modes that no input reaches: refuted exactly where they decay too slowly, and nowhere else.

use super::*;
use crate::exact::Stream;
use synth::problem::first_program;
use synth::solve::Clarabel;
use synth::solve::{Accuracy, Backend, Status};

/// A plant `T [A11 A12; 0 A22] T^-1`, `T [B1; 0]` in exact doubles: A11 and B1 are reachable, T is unimodular.
struct Split {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    /// The largest real part of an eigenvalue of A22.
    growth: f64,
}

/// A multiple of a quarter in [-2, 2].
fn quarter(stream: &mut Stream) -> f64 {
    stream.integer(-8, 8) as f64 / 4.0
}

/// Block triangular with real eigenvalues and pairs of conjugates in quarters; with the largest real part.
fn of_known_growth(stream: &mut Stream, side: usize) -> (DMatrix<f64>, f64) {
    let mut out = DMatrix::zeros(side, side);
    let (mut growth, mut start) = (f64::NEG_INFINITY, 0);
    while start < side {
        let real = quarter(stream);
        let size = if stream.integer(0, 1) == 1 && start + 1 < side {
            2
        } else {
            1
        };
        for k in start..start + size {
            out[(k, k)] = real;
            for right in start + size..side {
                out[(k, right)] = quarter(stream);
            }
        }
        if size == 2 {
            let imaginary = 0.25 + quarter(stream).abs();
            out[(start, start + 1)] = imaginary;
            out[(start + 1, start)] = -imaginary;
        }
        growth = growth.max(real);
        start += size;
    }
    (out, growth)
}

fn split(stream: &mut Stream, reached: usize, unreached: usize) -> Split {
    let n = reached + unreached;
    let mut a = DMatrix::zeros(n, n);
    let mut b = DMatrix::zeros(n, 1);
    for row in 0..reached {
        for column in reached..n {
            a[(row, column)] = quarter(stream);
        }
        match row + 1 == reached {
            true => (0..reached).for_each(|column| a[(row, column)] = quarter(stream)),
            false => a[(row, row + 1)] = 1.0,
        }
    }
    if reached > 0 {
        b[(reached - 1, 0)] = 1.0;
    }
    let (a22, growth) = of_known_growth(stream, unreached);
    a.view_mut((reached, reached), (unreached, unreached))
        .copy_from(&a22);
    // Shears: the row of one state is added to that of another, the column of the other subtracted.
    for _ in 0..3 * n {
        let (to, from) = (
            stream.integer(0, n as i64 - 1) as usize,
            stream.integer(0, n as i64 - 1) as usize,
        );
        if to != from {
            let factor = stream.integer(-1, 1) as f64;
            for matrix in [&mut a, &mut b] {
                let added = matrix.row(from) * factor;
                let mut row = matrix.row_mut(to);
                row += added;
            }
            let subtracted = a.column(to) * factor;
            let mut column = a.column_mut(from);
            column -= subtracted;
        }
    }
    Split { a, b, growth }
}

fn rows(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().copied().collect()).collect()
}

/// A file of one of the three kinds, with alpha where the kind has one.
fn file(vertices: &[DMatrix<f64>], b: &DMatrix<f64>, kind: usize, alpha: f64) -> Value {
    let n = b.nrows();
    let identity = rows(&DMatrix::identity(n, n));
    let asked_for = match kind {
        0 => json!({ "quadratic_stabilisation": { "decay_rate_per_s": alpha } }),
        1 => json!({ "saturated_region": { "input_limit": [1], "decay_rate_per_s": alpha } }),
        _ => json!({ "h_infinity": { "disturbance_matrix": identity, "output_matrix": identity } }),
    };
    let vertices: Vec<_> = vertices.iter().map(rows).collect();
    asked(
        json!({ "state_matrices": vertices, "input_matrix": rows(b) }),
        asked_for,
    )
}

fn refuted(file: &Value) -> bool {
    problem(file).unreachable_mode().is_some()
}

#[test]
fn a_plant_is_refuted_exactly_where_its_unreached_part_decays_too_slowly() {
    let mut stream = Stream(20);
    let (mut yes, mut no, mut boundary) = (0, 0, 0);
    for round in 0..600 {
        let reached = stream.integer(0, 3) as usize;
        let unreached = stream.integer(1, 3) as usize;
        let plant = split(&mut stream, reached, unreached);
        let kind = round % 3;
        let alpha = if kind == 2 {
            0.0
        } else {
            stream.integer(0, 6) as f64 / 4.0
        };
        let file = file(&[plant.a], &plant.b, kind, alpha);
        let impossible = plant.growth >= -alpha;
        assert_eq!(refuted(&file), impossible, "{file}");
        match (impossible, plant.growth == -alpha) {
            (true, true) => boundary += 1,
            (true, false) => yes += 1,
            (false, _) => no += 1,
        }
    }
    assert!(
        yes > 100 && no > 50 && boundary > 20,
        "{yes} {no} {boundary}"
    );
}

#[test]
fn a_reachable_plant_is_never_refuted() {
    let mut stream = Stream(21);
    for round in 0..300 {
        let states = stream.integer(1, 6) as usize;
        let plant = split(&mut stream, states, 0);
        assert!(!refuted(&file(&[plant.a], &plant.b, round % 3, 100.0)));
    }
}

#[test]
fn a_mode_that_is_reached_by_a_hair_is_not_refuted() {
    let coupled = |coupling: f64, input: f64| {
        let a = DMatrix::from_row_slice(2, 2, &[1.0, coupling, 0.0, -1.0]);
        file(
            &[a],
            &DMatrix::from_column_slice(2, 1, &[input, 1.0]),
            0,
            0.0,
        )
    };
    assert!(refuted(&coupled(0.0, 0.0)));
    // The least magnitude that a file may have is 1e-30.
    for hair in [1e-12, 1e-30] {
        assert!(!refuted(&coupled(hair, 0.0)) && !refuted(&coupled(0.0, hair)));
    }
    let mut stream = Stream(22);
    for round in 0..300 {
        let reached = stream.integer(1, 4) as usize;
        let mut plant = split(&mut stream, reached, 1);
        let mut moved = |entry: &mut f64| *entry += 1e-12 * stream.signed_unit();
        plant.a.iter_mut().chain(&mut plant.b).for_each(&mut moved);
        assert!(!refuted(&file(&[plant.a], &plant.b, round % 3, 100.0)));
    }
}

#[test]
fn an_eigenvalue_on_the_boundary_counts_and_the_next_double_does_not() {
    // The rate is the double 0.1, not a tenth.
    for (growth, impossible) in [
        (-0.1, true),
        (f64::from_bits((-0.1_f64).to_bits() + 1), false),
        (f64::from_bits((-0.1_f64).to_bits() - 1), true),
    ] {
        let a = DMatrix::from_row_slice(2, 2, &[growth, 0.0, 1.0, 3.0]);
        let b = DMatrix::from_column_slice(2, 1, &[0.0, 1.0]);
        assert_eq!(refuted(&file(&[a], &b, 0, 0.1)), impossible, "{growth:e}");
    }
    // An oscillation that no input reaches neither grows nor decays.
    let a = DMatrix::from_row_slice(2, 2, &[0.0, 3.0, -3.0, 0.0]);
    for kind in 0..3 {
        assert!(refuted(&file(
            std::slice::from_ref(&a),
            &DMatrix::zeros(2, 1),
            kind,
            0.0
        )));
    }
}

#[test]
fn a_mode_between_the_vertices_is_found_and_named() {
    let coupling = |k: f64| DMatrix::from_row_slice(2, 2, &[0.0, k, 0.0, 0.0]);
    let b = DMatrix::from_column_slice(2, 1, &[0.0, 1.0]);
    let mode = |vertices: &[DMatrix<f64>]| problem(&file(vertices, &b, 0, 0.0)).unreachable_mode();
    assert_eq!(mode(&[coupling(0.1), coupling(0.7)]), None);
    let found = mode(&[coupling(0.1), coupling(0.7), coupling(-0.3)]).expect("a mode");
    assert_eq!((found.vertices, found.given_gain), ([0, 2], false));
    let found = mode(&[coupling(0.1), coupling(0.0)]).expect("a mode");
    assert_eq!(found.vertices, [1, 1]);
}

#[test]
fn a_given_feedback_is_refuted_exactly_where_its_loop_does_not_decay() {
    let a = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
    let b = DMatrix::from_column_slice(2, 1, &[0.0, 0.5]);
    for kind in 0..3 {
        for (gain, impossible) in [
            ([-2.0, -2.0], false),
            ([-2.0, 0.0], true),
            ([2.0, -2.0], true),
            ([-0.1, -1e-9], false),
        ] {
            let mut file = file(std::slice::from_ref(&a), &b, kind, 0.0);
            file["gain"] = json!([gain]);
            assert_eq!(refuted(&file), impossible, "{file}");
        }
    }
}

#[test]
fn twenty_four_states_take_seconds_at_most() {
    let mut stream = Stream(23);
    let start = std::time::Instant::now();
    for (reached, unreached) in [(24, 0), (12, 12), (0, 24)] {
        let plant = split(&mut stream, reached, unreached);
        refuted(&file(
            &[plant.a.clone() * 0.3, plant.a * 0.7],
            &plant.b,
            0,
            0.1,
        ));
    }
    // Every entry changes its sign between the vertices, and every loop is stable.
    let mut stable = || {
        let any = DMatrix::from_fn(24, 24, |_, _| stream.signed_unit());
        any - 24.0 * DMatrix::identity(24, 24)
    };
    let vertices = [stable(), stable()];
    let b = DMatrix::from_element(24, 1, 0.3);
    assert!(!refuted(&file(&vertices, &b, 0, 0.1)));
    let mut given = file(&vertices, &b, 0, 0.1);
    given["gain"] = json!([vec![0.1; 24]]);
    assert!(!refuted(&given));
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

/// The design of a plant nearby, with the numbers of this file put into it, is not proved.
fn assert_no_design_nearby(stream: &mut Stream, of: &Value) -> bool {
    let mut near = of.clone();
    let plant = &mut near["plant"]["vertices"];
    let stable = problem(of)
        .plant
        .vertices
        .iter()
        .map(|a| {
            let n = a.nrows();
            let moved = DMatrix::from_fn(n, n, |_, _| stream.signed_unit() / 64.0);
            rows(&(a + moved - DMatrix::identity(n, n) / 32.0))
        })
        .collect::<Vec<_>>();
    plant["state_matrices"] = json!(stable);
    let ProblemOutcome::Solved(design) = outcome(&near) else {
        return false;
    };
    let mut design: Value = serde_json::from_str(&design.file.to_json()).expect("JSON");
    design["model"] = of.clone();
    let (design, problem) = ProblemDesignFile::from_json(&design.to_string()).expect("valid");
    let report = design.verify(&problem).expect("a valid file");
    assert_eq!(report.verdict, Verdict::NotProved, "{of}");
    true
}

#[test]
fn no_solver_finds_a_point_for_a_refuted_problem_and_designs_are_never_refuted() {
    let mut stream = Stream(24);
    let (mut designs, mut beyond, mut near) = (0, 0, 0);
    for round in 0..200 {
        let count = stream.integer(1, 2) as usize;
        let states = stream.integer(1, 3) as usize;
        let integers = |stream: &mut Stream, columns: usize| {
            DMatrix::from_fn(states, columns, |_, _| (stream.integer(-3, 3) / 2) as f64)
        };
        let vertices: Vec<_> = (0..count).map(|_| integers(&mut stream, states)).collect();
        let b = integers(&mut stream, 1);
        let shifted = |by: f64| {
            let shift = by * DMatrix::identity(states, states);
            let vertices: Vec<_> = vertices.iter().map(|a| a - &shift).collect();
            file(&vertices, &b, round % 3, 0.125)
        };
        let file = shifted(0.0);
        if refuted(&file) {
            assert!(matches!(outcome(&file), ProblemOutcome::Infeasible(_)));
            near += usize::from(assert_no_design_nearby(&mut stream, &file));
        } else if let ProblemOutcome::Solved(design) = outcome(&file) {
            designs += usize::from(design.report.verdict == Verdict::Proved);
        }
        // Where Q may be tiny, and on the boundary, solvers stop at points that violate conditions by little.
        if round % 3 == 0 && refuted(&shifted(0.0625)) {
            beyond += 1;
            let accuracy = Accuracy {
                relative_gap: 1e-8,
                objective_unit: 1e-3,
            };
            let lowered = first_program(&problem(&file));
            let solution = Clarabel::default()
                .solve(&lowered, accuracy, None)
                .expect("a run");
            assert_ne!(solution.status, Status::Solved, "{file}");
        }
    }
    println!("{designs} designs, {beyond} beyond the boundary, {near} designs nearby");
    assert!(
        designs > 50 && beyond > 20 && near > 0,
        "{designs} {beyond} {near}"
    );
}
