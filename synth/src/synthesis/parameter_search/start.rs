//! Where a search begins.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::inner::{Aim, Inner, SearchPoint};
use super::parameters::Parameter;
use crate::programs::SynthesisError;

/// Weights rho of the first containment condition, for eps_1 = 1; from then on it is linearised about the
/// last point.
const WEIGHTS: [f64; 3] = [0.25, 0.5, 0.1];

/// Factors on the model's box that are tried, all rates together.
const BOXES: [f64; 4] = [1.0, 0.4, 2.5, 0.1];

/// The best of the starts that can be solved: the model's own numbers first, others when they cannot.
pub fn first(inner: &Inner<'_>) -> Result<Option<SearchPoint>, SynthesisError> {
    let weights = match inner.aim {
        Aim::Reach { .. } => &WEIGHTS[..],
        Aim::Gain if inner.covered.is_empty() => &WEIGHTS[..1],
        Aim::Gain => &WEIGHTS[..],
    };
    let own = inner.space.start();
    for factor in BOXES {
        let boxed = with_rates(inner, &own, factor);
        let slow = with_slowest_decay(inner, &boxed);
        let mut points = vec![boxed];
        if !points.contains(&slow) {
            points.push(slow);
        }
        let starts: Vec<(&Vec<f64>, f64)> = points
            .iter()
            .flat_map(|point| weights.iter().map(move |&weight| (point, weight)))
            .collect();
        let solved: Result<Vec<Option<SearchPoint>>, SynthesisError> = starts
            .par_iter()
            .map(|(coordinates, weight)| solve(inner, coordinates, *weight))
            .collect();
        let solved = solved?.into_iter().flatten();
        let best = solved.max_by(|a, b| a.value.height.total_cmp(&b.value.height));
        if best.is_some() {
            return Ok(best);
        }
    }
    Ok(None)
}

/// The same point with another aim.
pub fn again(
    inner: &Inner<'_>,
    point: &SearchPoint,
) -> Result<Option<SearchPoint>, SynthesisError> {
    let value = inner.solve(&point.coordinates, &point.value.linearisation)?;
    Ok(value.map(|value| SearchPoint {
        coordinates: point.coordinates.clone(),
        value,
    }))
}

fn solve(
    inner: &Inner<'_>,
    coordinates: &[f64],
    weight: f64,
) -> Result<Option<SearchPoint>, SynthesisError> {
    let states = inner.scaling.state.len();
    let file = inner.space.at(coordinates);
    // With eps_1 = 0 any weight is as good as another.
    let unit = file.specs.eps[0].abs().max(1e-3);
    let linearisation = DMatrix::identity(states, states) * (weight / unit);
    let value = inner.solve(coordinates, &linearisation)?;
    Ok(value.map(|value| SearchPoint {
        coordinates: coordinates.to_vec(),
        value,
    }))
}

fn with_rates(inner: &Inner<'_>, point: &[f64], factor: f64) -> Vec<f64> {
    let ranges = inner.space.ranges.iter().zip(point);
    let moved: Vec<f64> = ranges
        .map(|(range, &at)| match range.parameter {
            Parameter::Rate(_) => at + factor.ln(),
            _ => at,
        })
        .collect();
    inner.space.inside(&moved)
}

fn with_slowest_decay(inner: &Inner<'_>, point: &[f64]) -> Vec<f64> {
    let ranges = inner.space.ranges.iter().zip(point);
    ranges
        .map(|(range, &at)| match range.parameter {
            Parameter::DecayRate => range.coordinates()[0],
            _ => at,
        })
        .collect()
}
