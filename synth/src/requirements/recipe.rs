//! From facts to model files that synthesis takes, in natural units.

use super::facts::Facts;
use super::tables::{box_rate, fastest_decay, smallest_scalar_part};
use crate::model::{ModelFile, Objective, OuterSpecs, SearchFile};
use crate::natural_units::{turn_time, NaturalUnits};

/// The angle that is certified where none is required (rad).
const USUAL_ANGLE: f64 = 0.35;

/// How far beyond the required angle a set must reach, so that the angle can be proved.
const ROOM: f64 = 1.02;

/// Size of the large set from rest over that of the disturbance over the torque limit, and the smallest one that has been
/// found to leave a design.
const USUAL_LEVEL: f64 = 20.0;
const LEAST_LEVEL: f64 = 8.0;

/// Size of the large set from rest above which it hardly ever leads to the small one.
const LARGEST_LEVEL: f64 = 0.15;

/// Rounds of a search.
const ROUNDS: u32 = 8;

/// Weights of the multiplier that a search starts from.
const WEIGHTS: [f64; 3] = [1.4, 1.0, 1.35];

/// How a model is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Recipe {
    /// A small and a large set: the small one reaches `inner` times the angle, and both decay with `decay` times the fastest
    /// rate.
    TwoSets {
        /// Angle of the small set over that of the large one.
        inner: f64,
        /// Decay rate over the fastest one.
        decay: f64,
        /// Ratio of the sizes of the two certificates; searched without one.
        ratio: Option<f64>,
    },
    /// One set, searched: the decay rate begins at `decay` times the fastest, and xi where the disturbance alone reaches
    /// `level` times delta.
    OneSet {
        /// Decay rate over the fastest one.
        decay: f64,
        /// Size from rest over that of the disturbance over the torque limit.
        level: f64,
    },
}

/// Angle of the small set over that of the large one, and decay rate over the fastest one.
const TWO_SETS: [[f64; 2]; 4] = [
    [0.25, 0.3],
    [0.18, 0.3],
    [1.0 / 3.0, 0.3],
    [1.0 / 3.0, 0.15],
];

/// The same where a time to settle is required.
const FAST_TWO_SETS: [[f64; 2]; 3] = [[0.25, 0.3], [0.25, 0.5], [1.0 / 3.0, 0.7]];

/// Decay rate over the fastest one, and size from rest over that of the disturbance over the torque limit.
const ONE_SET: [[f64; 2]; 3] = [[0.8, 10.0], [0.8, 20.0], [0.48, 14.0]];

impl Recipe {
    /// In the order in which they are tried for these requirements.
    pub fn ways(facts: &Facts) -> Vec<Recipe> {
        let two = match facts.file.requirements.settle_s {
            None => TWO_SETS.as_slice(),
            Some(_) => &FAST_TWO_SETS,
        };
        let two = two.iter().map(|&[inner, decay]| Recipe::TwoSets {
            inner,
            decay,
            ratio: None,
        });
        let one = ONE_SET
            .iter()
            .map(|&[decay, level]| Recipe::OneSet { decay, level });
        match least_level(facts) <= LARGEST_LEVEL {
            true => two.chain(one).collect(),
            // The disturbance alone reaches too far for the large set to lead to the small one.
            false => one.chain(two.take(1)).collect(),
        }
    }

    /// The same with a ratio of the sizes of two certificates that is known; a recipe of one set as it is.
    pub fn at_ratio(self, ratio: Option<f64>) -> Self {
        match self {
            Recipe::TwoSets { inner, decay, .. } => Recipe::TwoSets {
                inner,
                decay,
                ratio,
            },
            one => one,
        }
    }

    /// Whether a design of it has a small and a large set.
    pub fn has_two_sets(self) -> bool {
        matches!(self, Recipe::TwoSets { .. })
    }
}

/// A model in natural units.
#[derive(Debug, Clone, PartialEq)]
pub struct Stated {
    /// The units.
    pub units: NaturalUnits,
    /// The model.
    pub model: ModelFile,
}

/// Time of a turn by an angle (rad) at full torque about the weakest axis (s); longer where the rate is limited.
fn turn(facts: &Facts, angle: f64) -> f64 {
    let craft = facts.craft();
    let time = turn_time(&craft.inertia_kg_m2, &craft.torque_limit_nm, angle);
    let limit = facts.file.requirements.rate_rad_s;
    limit.map_or(time, |limit| time.max(box_rate(angle) * angle / limit))
}

