//! Distributions of drawn numbers, as functions of a number that is uniform in (0, 1).
//!
//! A point of the unit cube becomes the numbers of a run through these, so that a Latin hypercube and a
//! Sobol sequence can take the place of independent random numbers.

use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use statrs::distribution::{ContinuousCDF, Normal};
use synth::model::readable;

use crate::base::bounded::{As, Finite, NonNegative};

/// Least fraction of a normal distribution that its bounds may leave.
const LEAST_SHARE: f64 = 1e-6;

/// The distribution of a number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields, remote = "Self")]
pub enum Distribution {
    /// Normal, cut off where bounds are given.
    Normal {
        /// Mean before it is cut off.
        #[serde(default, with = "As::<Finite>")]
        mean: f64,
        /// Standard deviation before it is cut off, not negative.
        #[serde(with = "As::<NonNegative>")]
        standard_deviation: f64,
        /// No value is below this.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_least: Option<f64>,
        /// No value is above this.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        at_most: Option<f64>,
    },
    /// Uniform between two bounds.
    Uniform {
        /// Lower bound.
        #[serde(with = "As::<Finite>")]
        from: f64,
        /// Upper bound, not below the lower.
        #[serde(with = "As::<Finite>")]
        to: f64,
    },
    /// One of these values, each as probable as any other.
    Choice(#[serde(with = "As::<Vec<Finite>>")] Vec<f64>),
}

impl<'de> Deserialize<'de> for Distribution {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let distribution = Self::deserialize(from)?;
        distribution.check().map_err(D::Error::custom)?;
        Ok(distribution)
    }
}

impl Serialize for Distribution {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        Self::serialize(self, to)
    }
}

impl Distribution {
    /// Refuses bounds that leave nothing and a list without values.
    fn check(&self) -> Result<(), String> {
        let refuse = |key: &str, value: f64, allowed: String| {
            let value = readable(value);
            Err(format!(
                "{key}: the value {value} is not allowed; it must be {allowed}"
            ))
        };
        match self {
            Distribution::Normal {
                at_least, at_most, ..
            } => {
                let [below, above] = self.cut_off();
                if above - below >= LEAST_SHARE {
                    return Ok(());
                }
                let (key, bound) = match (at_most, at_least) {
                    (Some(most), _) => ("normal.at_most", *most),
                    (None, least) => ("normal.at_least", least.unwrap_or(f64::NAN)),
                };
                let allowed = format!(
                    "so that at_least and at_most leave a share of {LEAST_SHARE} or more of the \
                     distribution"
                );
                refuse(key, bound, allowed)
            }
            Distribution::Uniform { from, to } if to < from => {
                refuse("uniform.to", *to, "'from' or above".to_string())
            }
            Distribution::Choice(values) if values.is_empty() => {
                Err("the list is empty; it must have at least one value".to_string())
            }
            _ => Ok(()),
        }
    }

    /// The value below which the fraction `uniform`, in (0, 1), of all values lies.
    pub fn value(&self, uniform: f64) -> f64 {
        match self {
            Distribution::Normal {
                mean,
                standard_deviation,
                at_least,
                at_most,
            } => {
                let [below, above] = self.cut_off();
                let normal = standard_normal(below + uniform * (above - below));
                let value = mean + standard_deviation * normal;
                let least = at_least.unwrap_or(f64::NEG_INFINITY);
                value.clamp(least, at_most.unwrap_or(f64::INFINITY))
            }
            Distribution::Uniform { from, to } => from * (1.0 - uniform) + to * uniform,
            Distribution::Choice(values) => {
                let index = (uniform * values.len() as f64) as usize;
                values[index.min(values.len() - 1)]
            }
        }
    }

    /// Smallest and largest value; infinite where there is none.
    pub fn range(&self) -> [f64; 2] {
        match self {
            Distribution::Normal {
                mean,
                standard_deviation,
                ..
            } if *standard_deviation == 0.0 => [*mean; 2],
            Distribution::Normal {
                at_least, at_most, ..
            } => [
                at_least.unwrap_or(f64::NEG_INFINITY),
                at_most.unwrap_or(f64::INFINITY),
            ],
            Distribution::Uniform { from, to } => [*from, *to],
            Distribution::Choice(values) => values
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], &v| {
                    [least.min(v), most.max(v)]
                }),
        }
    }

    /// Probabilities of a normal number below its lower and below its upper bound, before it is cut off.
    fn cut_off(&self) -> [f64; 2] {
        let Distribution::Normal {
            mean,
            standard_deviation,
            at_least,
            at_most,
        } = self
        else {
            return [0.0, 1.0];
        };
        let least = at_least.unwrap_or(f64::NEG_INFINITY);
        let most = at_most.unwrap_or(f64::INFINITY);
        match *standard_deviation > 0.0 {
            true => [least, most].map(|bound| below((bound - mean) / standard_deviation)),
            false => [0.0, f64::from(u8::from(least <= *mean && *mean <= most))],
        }
    }
}

/// The probability of a standard normal number below `bound`.
fn below(bound: f64) -> f64 {
    Normal::standard().cdf(bound)
}

/// The standard normal number below which the fraction `uniform` of all lies.
pub fn standard_normal(uniform: f64) -> f64 {
    // Its ends are infinite.
    Normal::standard().inverse_cdf(uniform.clamp(f64::MIN_POSITIVE, 1.0 - 0.5 * f64::EPSILON))
}

/// A direction, uniform over the sphere, from two numbers uniform in (0, 1).
pub fn direction([height, turn]: [f64; 2]) -> Vector3<f64> {
    let z = 2.0 * height - 1.0;
    let radius = libm::sqrt((1.0 - z) * (1.0 + z));
    let (sine, cosine) = libm::sincos(std::f64::consts::TAU * turn);
    Vector3::new(radius * cosine, radius * sine, z)
}

/// A rotation, uniform over all, from three numbers uniform in (0, 1): the scalar part first. K.
/// Shoemake, Uniform random rotations, Graphics Gems III (1992).
pub fn rotation([fraction, first, second]: [f64; 3]) -> [f64; 4] {
    let (sine_1, cosine_1) = libm::sincos(std::f64::consts::TAU * first);
    let (sine_2, cosine_2) = libm::sincos(std::f64::consts::TAU * second);
    let (inner, outer) = (libm::sqrt(fraction), libm::sqrt(1.0 - fraction));
    [
        inner * cosine_2,
        outer * sine_1,
        outer * cosine_1,
        inner * sine_2,
    ]
}

/// A direction in any number of dimensions, uniform over the sphere, from as many numbers uniform in
/// (0, 1).
pub fn direction_of_any_size(uniform: &[f64]) -> Vec<f64> {
    let normal: Vec<f64> = uniform.iter().map(|&u| standard_normal(u)).collect();
    let norm = libm::sqrt(normal.iter().map(|value| value * value).sum());
    if norm > 0.0 {
        return normal.iter().map(|value| value / norm).collect();
    }
    // Every number was 1/2, the one point without a direction.
    let first = |index: usize| f64::from(u8::from(index == 0));
    (0..uniform.len()).map(first).collect()
}
