//! Proved designs on the nonlinear plant: the bound of the certificate holds at every step.

use crate::common;
use nalgebra::DVector;
use runtime::attitude::Quaternion;
use runtime::nalgebra::Vector3;
use steadfast::plants::rigid_body::RigidBodySystem;
use steadfast::plants::{RigidBody, System};
use steadfast::run::design::{Design, FitError};
use steadfast::run::outcome::SimulateError;
use steadfast::run::simulate;
use steadfast::run::summary::{CertificateOutcome, RunVerdict, Summary};
use steadfast::scenario::Scenario;
use steadfast::sim::integrator::Method;
use steadfast::sim::random::{Purpose, Random};

fn spacecraft() -> Scenario {
    Scenario::from_json(include_str!("../../models/xu2020-closed-loop.json")).unwrap()
}

fn cart() -> Scenario {
    Scenario::from_json(include_str!(
        "../../models/double-integrator-closed-loop.json"
    ))
    .unwrap()
}

fn body(scenario: &mut Scenario) -> &mut RigidBodySystem {
    match &mut scenario.system {
        System::RigidBody(body) => body,
        System::TakagiSugeno(_) => panic!("a rigid body is expected"),
    }
}

fn run(scenario: &Scenario, design: &Design) -> Summary {
    simulate(scenario, Some(design), false).unwrap().summary
}

fn certificate(summary: &Summary) -> &CertificateOutcome {
    summary.certificate.as_ref().unwrap()
}

/// A state with x'Ux = 1 in a direction drawn evenly after the change of coordinates that makes the
/// set a ball.
fn boundary_state(design: &Design, random: &mut Random) -> DVector<f64> {
    let factor = design.certificate.lyapunov.clone().cholesky().unwrap().l();
    let direction = DVector::from_fn(factor.nrows(), |_, _| random.normal()).normalize();
    factor
        .transpose()
        .solve_upper_triangular(&direction)
        .unwrap()
}

fn start_from(scenario: &mut Scenario, state: &DVector<f64>) {
    let vector = Vector3::new(state[3], state[4], state[5]);
    let body = body(scenario);
    body.attitude = Quaternion::new((1.0 - vector.norm_squared()).sqrt(), vector);
    body.rate_rad_s = Vector3::new(state[0], state[1], state[2]);
}

#[test]
fn the_bound_holds_at_every_step_from_200_boundary_starts_under_20_sampling_sequences() {
    let design = common::read(common::spacecraft_design());
    assert!(design.proved());
    let mut scenario = spacecraft();
    scenario.duration_s = 100.0;
    scenario.tail_s = 20.0;
    let mut random = Random::new(2020, Purpose::InitialState);
    let (mut tightest, mut steps) = (0.0_f64, 0);
    for index in 0..200 {
        start_from(&mut scenario, &boundary_state(&design, &mut random));
        for seed in 0..20 {
            scenario.seed = seed;
            let summary = run(&scenario, &design);
            let outcome = certificate(&summary);
            assert!(outcome.covers_run, "{:?}", outcome.not_covered);
            assert!((outcome.start_level - 1.0).abs() < 1e-9);
            assert_eq!(outcome.bound_broken_steps, 0, "start {index}, seed {seed}");
            assert_eq!((summary.violations, summary.late_samples), (0, 0));
            assert_ne!(summary.verdict, RunVerdict::ProofBroken);
            tightest = tightest.max(outcome.largest_lyapunov_ratio);
            steps += summary.steps;
        }
    }
    println!("tightest x'Ux over its bound: {tightest:.6} in {steps} steps");
    assert!(tightest <= 1.0);
    // A bound that is never approached would be no test: V' = -phi V holds at the start.
    assert!(tightest > 0.9, "{tightest}");
}

#[test]
fn from_rest_in_the_origin_the_output_stays_within_the_guaranteed_gain() {
    let design = common::read(common::spacecraft_design());
    let mut scenario = spacecraft();
    body(&mut scenario).attitude = Quaternion::identity();
    scenario.duration_s = 1000.0;
    let mut largest = 0.0_f64;
    for axis in 0..3 {
        // A constant torque at the bound of the design, along each axis.
        let disturbance = &mut body(&mut scenario).disturbance;
        disturbance.harmonics.clear();
        disturbance.bias = Vector3::zeros();
        disturbance.bias[axis] = 0.01;
        let summary = run(&scenario, &design);
        let outcome = certificate(&summary);
        assert!(outcome.covers_run && outcome.from_rest_in_origin);
        assert_ne!(summary.verdict, RunVerdict::ProofBroken);
        largest = largest.max(outcome.peak_ratio.unwrap());
    }
    let guaranteed = design.certificate.guaranteed_gain;
    println!("sup|y| / sup|tau| = {largest:.4}, guaranteed {guaranteed:.4}");
    assert!(largest < guaranteed);
    // F's attitude block is 15 to 20 N m, so a constant torque leaves about 1/16 rad per N m.
    assert!(largest > 0.04, "{largest}");
}

#[test]
fn the_shipped_scenario_meets_its_requirements() {
    let summary = run(&spacecraft(), &common::read(common::spacecraft_design()));
    assert_eq!(summary.verdict, RunVerdict::RequirementsMet, "{summary:?}");
    assert!(certificate(&summary).covers_run);
    println!("{} messages, {:?}", summary.triggers, summary.rms_error_deg);
}

