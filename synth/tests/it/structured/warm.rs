//! Warm starts: bisections, frozen memories and starts far away.

use super::*;

/// Bisects the torque limit for a gain of 0.14 and counts iterations.
fn bisect(solver: &Structured, steps: u32) -> (f64, u32) {
    let mut file = model("xu2020.json").file;
    let (mut low, mut high) = (1.5, 3.0);
    let mut iterations = 0;
    for _ in 0..steps {
        let middle = 0.5 * (low + high);
        let synth::model::PlantFile::Exact(plant) = &mut file.plant else {
            panic!("an exact plant");
        };
        plant.torque_limit_nm = [middle; 3];
        let model = Model::new(file.clone()).expect("a valid model");
        let (problem, accuracy) = gain_problem(&model, Form::VertexRelaxed);
        let solution = solver.solve(&problem, accuracy, None).unwrap();
        let solved = matches!(solution.status, Status::Solved | Status::Inaccurate);
        assert!(solved, "{middle}: {}", solution.status_text);
        iterations += solution.iterations;
        if solution.objective > 0.14 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (high, iterations)
}

#[test]
fn a_bisection_with_warm_starts_needs_a_third_fewer_iterations() {
    let (cold, cold_iterations) = bisect(&Structured::default(), 6);
    let (warm, warm_iterations) = bisect(&Structured::warm(), 6);
    assert_eq!(cold, warm);
    eprintln!("cold {cold_iterations}, warm {warm_iterations} iterations, limit {warm}");
    assert!(
        3 * warm_iterations <= 2 * cold_iterations,
        "{warm_iterations} of {cold_iterations}"
    );
}

#[test]
#[ignore = "measures times; run alone"]
fn times_of_a_bisection_with_and_without_warm_starts() {
    for (name, solver) in [
        ("cold", Structured::default()),
        ("warm", Structured::warm()),
    ] {
        let begin = std::time::Instant::now();
        let found = bisect(&solver, 10);
        eprintln!(
            "{name}: {found:?} in {:.3} s",
            begin.elapsed().as_secs_f64()
        );
    }
}

#[test]
fn a_frozen_memory_helps_neighbours_and_makes_no_result_depend_on_others() {
    let at = |limit: f64| {
        let mut file = model("xu2020.json").file;
        let synth::model::PlantFile::Exact(plant) = &mut file.plant else {
            panic!("an exact plant");
        };
        plant.torque_limit_nm = [limit; 3];
        gain_problem(
            &Model::new(file).expect("a valid model"),
            Form::VertexRelaxed,
        )
    };
    let run = |solver: &Structured, limit: f64| {
        let (problem, accuracy) = at(limit);
        solver.solve(&problem, accuracy, None).unwrap()
    };
    let first = Structured::warm();
    run(&first, 2.0);
    let frozen = first.frozen();
    let alone = run(&frozen, 2.02);
    run(&frozen, 2.4);
    let again = run(&frozen, 2.02);
    assert!(alone.values == again.values && alone.duals == again.duals);
    let cold = run(&Structured::default(), 2.02);
    assert_close(alone.objective, cold.objective, 1e-6, "objective");
    assert!(
        3 * alone.iterations <= 2 * cold.iterations,
        "{} of {}",
        alone.iterations,
        cold.iterations
    );
}

#[test]
fn a_warm_start_far_away_does_no_harm() {
    let solver = Structured::warm();
    for seed in [1, 2, 1, 3, 1] {
        // The shapes may agree by chance only; the results must be those of a cold start.
        let problem = feasible(seed);
        let mut other = problem.clone();
        other.cost.iter_mut().for_each(|cost| *cost *= 1.7);
        for cone in &mut other.cones {
            cone.constant
                .iter_mut()
                .filter(|e| e.row == e.column)
                .for_each(|e| e.value += 0.8);
        }
        for problem in [&problem, &other] {
            let warm = solver.solve(problem, ACCURACY, None).unwrap();
            assert_close(warm.objective, solve(problem).objective, 1e-6, "objective");
        }
    }
}
