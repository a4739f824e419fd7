//! Distributions of drawn numbers, as functions of a number that is uniform in (0, 1).
//!
//! A point of the unit cube becomes the numbers of a run through these, so that a Latin hypercube and a
//! Sobol sequence can take the place of independent random numbers.

use nalgebra::Vector3;
use statrs::distribution::{ContinuousCDF, Normal};
use synth::model::{finite, ModelError};

use super::dispersions_file::{DistributionFile, NormalFile};

/// Least fraction of a normal distribution that its bounds may leave.
const LEAST_SHARE: f64 = 1e-6;

/// A checked distribution.
#[derive(Debug, Clone, PartialEq)]
pub enum Distribution {
    /// Normal, cut off.
    Normal {
        /// Mean before it is cut off.
        mean: f64,
        /// Standard deviation before it is cut off.
        deviation: f64,
        /// Probabilities of being below the lower and below the upper bound before it is cut off.
        fraction: [f64; 2],
        /// The bounds; infinite for none.
        bounds: [f64; 2],
    },
    /// Uniform between two bounds.
    Uniform {
        /// Lower bound.
        from: f64,
        /// Upper bound.
        to: f64,
    },
    /// One of a list.
    Choice(Vec<f64>),
}

impl Distribution {
    /// Checks the distribution of a field.
    ///
    /// # Errors
    /// A number that is out of its range.
    pub fn new(field: &str, file: &DistributionFile) -> Result<Self, ModelError> {
        match file {
            DistributionFile::Normal(normal) => cut_normal(&format!("{field}.normal"), normal),
            DistributionFile::Uniform(uniform) => {
                let (from, to) = (uniform.from, uniform.to);
                finite(&format!("{field}.uniform.from"), from)?;
                finite(&format!("{field}.uniform.to"), to)?;
                let field = format!("{field}.uniform.to");
                require(to >= from, &field, to, "'from' or above")?;
                Ok(Distribution::Uniform { from, to })
            }
            DistributionFile::Choice(values) => {
                if values.is_empty() {
                    return Err(ModelError::Choice {
                        field: format!("{field}.choice"),
                        reason: "the list is empty; it must have at least one value".to_string(),
                    });
                }
                for (index, &value) in values.iter().enumerate() {
                    finite(&format!("{field}.choice[{index}]"), value)?;
                }
                Ok(Distribution::Choice(values.clone()))
            }
        }
    }

    /// The value below which the fraction `uniform`, in (0, 1), of all values lies.
    pub fn value(&self, uniform: f64) -> f64 {
        match self {
            Distribution::Normal {
                mean,
                deviation,
                fraction: [below, above],
                bounds: [least, most],
            } => {
                let value = mean + deviation * standard_normal(below + uniform * (above - below));
                value.clamp(*least, *most)
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
                mean, deviation, ..
            } if *deviation == 0.0 => [*mean; 2],
            Distribution::Normal { bounds, .. } => *bounds,
            Distribution::Uniform { from, to } => [*from, *to],
            Distribution::Choice(values) => values
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], &v| {
                    [least.min(v), most.max(v)]
                }),
        }
    }
}

fn require(ok: bool, field: &str, value: f64, allowed: &str) -> Result<(), ModelError> {
    if ok {
        return Ok(());
    }
    Err(ModelError::OutOfRange {
        field: field.to_string(),
        value,
        allowed: allowed.to_string(),
    })
}

fn cut_normal(field: &str, file: &NormalFile) -> Result<Distribution, ModelError> {
    let (mean, deviation) = (file.mean, file.standard_deviation);
    finite(&format!("{field}.mean"), mean)?;
    let named = format!("{field}.standard_deviation");
    require(deviation >= 0.0, &named, deviation, "0 or above")?;
    finite(&named, deviation)?;
    let least = file.at_least.unwrap_or(f64::NEG_INFINITY);
    let most = file.at_most.unwrap_or(f64::INFINITY);
    let side = if file.at_most.is_some() {
        ("at_most", most)
    } else {
        ("at_least", least)
    };
    let fraction = match deviation > 0.0 {
        true => [least, most].map(|bound| below((bound - mean) / deviation)),
        false => [0.0, f64::from(u8::from(least <= mean && mean <= most))],
    };
    let allowed = format!(
        "so that at_least and at_most leave a share of {LEAST_SHARE} or more of the distribution"
    );
    let ok = fraction[1] - fraction[0] >= LEAST_SHARE;
    require(ok, &format!("{field}.{}", side.0), side.1, &allowed)?;
    Ok(Distribution::Normal {
        mean,
        deviation,
        fraction,
        bounds: [least, most],
    })
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
