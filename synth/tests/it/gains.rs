//! Single designs: the same in other units, at a gain that is asked for, without a limit on xi, with nu = 0; and no
//! model with both a proved design and a proved refutation.

use crate::exact::Stream;
use crate::random::{self, Sizes};
use serde_json::{json, Value};
use synth::certify::Verdict;
use synth::design::DesignFile;
use synth::feasibility::{decide, Answer};
use synth::model::{Model, ModelFile, PlantFile};
use synth::solve::Solver;
use synth::synthesis::{synthesize, Form, Outcome, Solvers};

/// Decades over which units are drawn.
const DECADES: f64 = 6.0;

/// A gain may differ by this much, relative, where a model is stated in other units.
const SAME: f64 = 1e-3;

fn outcome(model: &Model) -> Outcome {
    synthesize(model, "", &Solvers::suited_to(model), None).expect("the solvers start")
}

/// The design of a file, which a reader of its text proves again.
#[track_caller]
fn proved(file: &Value) -> DesignFile {
    let model = Model::from_json(&file.to_string()).expect("a valid model");
    let Outcome::Solved(design) = outcome(&model) else {
        panic!("no design: {file}");
    };
    let (read, model) = DesignFile::from_json(&design.file.to_json()).expect("a valid design");
    let report = read.verify(&model).expect("a design of the model");
    assert_eq!(report.verdict, Verdict::Proved, "{:?}", report.worst());
    read
}

fn cart() -> Value {
    json!({
        "schema_version": 1, "name": "cart",
        "plant": { "vertices": {
            "state_matrices": [[[0, 1], [0, 0]], [[0, 1], [0, -0.1]]],
            "input_matrix": [[0], [1]], "input_limit": [1], "disturbance_bound": 0.02,
            "box": [{ "row": [1, 0], "bound": 1 }, { "row": [0, 1], "bound": 1 }]
        } },
        "specs": { "phi_per_s": 0.1, "hbar_s": 0.05, "nu": 0.05 }
    })
}

/// A model in units drawn over the decades; with the factor from its gains to those of the given one.
fn restated(file: &ModelFile, stream: &mut Stream) -> (ModelFile, f64) {
    let mut draw = || 10_f64.powf(0.5 * DECADES * stream.signed_unit());
    let mut file = file.clone();
    let PlantFile::Vertices(plant) = &mut file.plant else {
        panic!("random models have vertices")
    };
    let states: Vec<f64> = plant.input_matrix.iter().map(|_| draw()).collect();
    let inputs: Vec<f64> = plant.input_limit.iter().map(|_| draw()).collect();
    let (disturbance, output) = (draw(), draw());
    for matrix in &mut plant.state_matrices {
        for (row, entries) in matrix.iter_mut().enumerate() {
            for (column, entry) in entries.iter_mut().enumerate() {
                *entry *= states[column] / states[row];
            }
        }
    }
    let count = states.len();
    let n = inputs.len();
    let given = plant.disturbance_matrix.clone();
    let mut through = given.unwrap_or(plant.input_matrix.clone());
    for (row, entries) in through.iter_mut().enumerate() {
        entries
            .iter_mut()
            .for_each(|entry| *entry *= disturbance / states[row]);
    }
    plant.disturbance_matrix = Some(through);
    for (row, entries) in plant.input_matrix.iter_mut().enumerate() {
        for (column, entry) in entries.iter_mut().enumerate() {
            *entry *= inputs[column] / states[row];
        }
    }
    for (limit, unit) in plant.input_limit.iter_mut().zip(&inputs) {
        *limit /= unit;
    }
    plant.disturbance_bound /= disturbance;
    for bound in &mut plant.region {
        bound
            .row
            .iter_mut()
            .zip(&states)
            .for_each(|(entry, unit)| *entry *= unit);
    }
    for state in &mut file.specs.must_contain {
        let entries = state.iter_mut().zip(&states);
        entries.for_each(|(entry, unit)| *entry /= unit);
    }
    let identity = |row: usize| (0..count).map(|k| f64::from(u8::from(k == row))).collect();
    let outputs = plant.output_matrix.clone();
    let mut outputs = outputs.unwrap_or((0..count).map(identity).collect());
    for row in &mut outputs {
        row.iter_mut()
            .zip(&states)
            .for_each(|(entry, unit)| *entry *= unit / output);
    }
    plant.output_matrix = Some(outputs);
    assert_eq!(n, plant.input_limit.len());
    (file, output / disturbance)
}

