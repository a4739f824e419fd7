//! The change of units loses nothing: powers of two, undone exactly.

use crate::exact::Stream;
use crate::random;
use crate::random::{Point, Sizes};
use nalgebra::{DMatrix, DVector};
use synth::certify::theorem1::Certificate;
use synth::conditions::xu2020::{Sector, DEAD_ZONE_UNIT};
use synth::conditions::Task;
use synth::design::recover;
use synth::model::Model;
use synth::scaling::Scaling;
use synth::solve::{Backend, Clarabel, Status};
use synth::synthesis::{assemble, Form, Goal};

fn xu2020() -> Model {
    Model::from_json(include_str!("../../../models/xu2020.json")).expect("a valid model")
}

fn double_integrator() -> Model {
    let text = include_str!("../../../models/double-integrator.json");
    Model::from_json(text).expect("a valid model")
}

fn is_power_of_two(value: f64) -> bool {
    value.is_normal() && value > 0.0 && value.to_bits() & ((1 << 52) - 1) == 0
}

fn inverse(scaling: &Scaling) -> Scaling {
    Scaling {
        state: scaling.state.map(f64::recip),
        input: scaling.input.map(f64::recip),
        disturbance: scaling.disturbance.recip(),
    }
}

/// Different powers of two for every state, input and the disturbance.
fn uneven(task: &Task, stream: &mut Stream) -> Scaling {
    let mut powers =
        |length| DVector::from_fn(length, |_, _| (stream.integer(-12, 12) as f64).exp2());
    Scaling {
        state: powers(task.system.states()),
        input: powers(task.system.inputs()),
        disturbance: powers(1)[0],
    }
}

#[test]
fn automatic_units_are_powers_of_two() {
    let mut stream = Stream(2);
    let mut models = vec![xu2020(), double_integrator()];
    for _ in 0..10 {
        let sizes = Sizes::any(&mut stream);
        models.push(random::model(&mut stream, sizes, false));
    }
    for model in models {
        for fraction in [0.25, 0.5, 1.0, 0.3] {
            let scaling = Scaling::automatic(&model.task().system, fraction);
            assert!(scaling.state.iter().all(|&unit| is_power_of_two(unit)));
            assert!(scaling.input.iter().all(|&unit| is_power_of_two(unit)));
            assert!(is_power_of_two(scaling.disturbance));
        }
    }
}

#[test]
fn a_task_scaled_and_scaled_back_is_the_same_to_the_last_bit() {
    let mut stream = Stream(3);
    for case in 0..20 {
        let sizes = Sizes::any(&mut stream);
        let mut task = random::model(&mut stream, sizes, false).task();
        let start = random::vector(&mut stream, sizes.states, 1.0);
        task.specification.must_contain = vec![start];
        let scaling = match case % 2 {
            0 => Scaling::automatic(&task.system, 0.5),
            _ => uneven(&task, &mut stream),
        };
        let there = scaling.apply(&task);
        assert_ne!(there, task, "something was scaled");
        let mut back = inverse(&scaling).apply(&there);
        // A row of the region and its bound share a free power of two.
        for (bound, original) in back.system.region.iter_mut().zip(&task.system.region) {
            let unit = (original.bound_squared / bound.bound_squared).sqrt();
            assert!(is_power_of_two(unit), "{unit}");
            bound.rows *= unit;
            bound.bound_squared *= unit * unit;
        }
        assert_eq!(back, task);
    }
}

/// The numbers of a certificate in other units, exactly.
fn in_si(scaled: &Certificate, scaling: &Scaling) -> Certificate {
    let inverse = DMatrix::from_diagonal(&scaling.state.map(f64::recip));
    let input = DMatrix::from_diagonal(&scaling.input);
    let both = |matrix: &DMatrix<f64>| &inverse * matrix * &inverse;
    let gain = |matrix: &DMatrix<f64>| &input * matrix * &inverse;
    let weights = scaled.sector_weight.iter().zip(scaling.input.iter());
    Certificate {
        gain: gain(&scaled.gain),
        trigger_weight: both(&scaled.trigger_weight),
        lyapunov: both(&scaled.lyapunov),
        integral_weight: both(&scaled.integral_weight),
        multiplier: both(&scaled.multiplier),
        free_state: both(&scaled.free_state),
        free_sample: both(&scaled.free_sample),
        anti_windup: gain(&scaled.anti_windup),
        sector_weight: DVector::from_iterator(
            scaled.sector_weight.len(),
            weights.map(|(weight, unit)| weight / (unit * unit)),
        ),
        disturbance_weight: scaled.disturbance_weight / scaling.disturbance.powi(2),
        ..scaled.clone()
    }
}

