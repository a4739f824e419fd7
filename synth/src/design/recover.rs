//! From a solver's values in scaled units to a certificate in SI units.

use nalgebra::{DMatrix, DVector};

use crate::certify::theorem1::{
    certified_start, reached_from_rest, relative_supply, Certificate, FinalBounds,
    MeasurementWeights, MismatchSlack, RuleGains,
};
use crate::conditions::xu2020::{DesignUnknowns, DEAD_ZONE_UNIT};
use crate::conditions::Task;
use crate::model::{Model, Plant};
use crate::scaling::Scaling;
use sdp::lmi::Affine;

/// Undoes the congruence and the scaling: Q = Qh^-1, F = Fh Qh^-T, U = Q Uh Q', Upsilon = Q Wh Q',
/// Y, L1, L2 likewise, N = Nh Qh^-T, M = S^-1. The scaling is by powers of two and adds no error;
/// whatever the rest adds is seen by the check, which starts from the result. `None` where a matrix that must be
/// inverted is singular, or a number not finite. `task`: the scaled one.
pub fn recover(
    model: &Model,
    unknowns: &DesignUnknowns,
    values: &[f64],
    (scaling, task): (&Scaling, &Task),
) -> Option<Certificate> {
    let multiplier = unknowns.multiplier.value(values).try_inverse()?;
    let to_state = scaling.to_state();
    let to_input = DMatrix::from_diagonal(&scaling.input);
    let weight = |transformed: DMatrix<f64>| {
        &to_state * &multiplier * transformed * multiplier.transpose() * &to_state
    };
    let symmetric = |transformed: DMatrix<f64>| {
        let full = weight(transformed);
        0.5 * (&full + full.transpose())
    };
    let gain =
        |transformed: DMatrix<f64>| &to_input * transformed * multiplier.transpose() * &to_state;
    let (states, inputs) = (to_state.nrows(), to_input.nrows());
    let anti_windup = |transformed: Option<&Affine>| match transformed {
        Some(transformed) => gain(transformed.value(values)),
        None => DMatrix::zeros(inputs, states),
    };
    let first = unknowns.sector.as_ref().map(|sector| &sector.anti_windup);
    let further = unknowns.further.iter().map(|rule| RuleGains {
        gain: gain(rule.gain.value(values)),
        anti_windup: anti_windup(rule.anti_windup.as_ref()),
    });
    let sector_weight = match &unknowns.sector {
        None => DVector::zeros(inputs),
        Some(sector) => sector_weights(&sector.weight.value(values), scaling),
    };
    let to_slack = slack_coordinates(unknowns, &multiplier, scaling);
    let slack = |transformed: &Affine| {
        let full = to_slack.transpose() * transformed.value(values) * &to_slack;
        0.5 * (&full + full.transpose())
    };
    let c = scaling.disturbance;
    let xi = unknowns.disturbance_weight.value(values)[(0, 0)] / (c * c);
    let mut certificate = Certificate {
        gain: gain(unknowns.gain.value(values)),
        further: further.collect(),
        mismatch: unknowns
            .mismatch
            .iter()
            .map(|side| MismatchSlack {
                bounds: side.bounds.iter().map(slack).collect(),
                common: slack(&side.common),
            })
            .collect(),
        trigger_weight: symmetric(unknowns.trigger_weight.value(values)),
        trigger_floor: 0.0,
        trigger_multiple: 1.0,
        lyapunov: symmetric(unknowns.lyapunov.value(values)),
        integral_weight: symmetric(unknowns.integral_weight.value(values)),
        multiplier: descriptor_multiplier(&model.plant, &to_state * &multiplier * &to_state),
        free_state: weight(unknowns.free_state.value(values)),
        free_sample: weight(unknowns.free_sample.value(values)),
        anti_windup: anti_windup(first),
        sector_weight,
        disturbance_weight: xi,
        gain_bound: unknowns.gain_bound.value(values)[(0, 0)],
        guaranteed_gain: 0.0,
        certified_vector_part: None,
        final_bounds: None,
        measurement: None,
        gain_error_weight: DVector::zeros(0),
        first_torque: None,
    };
    if unknowns.sector.is_none() {
        certificate.sector_weight = large_sector_weights(model, &certificate);
    }
    add_imperfections(unknowns, values, (scaling, task), &mut certificate);
    if !is_finite(&certificate) {
        return None;
    }
    add_claims(model, &mut certificate)?;
    Some(certificate)
}

/// How far Wp lies below the largest that its condition allows, relative.
const PARALLEL_ALLOWANCE: f64 = 1e-6;