#[test]
fn the_guaranteed_gain_is_the_same_in_other_units() {
    let mut stream = Stream(41);
    let cart = Model::from_json(&cart().to_string())
        .expect("a valid model")
        .file;
    let mut compared = 0;
    for round in 0..15 {
        let file = match round {
            0..4 => cart.clone(),
            12.. => {
                let mut file = cart.clone();
                file.specs.must_contain = vec![vec![0.3, 0.1], vec![-0.1, 0.2]];
                file
            }
            _ => {
                let sizes = Sizes {
                    states: 2 + round % 2,
                    inputs: 1,
                    vertices: 2,
                };
                let mut file = random::model(&mut stream, sizes, true).file;
                file.specs.objective = Default::default();
                file.specs.xi_max = f64::INFINITY;
                file
            }
        };
        let Outcome::Solved(own) = outcome(&Model::new(file.clone()).expect("a valid model"))
        else {
            continue;
        };
        let (other, factor) = restated(&file, &mut stream);
        let design = proved(&serde_json::to_value(&other).expect("JSON"));
        let found = design.certificate.guaranteed_gain * factor;
        let expected = own.file.certificate.guaranteed_gain;
        assert!(
            (found - expected).abs() <= SAME * expected,
            "round {round}: {expected} and {found}"
        );
        compared += 1;
    }
    assert!(compared >= 11, "{compared} compared");
}

#[test]
fn with_starts_to_be_contained_no_limit_on_xi_gives_a_smaller_gain_than_none() {
    let mut file = cart();
    file["specs"]["must_contain"] = json!([[0.5, 0.1], [0.5, -0.2]]);
    let design = proved(&file);
    let (gain, xi) = (design.certificate.guaranteed_gain, design.certificate.xi);
    let mut limited = Vec::new();
    for factor in [0.8, 0.9, 1.1, 1.25, 2.0, 4.0] {
        file["specs"]["xi_max"] = json!(factor * xi);
        limited.push(proved(&file).certificate.guaranteed_gain);
    }
    let least = limited.iter().copied().fold(f64::INFINITY, f64::min);
    assert!(gain <= 1.01 * least, "{gain} and {limited:?}");
    // The limit that is far too small costs much: the search had something to find.
    assert!(limited[0] > 1.05 * gain, "{gain} and {limited:?}");
    // gamma is another objective, with another gain for the same starts.
    file["specs"]["xi_max"] = json!(4.0 * xi);
    file["specs"]["objective"] = json!("gamma");
    let of_gamma = proved(&file).certificate.guaranteed_gain;
    assert!(gain <= 1.01 * of_gamma, "{gain} and {of_gamma}");
}

#[test]
fn without_a_limit_xi_goes_up_to_where_its_supply_reaches_phi() {
    let free = proved(&cart());
    let bound = 0.1 / (0.02 * 0.02);
    assert!(free.certificate.xi <= bound, "{}", free.certificate.xi);
    assert!(!free.to_json().contains("xi_max"), "no limit is written");
    // A limit beyond that changes nothing.
    let mut wide = cart();
    wide["specs"]["xi_max"] = json!(100.0 * bound);
    let wide = proved(&wide).certificate.guaranteed_gain;
    let gain = free.certificate.guaranteed_gain;
    assert!((wide - gain).abs() <= SAME * gain, "{wide} and {gain}");
}

