//! Random models around the edge of feasibility: few are left unknown, and no verdict contradicts
//! an independent solver by more than its own margin.

use crate::random;
#[allow(dead_code)] // Only CSDP is used here.
use crate::solvers;
use std::path::Path;

use crate::exact::Stream;
use crate::random::Sizes;
use crate::units::in_one_unit;
use synth::feasibility::{decide, Answer, Decision};
use synth::lmi::Semidefinite;
use synth::model::{Model, ModelFile, PlantFile};
use synth::programs::Parameter;
use synth::solve::{Backend, Clarabel, Status};
use synth::synthesis::{assemble, Form, Goal, Solvers};

/// Bisections of the logarithm of a factor in [0, RANGE].
const BISECTIONS: usize = 6;
const RANGE: f64 = 4.5;

/// Distance of the vertex systems from the first, relative to that of independent ones, which no
/// common gain stabilises; and what makes most of them unstable, so that limits matter (1/s).
const SPREAD: f64 = 0.15;
const SHIFT: f64 = 0.1;

/// How far from the edge the models lie, at most, as a logarithm.
const NEAR: f64 = 0.1;

fn text(path: &Path) -> String {
    std::fs::read_to_string(path).expect("a text file")
}

fn decided(model: &Model) -> Decision {
    decide(model, "", &Solvers::suited_to(model), None).expect("a decision")
}

/// The smallest slack without any proof; `None` when the solver fails.
fn smallest_slack(model: &Model) -> Option<f64> {
    let task = in_one_unit(model);
    let goal = Goal::SmallestSlack;
    let problem = assemble(&task, Form::Chordal, goal).problem.lower();
    let solution = Clarabel::default().solve(&problem, goal.accuracy(&task), None);
    let solution = solution.expect("the solver starts");
    let usable = matches!(solution.status, Status::Solved | Status::Inaccurate);
    usable.then_some(solution.objective)
}

/// A random model that one gain can usually stabilise.
fn random_model(stream: &mut Stream) -> Model {
    let sizes = Sizes {
        states: stream.integer(2, 3) as usize,
        inputs: stream.integer(1, 2) as usize,
        vertices: stream.integer(2, 4) as usize,
    };
    let mut file = random::model(stream, sizes, false).file;
    let PlantFile::Vertices(plant) = &mut file.plant else {
        panic!("random models have vertices")
    };
    let first = plant.state_matrices[0].clone();
    for matrix in &mut plant.state_matrices {
        for (r, row) in matrix.iter_mut().enumerate() {
            for (c, entry) in row.iter_mut().enumerate() {
                *entry = first[r][c] + SPREAD * (*entry - first[r][c]);
                if r == c {
                    *entry += SHIFT;
                }
            }
        }
    }
    Model::new(file).expect("a valid model")
}

/// A random model whose requirement is within `NEAR` of the value at which a design ceases to exist;
/// `None` when there is none to begin with, or always one.
fn near_the_edge(stream: &mut Stream, requirement: Parameter) -> Option<Model> {
    let model = random_model(stream);
    let (harder, range) = match requirement {
        Parameter::InputLimits => (-1.0, RANGE),
        // nu stays below 1.
        Parameter::Threshold => (1.0, (0.99 / model.file.specs.nu).ln()),
        _ => (1.0, RANGE),
    };
    let at = |log: f64| requirement.scaled(&model, (harder * log).exp());
    let exists = |model: &Model| Some(smallest_slack(model)? < model.file.specs.margin);
    if !exists(&model)? || exists(&at(range)?)? {
        return None;
    }
    let (mut below, mut above) = (0.0, range);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (below + above);
        match exists(&at(middle)?)? {
            true => below = middle,
            false => above = middle,
        }
    }
    at((0.5 * (below + above) + NEAR * stream.signed_unit()).min(range))
}

