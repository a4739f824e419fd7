//! Starting points of a search.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::evaluator::{Aim, Evaluator, SearchPoint};
use super::space::Range;
use crate::programs::{Parameter, SynthesisError};

/// Weights rho of the first containment condition, for eps_1 = 1; from then on it is linearised about the
/// last point.
const WEIGHTS: [f64; 3] = [0.25, 0.5, 0.1];

/// Factors on the model's box that are tried, all rates together.
const BOXES: [f64; 4] = [1.0, 0.4, 2.5, 0.1];

/// The best of the starts that can be solved: the model's own numbers first, others when they cannot.
pub fn first(evaluator: &Evaluator<'_>) -> Result<Option<SearchPoint>, SynthesisError> {
    let weights = match evaluator.aim {
        Aim::Reach { .. } => &WEIGHTS[..],
        Aim::Gain if evaluator.contained.is_empty() => &WEIGHTS[..1],
        Aim::Gain => &WEIGHTS[..],
    };
    let own = evaluator.space.start();
    let rate = |range: &Range| matches!(range.parameter, Parameter::Rate(_));
    let boxes = match evaluator.space.ranges.iter().any(rate) {
        true => &BOXES[..],
        false => &BOXES[..1],
    };
    for factor in boxes {
        let boxed = moved(evaluator, &own, |range, at| match range.parameter {
            Parameter::Rate(_) => at + factor.ln(),
            _ => at,
        });
        let slow = moved(evaluator, &boxed, |range, at| match range.parameter {
            Parameter::DecayRate => range.coordinates()[0],
            _ => at,
        });
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
            .map(|(coordinates, weight)| solve(evaluator, coordinates, *weight))
            .collect();
        let solved = solved?.into_iter().flatten();
        let best = solved.max_by(|a, b| a.objective.total_cmp(&b.objective));
        if best.is_some() {
            return Ok(best);
        }
    }
    Ok(None)
}

fn solve(
    evaluator: &Evaluator<'_>,
    coordinates: &[f64],
    weight: f64,
) -> Result<Option<SearchPoint>, SynthesisError> {
    let states = evaluator.scaling.state.len();
    let file = evaluator.space.at(coordinates);
    // With eps_1 = 0 any weight is as good as another.
    let unit = file.specs.eps[0].abs().max(1e-3);
    let linearisation = DMatrix::identity(states, states) * (weight / unit);
    evaluator.solve(coordinates, &linearisation)
}

/// A point with some of its coordinates moved, inside the limits.
fn moved(evaluator: &Evaluator<'_>, point: &[f64], to: impl Fn(&Range, f64) -> f64) -> Vec<f64> {
    let ranges = evaluator.space.ranges.iter().zip(point);
    let moved: Vec<f64> = ranges.map(|(range, &at)| to(range, at)).collect();
    evaluator.space.inside(&moved)
}