#[test]
fn a_gain_that_is_asked_for_is_met_and_one_below_the_smallest_is_not() {
    let smallest = proved(&cart()).certificate.guaranteed_gain;
    for factor in [1.01, 2.0, 30.0] {
        let mut file = cart();
        file["specs"]["gamma"] = json!(factor * smallest);
        let found = proved(&file).certificate.guaranteed_gain;
        assert!(found <= factor * smallest, "{found}");
    }
    for (key, factor) in [("gamma", 0.9), ("gamma_max", 0.9)] {
        let mut file = cart();
        file["specs"][key] = json!(factor * smallest);
        let model = Model::from_json(&file.to_string()).expect("a valid model");
        let Outcome::Undecided(decision) = outcome(&model) else {
            panic!("{key} below the smallest gain is no design");
        };
        let reason = decision.limiting_factors.expect("a reason").reason;
        let (_, found) = reason
            .split_once("the smallest guaranteed gain proved is ")
            .expect(&reason);
        let (found, _) = found.split_once(';').expect(&reason);
        // Six digits, rounded up.
        assert!(found.trim_start_matches("0.").len() <= 7, "{reason}");
        let found: f64 = found.parse().expect(&reason);
        assert!(
            found >= smallest && found <= 1.01 * smallest,
            "{reason}; {smallest}"
        );
    }
}

#[test]
fn with_a_threshold_of_zero_the_trigger_weight_is_found_after_the_rest() {
    let mut file = cart();
    file["specs"]["nu"] = json!(0.0);
    let always = proved(&file).certificate.guaranteed_gain;
    // A small threshold costs little, and no less than none.
    file["specs"]["nu"] = json!(1e-4);
    let nearly = proved(&file).certificate.guaranteed_gain;
    assert!(
        always <= nearly * 1.001 && nearly <= 1.05 * always,
        "{always} and {nearly}"
    );
}

/// Models in the search for contradictions; STEADFAST_CONTRADICTIONS=10000 for the long one.
fn contradictions() -> u64 {
    let asked = std::env::var("STEADFAST_CONTRADICTIONS").ok();
    asked.and_then(|count| count.parse().ok()).unwrap_or(40)
}

/// Of the first model; each next one has the next.
const FIRST_SEED: u64 = 1000;

/// After so many models the counts are printed.
const COUNTED: u64 = 100;

/// What came of the models so far.
#[derive(Default)]
struct Counts {
    designs: u64,
    refuted: u64,
    open: u64,
}

impl std::fmt::Display for Counts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let models = self.designs + self.refuted + self.open;
        write!(
            f,
            "seeds {FIRST_SEED} to {}: {models} models, {} proved designs, {} proved refutations, {} undecided",
            (FIRST_SEED + models).saturating_sub(1),
            self.designs,
            self.refuted,
            self.open
        )
    }
}

#[test]
fn no_model_near_its_edge_has_a_proved_design_and_a_proved_refutation() {
    let mut counts = Counts::default();
    for seed in (FIRST_SEED..).take(contradictions() as usize) {
        let mut stream = Stream(seed);
        let sizes = Sizes {
            states: 2,
            inputs: 1,
            vertices: stream.integer(1, 2) as usize,
        };
        let mut file = random::model(&mut stream, sizes, false).file;
        // From well inside to well outside of what the inputs can do.
        let PlantFile::Vertices(plant) = &mut file.plant else {
            panic!("random models have vertices")
        };
        let factor = (4.0 * stream.signed_unit()).exp();
        plant
            .input_limit
            .iter_mut()
            .for_each(|limit| *limit *= factor);
        let model = Model::new(file).expect("a valid model");
        let design = match outcome(&model) {
            Outcome::Solved(design) => design.report.verdict == Verdict::Proved,
            _ => false,
        };
        let decision = decide(&model, "", &Solvers::suited_to(&model), None).expect("a decision");
        let no = matches!(decision.answer, Answer::Infeasible(_));
        let yes = design || matches!(decision.answer, Answer::Feasible(_));
        assert!(
            !(yes && no),
            "seed {seed}: a proved design and a proved refutation"
        );
        counts.designs += u64::from(yes);
        counts.refuted += u64::from(no);
        counts.open += u64::from(!yes && !no);
        if !yes && !no {
            eprintln!("seed {seed}: undecided");
        }
        if (seed - FIRST_SEED + 1) % COUNTED == 0 {
            eprintln!("{counts}");
        }
    }
    eprintln!("{counts}");
    assert!(counts.designs > 0 && counts.refuted > 0, "{counts}");
}