/// The angle to be certified (rad).
pub fn wanted_angle(facts: &Facts) -> f64 {
    let angle = facts.file.requirements.certified_angle_deg;
    angle.map_or(USUAL_ANGLE, f64::to_radians)
}

/// The model of a recipe.
pub fn stated(facts: &Facts, recipe: Recipe) -> Stated {
    let angle = wanted_angle(facts);
    let time = turn(facts, angle);
    let units = NaturalUnits::of_turn(time, &facts.craft().inertia_kg_m2);
    let si = match recipe {
        Recipe::TwoSets {
            inner,
            decay,
            ratio,
        } => two_sets(facts, angle, [inner, decay], ratio),
        Recipe::OneSet { decay, level } => one_set(facts, angle, decay, level),
    };
    // The weights of the multiplier are stated in natural units.
    let mut model = units.from_si(&si);
    model.specs.eps = match recipe {
        Recipe::TwoSets { .. } => [1.0; 3],
        Recipe::OneSet { .. } => WEIGHTS,
    };
    Stated { units, model }
}

/// One set for an angle (rad), with what is searched.
fn one_set(facts: &Facts, angle: f64, decay: f64, level: f64) -> ModelFile {
    let craft = facts.craft();
    let time = turn(facts, angle);
    let own = facts.file.specs.phi_per_s;
    let phi = own.unwrap_or(decay * fastest_decay(angle) / time);
    let largest = phi / craft.disturbance_bound_nm.powi(2);
    let start = (largest * (level / facts.authority()).powi(2)).min(largest);
    let rate = rates(facts, angle, time);
    let mut model = facts.model(rate, scalar_part(facts, angle), phi);
    model.specs.objective = Objective::Gain;
    model.specs.xi_max = start;
    let ceiling = facts.file.requirements.rate_rad_s;
    model.specs.search = Some(SearchFile {
        phi_per_s: own.is_none().then_some([phi / 6.0, 6.0 * phi]),
        rate_rad_s: craft.rate_rad_s.is_none().then(|| {
            let [low, high] = [rate[0] / 6.0, 6.0 * rate[0]];
            [low, ceiling.map_or(high, |limit| high.min(limit))]
        }),
        q0_min: craft
            .q0_min
            .is_none()
            .then(|| [0.02, (0.5 * ROOM * angle).cos()]),
        xi_max: Some([start * 1e-4, largest]),
        certified_angle_min_deg: facts.file.requirements.certified_angle_deg,
        rounds: ROUNDS,
        ..SearchFile::unlimited()
    });
    model
}

/// The smallest size of the large set from rest with which there is a design.
fn least_level(facts: &Facts) -> f64 {
    LEAST_LEVEL / facts.authority()
}

/// Two sets for an angle (rad).
fn two_sets(facts: &Facts, angle: f64, [inner, decay]: [f64; 2], ratio: Option<f64>) -> ModelFile {
    let craft = facts.craft();
    let time = turn(facts, angle);
    let small = inner * angle;
    let small_time = time * inner.sqrt();
    let own = facts.file.specs.phi_per_s;
    let phi = own.unwrap_or(decay * fastest_decay(small) / small_time);
    let mut model = facts.model(
        rates(facts, small, small_time),
        scalar_part(facts, small),
        phi,
    );
    let specs = &mut model.specs;
    specs.objective = Objective::Both;
    specs.margin = 1e-4;
    let phi = decay * fastest_decay(angle) / time;
    let level = USUAL_LEVEL / facts.authority();
    let level = level.min(LARGEST_LEVEL.max(least_level(facts)));
    let half = (0.5 * ROOM * angle).sin();
    let start = |axis: usize| {
        let mut state = vec![0.0; 6];
        state[3 + axis] = half;
        state
    };
    specs.outer = Some(OuterSpecs {
        phi_per_s: phi,
        rate_rad_s: rates(facts, angle, time),
        q0_min: scalar_part(facts, angle),
        xi_max: phi * (level.min(1.0) / craft.disturbance_bound_nm).powi(2),
        must_contain: (0..3).map(start).collect(),
        inner_scale: ratio,
        containment_weight: Some(0.5),
    });
    model
}

/// The box's rates for an angle (rad) in a time (s).
fn rates(facts: &Facts, angle: f64, time: f64) -> [f64; 3] {
    let rate = box_rate(angle) * angle / time;
    let limit = facts.file.requirements.rate_rad_s.unwrap_or(f64::INFINITY);
    facts.craft().rate_rad_s.unwrap_or([rate.min(limit); 3])
}

fn scalar_part(facts: &Facts, angle: f64) -> f64 {
    facts.craft().q0_min.unwrap_or(smallest_scalar_part(angle))
}