#[test]
fn recovery_undoes_the_scaling_to_the_last_bit() {
    let mut stream = Stream(4);
    let unit = |task: &Task| Scaling {
        state: DVector::from_element(task.system.states(), 1.0),
        input: DVector::from_element(task.system.inputs(), 1.0),
        disturbance: 1.0,
    };
    for _ in 0..20 {
        let sizes = Sizes::any(&mut stream);
        let model = random::model(&mut stream, sizes, false);
        let task = model.task();
        let scaling = uneven(&task, &mut stream);
        let point = Point::random(&mut stream, &scaling.apply(&task), Sector::Unknown);
        let at = |scaling: &Scaling| {
            recover(
                &model,
                &point.design,
                &point.values,
                (scaling, &model.task()),
            )
            .expect("invertible")
        };
        let recovered = at(&scaling);
        let mut expected = in_si(&at(&unit(&task)), &scaling);
        // Derived in SI units from the others.
        expected.guaranteed_gain = recovered.guaranteed_gain;
        assert_eq!(recovered, expected);
    }
}

/// The same point in SI units: Xh = D Xh' D, Fh = E Fh' D, S = E S' E, xi = xi' / c^2.
fn point_in_si(stream: &mut Stream, si: &Task, scaled: &Point, scaling: &Scaling) -> Point {
    let state = DMatrix::from_diagonal(&scaling.state);
    let input = DMatrix::from_diagonal(&scaling.input);
    let (design, values) = (&scaled.design, &scaled.values);
    let mut out = Point::random(stream, si, Sector::Unknown);
    for (name, matrix) in [
        ("Uh", &design.lyapunov),
        ("Yh", &design.integral_weight),
        ("Wh", &design.trigger_weight),
        ("Qh", &design.multiplier),
        ("L1h", &design.free_state),
        ("L2h", &design.free_sample),
    ] {
        out.set(name, &(&state * matrix.value(values) * &state));
    }
    out.set("Fh", &(&input * design.gain.value(values) * &state));
    let sector = design.sector.as_ref().expect("with sector unknowns");
    let anti_windup = &input * sector.anti_windup.value(values) * &state;
    out.set("Nh", &(DEAD_ZONE_UNIT * anti_windup));
    let weight = &input * sector.weight.value(values) * &input;
    out.set("S", &(DEAD_ZONE_UNIT.powi(2) * weight));
    let xi = design.disturbance_weight.value(values) / scaling.disturbance.powi(2);
    out.set("xi", &xi);
    out.set("gamma", &design.gain_bound.value(values));
    out
}

/// The diagonal congruence that takes `from` to `to`, told from their diagonals; `None` when a
/// diagonal entry is zero.
fn diagonal_congruence(from: &DMatrix<f64>, to: &DMatrix<f64>) -> Option<DVector<f64>> {
    let entry = |k: usize| {
        let ratio = to[(k, k)] / from[(k, k)];
        (ratio.is_finite() && ratio > 0.0).then(|| ratio.sqrt())
    };
    let entries: Option<Vec<f64>> = (0..from.nrows()).map(entry).collect();
    entries.map(DVector::from_vec)
}

#[test]
fn every_scaled_condition_is_the_unscaled_one_congruent_by_powers_of_two() {
    let mut stream = Stream(8);
    let mut names = 0;
    for case in 0..12 {
        let sizes = Sizes::any(&mut stream);
        let mut si = random::model(&mut stream, sizes, false).task();
        si.specification.must_contain = vec![random::vector(&mut stream, sizes.states, 1.0)];
        let scaling = match case % 2 {
            0 => Scaling::automatic(&si.system, 0.5),
            _ => uneven(&si, &mut stream),
        };
        let task = scaling.apply(&si);
        let scaled = Point::random(&mut stream, &task, Sector::Unknown);
        let unscaled = point_in_si(&mut stream, &si, &scaled, &scaling);
        let both = scaled
            .conditions(&task)
            .into_iter()
            .zip(unscaled.conditions(&si));
        for (after, before) in both {
            let name = after.name();
            assert_eq!(name, before.name());
            let after = after.expression().value(&scaled.values);
            let before = before.expression().value(&unscaled.values);
            let units = diagonal_congruence(&after, &before).expect("a diagonal without zeros");
            // Rounded the same way in both units.
            assert!(
                units.iter().all(|&unit| is_power_of_two(unit)),
                "{name}: {units}"
            );
            let units = DMatrix::from_diagonal(&units);
            assert_eq!(&units * after * &units, before, "{name}");
            names += 1;
        }
    }
    assert!(names > 200, "{names} conditions were compared");
}

#[test]
fn the_smallest_gain_bound_does_not_depend_on_the_units() {
    // The margin is in scaled units, so it is made too small to show.
    let mut task = double_integrator().task();
    task.specification.margin = 1e-9;
    let results = [0.25, 0.5, 1.0].map(|fraction| {
        let scaled = Scaling::automatic(&task.system, fraction).apply(&task);
        let assembled = assemble(&scaled, Form::Chordal, Goal::SmallestGain);
        let solution = Clarabel::default()
            .solve(
                &assembled.problem.lower(),
                Goal::SmallestGain.accuracy(&scaled),
                None,
            )
            .expect("a problem with finite numbers");
        assert_eq!(solution.status, Status::Solved, "{}", solution.status_text);
        solution.objective
    });
    for objective in results {
        let distance = (objective / results[0] - 1.0).abs();
        assert!(distance < 1e-4, "{results:?}");
    }
}