#[test]
fn a_takagi_sugeno_plant_of_another_size_keeps_its_bound_too() {
    let design = common::read(common::cart_design());
    let mut scenario = cart();
    let mut random = Random::new(7, Purpose::InitialState);
    for seed in 0..50 {
        scenario.seed = seed;
        let state = boundary_state(&design, &mut random);
        match &mut scenario.system {
            System::TakagiSugeno(model) => model.initial_state = state.as_slice().to_vec(),
            System::RigidBody(_) => panic!("a Takagi-Sugeno model is expected"),
        }
        let summary = run(&scenario, &design);
        let outcome = certificate(&summary);
        assert!(outcome.covers_run, "{:?}", outcome.not_covered);
        assert_eq!(summary.violations, 0);
        assert!(outcome.largest_lyapunov_ratio > 0.9 && outcome.largest_lyapunov_ratio <= 1.0);
        assert_eq!(summary.bytes, 8 * summary.triggers);
        assert_eq!(summary.final_error_deg, None);
    }
}

/// Doubling the decay rate behind the proof's back makes a bound that the run must break.
#[test]
fn a_broken_proved_bound_is_a_failed_run_with_a_loud_message() {
    let mut design = common::read(common::spacecraft_design());
    design.model.file.specs.phi_per_s *= 20.0;
    let summary = run(&spacecraft(), &design);
    assert_eq!(summary.verdict, RunVerdict::ProofBroken);
    assert!(summary.violations > 0);
    assert!(summary
        .verdict
        .sentence()
        .contains("PROVED BOUND WAS BROKEN"));
}

#[test]
fn what_the_proof_does_not_cover_is_said_with_numbers() {
    let design = common::read(common::spacecraft_design());
    let reasons = |change: fn(&mut Scenario)| {
        let mut scenario = spacecraft();
        change(&mut scenario);
        let summary = run(&scenario, &design);
        assert!(!certificate(&summary).covers_run);
        assert_ne!(summary.verdict, RunVerdict::ProofBroken);
        certificate(&summary).not_covered.join("; ")
    };
    let late = reasons(|scenario| {
        scenario.instants = steadfast::sim::sampling::Instants::Periodic {
            interval_s: 0.25,
            jitter_s: 0.0,
        };
    });
    assert_eq!(
        late,
        "samples are up to 0.25 s apart; the proof allows 0.1 s"
    );
    let heavy = reasons(|scenario| {
        let inertia = *body(scenario).body.inertia() * 1.25;
        body(scenario).body = RigidBody::new(inertia).unwrap();
    });
    assert_eq!(
        heavy,
        "the plant's moments of inertia are 1.25 to 1.25 times the model's"
    );
    let strong = reasons(|scenario| body(scenario).disturbance.bias *= 10.0);
    assert!(strong.starts_with("the disturbance reaches 0.03") && strong.ends_with("at most 0.01"));
    let far = reasons(|scenario| {
        body(scenario).attitude = Quaternion::from_euler_321(0.0, 0.0, 0.3);
    });
    assert!(
        far.starts_with("the start is not in the certified set: x'Ux is 4."),
        "{far}"
    );
}

#[test]
fn a_design_for_another_plant_is_refused_with_numbers() {
    let design = common::read(common::spacecraft_design());
    let mut scenario = spacecraft();
    let inertia = *body(&mut scenario).body.inertia() * 0.25;
    body(&mut scenario).body = RigidBody::new(inertia).unwrap();
    match simulate(&scenario, Some(&design), false) {
        Err(SimulateError::Fit(FitError::Inertia {
            smallest, largest, ..
        })) => {
            assert!((smallest - 0.25).abs() < 1e-12 && (largest - 0.25).abs() < 1e-12);
        }
        other => panic!("{other:?}"),
    }
    let cart_design = common::read(common::cart_design());
    let refused = simulate(&spacecraft(), Some(&cart_design), false).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the design does not fit the scenario: the design is for a Takagi-Sugeno model (2 states, \
         1 inputs); the scenario's system is a rigid spacecraft (6 states, 3 inputs)"
    );
    assert_eq!(
        simulate(&spacecraft(), None, false).unwrap_err(),
        SimulateError::NoDesign
    );
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_does_not() {
    let design = common::read(common::spacecraft_design());
    let csv = |scenario: &Scenario| {
        let outcome = simulate(scenario, Some(&design), true).unwrap();
        outcome.trajectory.unwrap().to_csv()
    };
    let mut scenario = spacecraft();
    let first = csv(&scenario);
    assert_eq!(first, csv(&scenario));
    scenario.seed += 1;
    assert_ne!(first, csv(&scenario));
}

#[test]
fn the_fixed_step_agrees_with_the_reference_integrator_over_1000_s() {
    let design = common::read(common::spacecraft_design());
    let path = |method: Method| {
        let mut scenario = spacecraft();
        scenario.duration_s = 1000.0;
        scenario.method = method;
        let outcome = simulate(&scenario, Some(&design), true).unwrap();
        let table = outcome.trajectory.unwrap();
        // Rows between messages fall on the integrators' own steps; messages are at the samples.
        let sent = table.column("sent").unwrap();
        let rows = table.values.chunks_exact(table.columns.len()).zip(sent);
        rows.filter(|(_, sent)| *sent > 0.5)
            .map(|(row, _)| {
                (
                    row[0],
                    Quaternion::from_scalar_first([row[1], row[2], row[3], row[4]]),
                )
            })
            .collect::<Vec<_>>()
    };
    let fixed = path(spacecraft().method);
    let adaptive = path(Method::DormandPrince853 { tolerance: 1e-13 });
    assert_eq!(fixed.len(), adaptive.len());
    assert!(fixed.last().unwrap().0 > 980.0);
    let mut largest = 0.0_f64;
    for ((time, a), (other_time, b)) in fixed.iter().zip(&adaptive) {
        assert_eq!(time, other_time);
        largest = largest.max(a.error_from(b).rotation_angle_rad());
    }
    println!(
        "largest difference {largest:e} rad at {} messages",
        fixed.len()
    );
    assert!(largest < 1e-8);
}
