//! From a model to its parameter search.

use nalgebra::{DMatrix, DVector};

use super::evaluator::{Aim, GainBounds};
use super::space::{Range, Space};
use crate::model::{Model, ModelFile, Objective, PlantFile, SearchFile};
use crate::programs::Parameter;
use crate::scaling::Scaling;
use crate::synthesis::gyroscopic_form;

/// The search of a model.
#[derive(Debug, Clone)]
pub struct Plan {
    /// What is varied.
    pub space: Space,
    /// The objective.
    pub aim: Aim,
    /// Sets that must be contained, with a small allowance; SI units.
    pub contained: Vec<DMatrix<f64>>,
    /// The search's limits.
    pub limits: SearchFile,
    /// A unit of the state that suits the requested set.
    pub unit: f64,
    /// The same as a fraction of the region's extent along the states that the set reaches; where each state has a unit
    /// of its own. `None` where one unit says as much.
    pub unit_fraction: Option<f64>,
}

/// Relative allowance of the sets that must be contained, so that containment can be proved.
const COVER_ROOM: f64 = 1e-3;

/// Limits of eps_1 and eps_3, relative to eps_2, where none are given.
const WEIGHT_FACTOR: [f64; 2] = [0.01, 100.0];

/// Limits of the gyroscopic form's part along the identity.
const FORM_MEAN: [f64; 2] = [-1.0, 2.0];

/// Limits of its part along the inertia's deviation.
const FORM_DEVIATION: [f64; 2] = [-3.0, 2.0];

/// The smallest xi, relative to xi_max, where no limits are given.
const LEAST_WEIGHT: f64 = 1e-9;

/// A unit of the state relative to the size of what must be in the set.
const UNIT_SHARE: f64 = 0.4;

/// Whether a model requests a search.
pub fn wanted(model: &Model) -> bool {
    let specs = &model.file.specs;
    specs.search.is_some() || specs.objective == Objective::Region
}

impl Plan {
    /// The plan for a model that requests a search.
    pub fn of(model: &Model) -> Self {
        let specs = &model.file.specs;
        let limits = specs.search.clone().unwrap_or_else(SearchFile::unlimited);
        let states = specs.must_contain.iter();
        let states: Vec<DMatrix<f64>> = states
            .map(|state| DMatrix::from_column_slice(state.len(), 1, state))
            .collect();
        let mut contained = Vec::new();
        if let Some(angle) = limits.certified_angle_min_deg {
            let norm = (0.5 * angle.to_radians()).sin();
            contained.push(attitudes() * (norm * (1.0 + COVER_ROOM)));
        }
        let aim = match specs.objective {
            Objective::Gain | Objective::Pointing | Objective::Gamma | Objective::Both => {
                contained.extend(states.iter().map(|state| state * (1.0 + COVER_ROOM)));
                Aim::Gain
            }
            Objective::Region => Aim::Reach {
                scaled: match states.is_empty() {
                    true => vec![attitudes()],
                    false => states.clone(),
                },
                bounds: GainBounds {
                    gamma: limits.gamma_max,
                    gain: limits.guaranteed_gain_max,
                },
            },
        };
        let mut base = model.file.clone();
        base.specs.search = None;
        let ranges = ranges(model, &limits, &mut base);
        let unit = unit(model, &contained, &aim);
        let unit_fraction = unit_fraction(model, unit, &contained, &aim);
        Plan {
            space: Space { base, ranges },
            aim,
            contained,
            limits,
            unit,
            unit_fraction,
        }
    }

    /// The same for the model without bounds on the gain.
    pub fn without_bounds(&self, model: &Model) -> Self {
        let mut model = model.clone();
        model.file.specs.search = Some(SearchFile {
            gamma_max: None,
            guaranteed_gain_max: None,
            ..self.limits.clone()
        });
        Plan::of(&model)
    }
}

/// D with D z, |z| <= 1, all attitudes at rest.
fn attitudes() -> DMatrix<f64> {
    DMatrix::from_fn(6, 3, |r, c| if r == c + 3 { 1.0 } else { 0.0 })
}

fn unit(model: &Model, contained: &[DMatrix<f64>], aim: &Aim) -> f64 {
    let size = |sets: &[DMatrix<f64>]| {
        let longest = sets
            .iter()
            .flat_map(|set| set.column_iter().map(|c| c.norm()).collect::<Vec<_>>());
        longest.fold(0.0_f64, f64::max)
    };
    let wanted = match aim {
        Aim::Reach { scaled, .. } => size(scaled),
        Aim::Gain => size(contained),
    };
    if wanted > 0.0 {
        return UNIT_SHARE * wanted;
    }
    let region = model.task().system.region;
    let extents = region.iter().map(|bound| {
        let reach = bound.rows.norm().max(f64::MIN_POSITIVE);
        bound.bound_squared.max(0.0).sqrt() / reach
    });
    let smallest = extents
        .filter(|extent| *extent > 0.0)
        .fold(f64::INFINITY, f64::min);
    if smallest.is_finite() {
        0.5 * smallest
    } else {
        1.0
    }
}

/// The unit relative to the largest extent of the region along the states that must be in the set.
fn unit_fraction(model: &Model, unit: f64, contained: &[DMatrix<f64>], aim: &Aim) -> Option<f64> {
    let scaled = match aim {
        Aim::Reach { scaled, .. } => scaled.as_slice(),
        Aim::Gain => &[],
    };
    let extents = Scaling::automatic(&model.task().system, 1.0).state;
    if extents.iter().all(|extent| *extent == extents[0]) {
        return None;
    }
    let reached = |state: usize| {
        let sets = contained.iter().chain(scaled);
        sets.into_iter().any(|set| set.row(state).norm() > 0.0)
    };
    let along = (0..extents.len()).filter(|&state| reached(state));
    let largest = along.map(|state| extents[state]).reduce(f64::max);
    largest.map(|extent| (unit / extent).min(1.0))
}

