//! What rounding in the controller adds: no order of sums, fused or not, adds more, and the check of it can fail.

use num_rational::BigRational;
use num_traits::{Signed, Zero};

use crate::exact::Stream;
use synth::certify::controller_rounding::{
    controller_rounding, holds_with_rounding, ControllerRounding, UNIT_ROUNDOFF,
};
use synth::certify::exact::Exact;
use synth::certify::interval::Interval;
use synth::certify::scalar::Scalar;
use synth::certify::theorem1::for_each_state_bound;
use synth::design::{prove, DesignFile};
use synth::model::{Model, Plant};

fn design(name: &str) -> (DesignFile, Model) {
    let path = format!("{}/../tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).expect(&path);
    DesignFile::from_json(&text).expect("a design")
}

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).expect("a finite number")
}

/// The sum of products in doubles, in an order that the stream draws, fused here and there.
fn summed(left: &[f64], right: &[f64], stream: &mut Stream) -> f64 {
    let mut order: Vec<usize> = (0..left.len()).collect();
    for last in (1..order.len()).rev() {
        order.swap(
            last,
            (unit(stream) * (last + 1) as f64) as usize % (last + 1),
        );
    }
    order
        .iter()
        .fold(0.0, |sum, &index| match unit(stream) < 0.5 {
            true => left[index].mul_add(right[index], sum),
            false => sum + left[index] * right[index],
        })
}

/// A number in [0, 1].
fn unit(stream: &mut Stream) -> f64 {
    0.5 * (1.0 + stream.signed_unit())
}

fn dot(left: &[BigRational], right: &[BigRational]) -> BigRational {
    left.iter()
        .zip(right)
        .map(|(a, b)| a * b)
        .fold(BigRational::zero(), |sum, term| sum + term)
}

/// A state of the box, most of them near its corners.
fn state(rates: [f64; 3], stream: &mut Stream) -> Vec<f64> {
    let signed = |stream: &mut Stream| stream.signed_unit();
    let corner = |stream: &mut Stream| signed(stream).signum() * (1.0 - 0.1 * unit(stream));
    let rates = rates.map(|rate| rate * corner(stream));
    let vector: Vec<f64> = (0..3).map(|_| signed(stream)).collect();
    let norm = vector.iter().map(|q| q * q).sum::<f64>().sqrt();
    rates
        .into_iter()
        .chain(vector.into_iter().map(|q| q / norm))
        .collect()
}

#[test]
fn no_order_of_sums_adds_more_to_a_command_or_to_a_decision_than_is_proved() {
    let (file, model) = design("xu2020-design.json");
    let certificate = file.certificate(&model).expect("a certificate");
    let bound: ControllerRounding<Interval> =
        controller_rounding(&model, &certificate, UNIT_ROUNDOFF).expect("a bound");
    let gain = certificate.gains().next().expect("a gain").clone();
    let rows = |matrix: &nalgebra::DMatrix<f64>| -> Vec<Vec<f64>> {
        matrix
            .row_iter()
            .map(|row| row.iter().copied().collect())
            .collect()
    };
    let (gain, weight) = (rows(&gain), rows(&certificate.trigger_weight));
    let rates = [0.1; 3];
    let (nu, floor) = (model.file.specs.nu, certificate.trigger_floor);
    let mut stream = Stream(7);
    let (mut torque, mut decision) = (BigRational::zero(), BigRational::zero());
    for _ in 0..2000 {
        let (now, sent) = (state(rates, &mut stream), state(rates, &mut stream));
        let exactly = |values: &[f64]| values.iter().map(|&v| exact(v)).collect::<Vec<_>>();
        let error: BigRational = gain
            .iter()
            .map(|row| {
                let computed = summed(row, &sent, &mut stream);
                (exact(computed) - dot(&exactly(row), &exactly(&sent))).abs()
            })
            .fold(BigRational::zero(), |sum, one| sum + one);
        torque = torque.max(error);

        let form = |x: &[f64], stream: &mut Stream| {
            let product: Vec<f64> = weight.iter().map(|row| summed(row, x, stream)).collect();
            summed(&product, x, stream)
        };
        let exact_form = |x: &[BigRational]| {
            let product: Vec<_> = weight.iter().map(|row| dot(&exactly(row), x)).collect();
            dot(&product, x)
        };
        let difference: Vec<f64> = now.iter().zip(&sent).map(|(x, w)| x - w).collect();
        let exact_difference: Vec<_> = now
            .iter()
            .zip(&sent)
            .map(|(&x, &w)| exact(x) - exact(w))
            .collect();
        // How much more than the exact threshold may pass for less.
        let computed = form(&difference, &mut stream);
        let threshold = nu * form(&sent, &mut stream) + floor;
        let below = exact_form(&exact_difference) - exact(computed);
        let above = exact(threshold) - (exact(nu) * exact_form(&exactly(&sent)) + exact(floor));
        decision = decision.max(below + above);
    }
    let of = |bound: &Interval| exact(bound.hi());
    assert!(torque <= of(&bound.torque) && decision <= of(&bound.decision));
    // Not by much more than what may happen.
    let share = |found: &BigRational, bound: &Interval| {
        let ratio = found / of(bound);
        ratio.numer().to_string().len() as i64 - ratio.denom().to_string().len() as i64
    };
    assert!(share(&torque, &bound.torque) > -3 && share(&decision, &bound.decision) > -3);
}