#[test]
fn a_search_does_not_mind_a_limit_on_xi_that_is_none() {
    let gain = |xi_max: Option<f64>| {
        let mut file = cart();
        file["specs"]["search"] = json!({ "phi_per_s": [0.02, 0.5] });
        file["specs"]["must_contain"] = json!([[0.3, 0.1]]);
        if let Some(limit) = xi_max {
            file["specs"]["xi_max"] = json!(limit);
        }
        proved(&file).certificate.guaranteed_gain
    };
    // Up to 0.5 / 0.02^2 = 1250 a larger xi may gain something.
    let (free, none) = (gain(None), gain(Some(1e9)));
    assert!(
        (free - none).abs() <= 0.05 * free.min(none),
        "{free} and {none}"
    );
}

/// A pendulum on a cart, sampled with nu = 0: the sets in which it stays are thin slices, hard for both solvers.
fn pendulum() -> Value {
    json!({
        "schema_version": 1, "name": "pendulum",
        "plant": { "vertices": {
            "state_matrices": [[[0, 1, 0, 0], [0, 0, -0.981, 0], [0, 0, 0, 1], [0, 0, 3.27, 0]]],
            "input_matrix": [[0], [0.1], [0], [-0.03333333333333333]],
            "input_limit": [1000], "disturbance_bound": 0.01
        } },
        "specs": { "phi_per_s": 0.02, "hbar_s": 0.0368, "nu": 0 }
    })
}

#[test]
fn a_solver_that_fails_in_the_form_that_suits_it_is_asked_in_the_other() {
    let model = Model::from_json(&pendulum().to_string()).expect("a valid model");
    let gain = |solver: Solver| {
        let solvers = Solvers::named(solver, Form::suited_to(solver));
        let outcome = synthesize(&model, "", &solvers, None).expect("the solver starts");
        let Outcome::Solved(design) = outcome else {
            panic!("{solver:?} finds no design");
        };
        assert_eq!(design.report.verdict, Verdict::Proved, "{solver:?}");
        (
            design.file.certificate.guaranteed_gain,
            design.file.provenance.form,
        )
    };
    let (structured, form) = gain(Solver::Structured);
    assert_eq!(form, Form::Chordal.name());
    let (clarabel, _) = gain(Solver::Clarabel);
    // The back-offs of both designs, and what inaccurate optima leave.
    let difference = (structured - clarabel).abs();
    assert!(difference <= 0.02 * clarabel, "{structured} and {clarabel}");
}

/// A pole on a cart (8 kg, 2.5 m), which is hard for a solver: the position of the cart is driven through the pole alone.
fn pole(objective: &str) -> Value {
    json!({
        "schema_version": 1, "name": "pole",
        "plant": { "vertices": {
            "state_matrices": [[[0, 1, 0, 0], [0, 0, -1.22625, 0], [0, 0, 0, 1], [0, 0, 3.924, 0]]],
            "input_matrix": [[0], [0.125], [0], [-0.05]], "input_limit": [1000], "disturbance_bound": 0.01,
            "output_matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
        } },
        "specs": { "phi_per_s": 0.02, "hbar_s": 0.04, "nu": 0, "xi_max": 1000, "objective": objective }
    })
}

#[test]
fn where_the_solver_is_not_sure_of_its_optimum_smaller_gains_are_tried() {
    let found = proved(&pole("gamma")).certificate.gamma;
    // A design at 0.3 is proved where it is asked for.
    assert!(found <= 0.3 * 1.05, "{found}");
}