/// What is varied; what has one value only is set in `base`.
fn ranges(model: &Model, limits: &SearchFile, base: &mut ModelFile) -> Vec<Range> {
    let specs = &model.file.specs;
    if model.has_free_form() {
        for (parameter, value) in gyroscopic_form::first_parts() {
            parameter.set(base, value);
        }
    }
    let mut out: Vec<Range> = Vec::new();
    let mut push = |parameter: Parameter, [low, high]: [f64; 2]| {
        if low < high {
            let limits = [low, high];
            out.push(Range { parameter, limits });
        } else {
            parameter.set(base, low);
        }
    };
    if let Some(range) = limits.phi_per_s {
        push(Parameter::DecayRate, range);
    }
    if let Some(range) = limits.nu {
        push(Parameter::Threshold, range);
    }
    // Only an exact plant has these limits; its box stays as it is given where they are left out.
    for axis in 0..3 {
        if let Some(range) = limits.rate_rad_s {
            push(Parameter::Rate(axis), range);
        }
    }
    if let Some(range) = limits.q0_min {
        push(Parameter::ScalarPart, range);
    }
    let weights = WEIGHT_FACTOR.map(|factor| factor * specs.eps[1]);
    push(Parameter::FirstWeight, limits.eps_1.unwrap_or(weights));
    push(Parameter::ThirdWeight, limits.eps_3.unwrap_or(weights));
    if model.has_free_form() {
        push(Parameter::FormMean, FORM_MEAN);
        push(Parameter::FormDeviation, FORM_DEVIATION);
    }
    let largest = largest_weight(model, limits);
    let xi = limits.xi_max.unwrap_or([LEAST_WEIGHT * largest, largest]);
    let cap = limits.gamma_max.unwrap_or(f64::INFINITY);
    push(Parameter::DisturbanceWeight, xi.map(|value| value.min(cap)));
    out
}

/// xi_max, or the largest xi that gains anything at the fastest decay that is searched, where that is smaller.
fn largest_weight(model: &Model, limits: &SearchFile) -> f64 {
    let specs = &model.file.specs;
    let fastest = limits.phi_per_s.map_or(specs.phi_per_s, |[_, high]| high);
    let useful = model.task().largest_useful_weight() * (fastest / specs.phi_per_s);
    specs.xi_max.min(useful)
}

/// The first required state that lies outside every allowed box, as a sentence.
pub fn outside_every_box(model: &Model, plan: &Plan) -> Option<String> {
    if !matches!(model.file.plant, PlantFile::Exact(_)) {
        return None;
    }
    let [least, _] = plan.space.limits(Parameter::ScalarPart);
    let longest = (1.0 - least * least).max(0.0).sqrt();
    for (index, state) in model.file.specs.must_contain.iter().enumerate() {
        let state = DVector::from_column_slice(state);
        let norm = state.rows(3, 3).norm();
        if norm >= longest {
            let angle = |norm: f64| (2.0 * norm.min(1.0).asin()).to_degrees();
            return Some(format!(
                "must-contain state {} lies outside every box: its |q| is {norm:.4} ({:.1} deg), but q0_min is at least \
                 {least}, so that |q| stays below {longest:.4} ({:.1} deg)",
                index + 1,
                angle(norm),
                angle(longest)
            ));
        }
        for axis in 0..3 {
            let [_, highest] = plan.space.limits(Parameter::Rate(axis));
            if state[axis].abs() >= highest {
                return Some(format!(
                    "must-contain state {} lies outside every box: its rate about axis {} is {} rad/s, but the box ends at \
                     {highest} rad/s",
                    index + 1,
                    axis + 1,
                    state[axis]
                ));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parameters that are searched for a shipped model whose search has these ranges.
    fn varied(rates: Option<[f64; 2]>, scalar_part: Option<[f64; 2]>) -> (Vec<Parameter>, Plan) {
        let text = include_str!("../../../../models/xu2020-gain.json");
        let mut model = Model::from_json(text).expect("a model");
        let search = model.file.specs.search.as_mut().expect("a search");
        (search.rate_rad_s, search.q0_min) = (rates, scalar_part);
        let plan = Plan::of(&model);
        let ranges = plan.space.ranges.iter().map(|range| range.parameter);
        (ranges.collect(), plan)
    }

    #[test]
    fn the_box_that_the_model_gives_is_kept_unless_a_range_frees_it() {
        let (kept, plan) = varied(None, None);
        let of_box =
            |parameter: &Parameter| matches!(parameter, Parameter::Rate(_) | Parameter::ScalarPart);
        assert!(!kept.iter().any(of_box), "{kept:?}");
        let PlantFile::Exact(exact) = plan.space.at(&plan.space.start()).plant else {
            panic!("a spacecraft");
        };
        assert_eq!((exact.rate_rad_s, exact.q0_min), ([0.1; 3], 0.75));
        let (freed, plan) = varied(Some([0.01, 1.0]), Some([0.5, 0.9]));
        assert_eq!(freed.iter().filter(|one| of_box(one)).count(), 4);
        assert_eq!(plan.space.limits(Parameter::Rate(2)), [0.01, 1.0]);
        assert_eq!(plan.space.limits(Parameter::ScalarPart), [0.5, 0.9]);
        let (half, _) = varied(None, Some([0.5, 0.9]));
        assert!(half.contains(&Parameter::ScalarPart) && !half.contains(&Parameter::Rate(0)));
    }
}