#[test]
fn the_bounds_in_intervals_enclose_those_in_exact_arithmetic() {
    let (file, model) = design("xu2020-design.json");
    let certificate = file.certificate(&model).expect("a certificate");
    let exactly: ControllerRounding<Exact> =
        controller_rounding(&model, &certificate, UNIT_ROUNDOFF).expect("a bound");
    let found: ControllerRounding<Interval> =
        controller_rounding(&model, &certificate, UNIT_ROUNDOFF).expect("a bound");
    for (exact, interval) in [
        (exactly.torque, found.torque),
        (exactly.decision, found.decision),
    ] {
        let above = Exact::from_f64(interval.hi()) - exact.clone();
        let below = exact - Exact::from_f64(interval.lo());
        assert!(above.approximate() >= 0.0 && below.approximate() >= 0.0);
        assert!(interval.hi() < 1.000001 * interval.lo());
    }
}

#[test]
fn a_coarser_arithmetic_is_refused_and_a_plant_of_which_nothing_is_known_too() {
    let (file, model) = design("xu2020-design.json");
    let certificate = file.certificate(&model).expect("a certificate");
    let holds = |unit: f64| holds_with_rounding((&model, &certificate), None, unit);
    assert!(holds(UNIT_ROUNDOFF));
    assert!(!holds(1e-3));
    let said = |file: &DesignFile, model: &Model| {
        let certificate = file.certificate(model).expect("a certificate");
        let outer = file.large_set_certificate(model).expect("a certificate");
        let report = prove(model, &certificate, outer.as_ref());
        report.not_covered.last().expect("an assumption").clone()
    };
    assert!(said(&file, &model).contains("IEEE doubles"));
    // Where the disturbance does not act on the inputs, what rounding adds is none.
    let (file, model) = design("double-integrator-design.json");
    assert!(said(&file, &model).contains("IEEE doubles"));
    let mut elsewhere = model.clone();
    let Plant::Vertices(system) = &mut elsewhere.plant else {
        panic!("vertices")
    };
    system.disturbance_matrix *= 2.0;
    let certificate = file.certificate(&model).expect("a certificate");
    let bound = controller_rounding::<Interval>(&elsewhere, &certificate, UNIT_ROUNDOFF);
    assert!(bound.is_none());
}

#[test]
fn for_a_plant_of_vertices_no_order_of_sums_adds_more_and_its_states_stay_within_what_is_assumed() {
    let (file, model) = design("double-integrator-design.json");
    let certificate = file.certificate(&model).expect("a certificate");
    let bound: ControllerRounding<Interval> =
        controller_rounding(&model, &certificate, UNIT_ROUNDOFF).expect("a bound");
    assert!(holds_with_rounding(
        (&model, &certificate),
        None,
        UNIT_ROUNDOFF
    ));
    assert!(!holds_with_rounding((&model, &certificate), None, 1e-2));
    let gain = certificate.gains().next().expect("a gain").clone();
    let row: Vec<f64> = gain.row(0).iter().copied().collect();
    // The farthest states of x'Ux <= 1, the level of this design.
    let level = synth::certify::theorem1::reached_from_rest(&model, &certificate).max(1.0);
    let factor = certificate
        .lyapunov
        .clone()
        .cholesky()
        .expect("positive")
        .l();
    let mut stream = Stream(11);
    let mut worst = BigRational::zero();
    for _ in 0..2000 {
        let angle = std::f64::consts::PI * stream.signed_unit();
        let direction = nalgebra::DVector::from_vec(vec![angle.cos(), angle.sin()]);
        let transposed = factor.transpose();
        let state = transposed
            .solve_upper_triangular(&direction)
            .expect("regular")
            * level.sqrt();
        let state: Vec<f64> = state.iter().copied().collect();
        let exactly = |values: &[f64]| values.iter().map(|&v| exact(v)).collect::<Vec<_>>();
        let computed = summed(&row, &state, &mut stream);
        let error = (exact(computed) - dot(&exactly(&row), &exactly(&state))).abs();
        worst = worst.max(error);
    }
    assert!(worst > BigRational::zero() && worst <= exact(bound.torque.hi()));
}

#[test]
fn a_bound_on_a_state_that_the_level_set_exceeds_is_refused() {
    let (file, model) = design("double-integrator-design.json");
    let certificate = file.certificate(&model).expect("a certificate");
    let level = synth::certify::theorem1::reached_from_rest(&model, &certificate).max(1.0);
    let inverse = certificate
        .lyapunov
        .clone()
        .cholesky()
        .expect("positive")
        .inverse();
    let holds = |factor: f64| {
        let bounds = inverse.diagonal().map(|own| factor * (level * own).sqrt());
        let bounds: Vec<f64> = bounds.iter().copied().collect();
        let mut all = true;
        for_each_state_bound::<Exact>(&model, &certificate, &bounds, &mut |_, matrix| {
            all &= synth::certify::exact::holds(&matrix);
        });
        all
    };
    assert!(holds(1.0 + 1e-6) && !holds(1.0 - 1e-6));
}