/// The numbers that imperfections need: Lam = (lambda delta^2 / taubar^2)^-1 of each ball, Wp a little below (W^-1 +
/// Lam^-1)^-1, and T = D^-1.
fn add_imperfections(
    unknowns: &DesignUnknowns,
    values: &[f64],
    (scaling, task): (&Scaling, &Task),
    certificate: &mut Certificate,
) {
    let scalar = |unknown: &Affine| unknown.value(values)[(0, 0)];
    if let (Some(own), Some(error)) = (&unknowns.measurement, &task.imperfections.measurement) {
        let shares: Vec<f64> = own.shares.iter().map(scalar).collect();
        let weight = |state: usize| {
            let size = error.sizes[state] * scaling.state[state];
            1.0 / (shares[error.balls[state]] * size * size)
        };
        let sample_weight = DVector::from_fn(error.balls.len(), |state, _| weight(state));
        certificate.measurement = measurement_weights(&certificate.trigger_weight, sample_weight);
    }
    if let (Some(own), Some(error)) = (&unknowns.gain_error, &task.imperfections.gain_error) {
        let diagonal = own.value(values).diagonal();
        certificate.gain_error_weight = DVector::from_fn(diagonal.len(), |k, _| {
            let ((_, j), _) = error.entries[k];
            1.0 / (diagonal[k] * scaling.input[j] * scaling.input[j])
        });
    }
}

/// Lam with Wp a little below (W^-1 + Lam^-1)^-1 = W - W (W + Lam)^-1 W; `None` where W + Lam is not positive definite.
pub(crate) fn measurement_weights(
    trigger_weight: &DMatrix<f64>,
    sample_weight: DVector<f64>,
) -> Option<MeasurementWeights> {
    let sum = trigger_weight + DMatrix::from_diagonal(&sample_weight);
    let factor = sum.cholesky()?;
    let parallel = trigger_weight - trigger_weight * factor.solve(trigger_weight);
    let error_weight = 0.5 * (&parallel + parallel.transpose()) * (1.0 - PARALLEL_ALLOWANCE);
    Some(MeasurementWeights {
        error_weight,
        sample_weight,
    })
}

/// From the rows (B'Q'v, M p, x(t_k)) in SI units to those of the slack unknowns: the input's units, the
/// dead zone's unit, and the congruence.
fn slack_coordinates(
    unknowns: &DesignUnknowns,
    multiplier: &DMatrix<f64>,
    scaling: &Scaling,
) -> DMatrix<f64> {
    let (m, n) = (scaling.input.len(), scaling.state.len());
    let zone = if unknowns.sector.is_some() { m } else { 0 };
    let mut out = DMatrix::zeros(m + zone + n, m + zone + n);
    for k in 0..m {
        out[(k, k)] = scaling.input[k];
    }
    for k in 0..zone {
        out[(m + k, m + k)] = scaling.input[k] / DEAD_ZONE_UNIT;
    }
    let to_state = scaling.to_state();
    out.view_mut((m + zone, m + zone), (n, n))
        .copy_from(&(multiplier.transpose() * to_state));
    out
}

/// M = S^-1 in SI units.
fn sector_weights(inverse: &DMatrix<f64>, scaling: &Scaling) -> DVector<f64> {
    DVector::from_fn(inverse.nrows(), |s, _| {
        1.0 / (inverse[(s, s)] * scaling.input[s] * scaling.input[s])
    })
}

/// How far the dead-zone rows of (18) stay below what they could spoil, after scaling to a unit
/// diagonal.
const SECTOR_ROOM: f64 = 1e9;

/// Sector weights M so large that the dead zone does not matter in (18): its Schur complement there is
/// Q B M^-1 B' Q' / 2, compared with the diagonal blocks of x and x'. Any M > 0 large enough suffices,
/// because with N = 0 nothing else depends on it.
fn large_sector_weights(model: &Model, certificate: &Certificate) -> DVector<f64> {
    let specs = &model.file.specs;
    let input = match model.plant.inertia() {
        Some(_) => DMatrix::identity(6, 3),
        None => model.plant.takagi_sugeno().input,
    };
    let descriptor = model.plant.descriptor();
    let column = &certificate.multiplier * input;
    let rate = (&certificate.multiplier * descriptor).diagonal() * (2.0 * specs.eps[1]);
    DVector::from_fn(column.ncols(), |s, _| {
        let shares = (0..column.nrows()).map(|row| {
            let entry = column[(row, s)];
            let state_diagonal = specs.phi_per_s * certificate.lyapunov[(row, row)];
            let sampled = certificate.free_sample[(row, row)].abs();
            let smallest = rate[row]
                .abs()
                .min(state_diagonal)
                .min(sampled.max(state_diagonal));
            entry * entry / smallest.max(f64::MIN_POSITIVE)
        });
        (SECTOR_ROOM * shares.fold(0.0, f64::max)).max(f64::MIN_POSITIVE)
    })
}