/// The problem without the unknowns that occur nowhere (gamma), which CSDP refuses.
fn without_idle_unknowns(mut problem: Semidefinite) -> Semidefinite {
    let mut used = vec![false; problem.cost.len()];
    for (unknown, _) in problem.cones.iter().flat_map(|cone| &cone.coefficients) {
        used[*unknown] = true;
    }
    let number = |unknown: usize| used[..unknown].iter().filter(|used| **used).count();
    for (unknown, _) in problem
        .cones
        .iter_mut()
        .flat_map(|cone| &mut cone.coefficients)
    {
        *unknown = number(*unknown);
    }
    let kept = problem.cost.iter().zip(&used).filter(|(_, used)| **used);
    problem.cost = kept.map(|(cost, _)| *cost).collect();
    problem
}

/// The smallest slack that CSDP finds, with one unit for all states.
fn slack_of_csdp(model: &Model) -> Option<f64> {
    let task = in_one_unit(model);
    let problem = assemble(&task, Form::Chordal, Goal::SmallestSlack)
        .problem
        .lower();
    let problem = without_idle_unknowns(problem);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("slack.dat-s");
    std::fs::write(&path, problem.to_sdpa("smallest slack")).expect("a file");
    let optimum = solvers::csdp(&path)?;
    Some(0.5 * (optimum.primal + optimum.dual))
}

fn judge(seed: u64, count: usize) {
    let requirements = [
        Parameter::InputLimits,
        Parameter::Threshold,
        Parameter::SamplingInterval,
    ];
    let mut stream = Stream(seed);
    let (mut feasible, mut infeasible, mut unknown, mut compared) = (0, 0, 0, 0);
    let mut edges = [0; 3];
    let mut round = 0;
    while feasible + infeasible + unknown < count {
        let requirement = requirements[round % requirements.len()];
        round += 1;
        assert!(round < 50 * count, "the generator finds no edge");
        let Some(model) = near_the_edge(&mut stream, requirement) else {
            continue;
        };
        let decision = decided(&model);
        let slack = decision.slack.unwrap_or(f64::NAN);
        edges[(round - 1) % requirements.len()] += 1;
        let no = match decision.answer {
            Answer::Feasible(_) => {
                feasible += 1;
                false
            }
            Answer::Infeasible(_) => {
                infeasible += 1;
                true
            }
            Answer::Undecided(_) => {
                unknown += 1;
                eprintln!(
                    "unknown: round {round}, {}, slack {slack:e}",
                    requirement.field()
                );
                continue;
            }
        };
        if let Some(other) = slack_of_csdp(&model) {
            let excess = other - model.file.specs.margin;
            let against = if no { -excess } else { excess };
            let own = (slack - model.file.specs.margin).abs();
            assert!(
                against <= own.max(1e-7),
                "round {round}, {}: slack {slack:e}, csdp {other:e}",
                requirement.field()
            );
            compared += 1;
        }
    }
    eprintln!(
        "{feasible} feasible, {infeasible} infeasible, {unknown} unknown, {compared} compared with csdp, \
         {round} models drawn; edges of ubar, nu, hbar: {edges:?}"
    );
    assert!(edges.iter().all(|edges| 5 * edges > count), "{edges:?}");
    assert!(round <= 3 * count, "{round} models drawn");
    assert!(unknown * 20 <= count, "{unknown} of {count} unknown");
    assert!(feasible * 5 > count && infeasible * 5 > count);
}

#[test]
fn a_cart_that_is_too_weak_is_refuted_without_a_trigger_threshold_too() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../models/double-integrator.json"
    );
    let mut file: ModelFile = serde_json::from_str(&text(Path::new(path))).expect("a model file");
    file.specs.nu = 0.0;
    file.specs.nu_min = None;
    let answer = |file: &ModelFile| decided(&Model::new(file.clone()).expect("a model")).answer;
    assert!(matches!(answer(&file), Answer::Feasible(_)));
    let PlantFile::Vertices(plant) = &mut file.plant else {
        panic!("the cart has vertices")
    };
    plant.input_limit = vec![0.01];
    let Answer::Infeasible(proof) = answer(&file) else {
        panic!("not refuted")
    };
    assert_eq!(proof.bound, f64::MAX);
}

#[test]
fn twenty_random_models_near_the_edge_are_decided_as_csdp_decides_them() {
    judge(7, 20);
}

#[test]
#[ignore = "two hundred models: some minutes"]
fn two_hundred_random_models_near_the_edge_are_decided_as_csdp_decides_them() {
    judge(2020, 200);
}