/// The multiplier of the equation in descriptor form: Q E^-1 with E = diag(J, I) for a spacecraft.
pub(crate) fn descriptor_multiplier(plant: &Plant, multiplier: DMatrix<f64>) -> DMatrix<f64> {
    match (plant.inertia(), plant.descriptor().try_inverse()) {
        (Some(_), Some(inverse)) => multiplier * inverse,
        _ => multiplier,
    }
}

fn is_finite(certificate: &Certificate) -> bool {
    let slacks = certificate.mismatch.iter();
    let slacks = slacks.flat_map(|side| side.bounds.iter().chain([&side.common]));
    let others = [
        &certificate.trigger_weight,
        &certificate.lyapunov,
        &certificate.integral_weight,
        &certificate.multiplier,
        &certificate.free_state,
        &certificate.free_sample,
    ];
    let gains = certificate.gains().chain(certificate.anti_windups());
    let mut numbers = gains
        .chain(slacks)
        .chain(others)
        .flat_map(|matrix| matrix.iter());
    let weights = &certificate.sector_weight;
    numbers.all(|number| number.is_finite()) && weights.iter().all(|weight| weight.is_finite())
}

/// Relative allowance in derived claims, so that the check can prove them.
const CLAIM_ALLOWANCE: f64 = 1e-5;

/// The guaranteed gain sqrt(g xi) with the smallest g such that C'C <= g phi U, the largest radius of attitudes at rest
/// among the certified starts, and the bounds from rest. `None` where U is singular.
pub(crate) fn add_claims(model: &Model, certificate: &mut Certificate) -> Option<()> {
    let system = model.plant.takagi_sugeno();
    let inverse = certificate.lyapunov.clone().try_inverse()?;
    let spread = &system.output * &inverse * system.output.transpose();
    let reached = reached_from_rest(model, certificate);
    let largest = largest_eigenvalue(&spread);
    let gain = match system.disturbance_bound > 0.0 {
        true => (largest * reached).sqrt() / system.disturbance_bound,
        false => (largest / model.file.specs.phi_per_s * certificate.disturbance_weight).sqrt(),
    };
    let gain = gain * (1.0 + CLAIM_ALLOWANCE);
    certificate.guaranteed_gain = gain.min(certificate.gain_bound);
    if let Plant::Spacecraft(_) = model.plant {
        let start = certified_start(model, certificate).max(0.0);
        let attitude = certificate.lyapunov.view((3, 3), (3, 3)).into_owned();
        let radius = (start / largest_eigenvalue(&attitude)).sqrt() * (1.0 - CLAIM_ALLOWANCE);
        certificate.certified_vector_part = Some(radius.min(1.0));
        let bound = |first: usize| {
            let spread = inverse.view((first, first), (3, 3)).into_owned();
            (largest_eigenvalue(&spread) * reached).sqrt() * (1.0 + CLAIM_ALLOWANCE)
        };
        certificate.final_bounds = (reached > 0.0).then(|| FinalBounds {
            rate: bound(0),
            vector_part: bound(3),
        });
    }
    Some(())
}

/// How far a gamma that is claimed anew lies above what it must bound, relative.
const GAMMA_ALLOWANCE: f64 = 1e-6;

/// gamma from U, xi and what else feeds the functional, and the claims that follow: for a certificate whose units have
/// changed. `None` where U is singular.
pub(crate) fn claim_anew(model: &Model, certificate: &mut Certificate) -> Option<()> {
    let output = model.plant.takagi_sugeno().output;
    let inverse = certificate.lyapunov.clone().try_inverse()?;
    let spread = &output * inverse * output.transpose();
    let gain = largest_eigenvalue(&spread) / model.file.specs.phi_per_s;
    let least = gain
        .max(certificate.disturbance_weight)
        .max(relative_supply(model, certificate));
    certificate.gain_bound = least * (1.0 + GAMMA_ALLOWANCE);
    add_claims(model, certificate)
}

/// The largest eigenvalue of a matrix that is symmetric but for rounding.
pub(super) fn largest_eigenvalue(matrix: &DMatrix<f64>) -> f64 {
    let symmetric = 0.5 * (matrix + matrix.transpose());
    symmetric.symmetric_eigenvalues().max()
}
