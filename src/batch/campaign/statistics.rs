//! What a table of runs says: quantiles of the metrics, the pass rate and how well it is known.

use std::collections::BTreeMap;
use std::path::Path;

use statrs::function::beta::beta_reg;

use super::record::{PassRateInterval, Quantiles, RequirementCount};
use super::table::column_f64;
use super::CampaignError;
use crate::scenario::RequirementFile;
use crate::sim::metrics::METRICS;

/// Level of the confidence interval.
const CONFIDENCE: f64 = 0.95;
/// Halvings of the interval in which an end lies: more than a number has bits.
const HALVINGS: usize = 80;

/// The interval of Clopper and Pearson (1934) for `passed` of `runs` runs: whatever the probability
/// is, it lies inside with at least the confidence, for independent runs.
pub fn pass_rate_interval(passed: u64, runs: u64) -> PassRateInterval {
    let tail = 0.5 * (1.0 - CONFIDENCE);
    let (k, n) = (passed as f64, runs as f64);
    PassRateInterval {
        confidence: CONFIDENCE,
        lower: if passed == 0 {
            0.0
        } else {
            quantile_of_beta(k, n - k + 1.0, tail)
        },
        upper: if passed == runs {
            1.0
        } else {
            quantile_of_beta(k + 1.0, n - k, 1.0 - tail)
        },
        method: "Clopper-Pearson".to_string(),
    }
}

/// Where the distribution function of a beta distribution with parameters above 0 has that value.
fn quantile_of_beta(a: f64, b: f64, fraction: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if beta_reg(a, b, middle) < fraction {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Values in order.
pub struct Ordered(pub Vec<f64>);

impl Ordered {
    /// Sorts the values.
    pub fn new(values: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.collect();
        sorted.sort_by(f64::total_cmp);
        Self(sorted)
    }

    /// The quantile of a fraction, on the straight line between two values, as in numpy and pandas; `None`
    /// without values.
    pub fn at(&self, fraction: f64) -> Option<f64> {
        let place = fraction * self.0.len().checked_sub(1)? as f64;
        let below = *self.0.get(place.floor() as usize)?;
        let above = *self.0.get(place.ceil() as usize)?;
        Some(below + (above - below) * place.fract())
    }
}

/// Quantiles of the values that are there; `None` when there is none.
pub fn quantiles(values: &[Option<f64>]) -> Option<Quantiles> {
    let sorted = Ordered::new(values.iter().copied().flatten());
    Some(Quantiles {
        count: sorted.0.len() as u64,
        min: sorted.at(0.0)?,
        median: sorted.at(0.5)?,
        p95: sorted.at(0.95)?,
        max: sorted.at(1.0)?,
    })
}

/// Quantiles of every metric that at least one run has. Holds one column at a time.
///
/// # Errors
/// A table that cannot be read.
pub fn metric_quantiles(runs: &Path) -> Result<BTreeMap<String, Quantiles>, CampaignError> {
    let mut out = BTreeMap::new();
    for entry in METRICS {
        let found = quantiles(&column_f64(runs, entry.key)?);
        out.extend(found.map(|found| (entry.key.to_string(), found)));
    }
    Ok(out)
}

/// How many runs missed each requirement.
///
/// # Errors
/// A table that cannot be read.
pub fn count_missed(
    runs: &Path,
    requirements: &[RequirementFile],
) -> Result<Vec<RequirementCount>, CampaignError> {
    let mut out = Vec::new();
    for requirement in requirements {
        let Some(required) = requirement.limit() else {
            continue;
        };
        let metric = requirement.metric.key();
        let values = column_f64(runs, metric)?.into_iter();
        let (side, limit) = required.parts();
        out.push(RequirementCount {
            name: format!("{metric} {side}"),
            metric: metric.to_string(),
            limit,
            missed: values.filter(|value| !required.is_met(*value)).count() as u64,
        });
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_numpy() {
        let values = [Some(4.0), None, Some(1.0), Some(3.0), Some(2.0)];
        let expected = Quantiles {
            count: 4,
            min: 1.0,
            median: 2.5,
            // numpy.quantile([1, 2, 3, 4], 0.95)
            p95: 3.8499999999999996,
            max: 4.0,
        };
        let found = quantiles(&values).unwrap();
        assert!((found.p95 - expected.p95).abs() < 1e-15);
        assert_eq!((found.min, found.median, found.max), (1.0, 2.5, 4.0));
        assert_eq!(found.count, 4);
        assert_eq!(quantiles(&[None]), None);
    }

    #[test]
    fn the_interval_is_clopper_and_pearson_s() {
        // All of n: the lower end is (tail)^(1/n), from the definition.
        let interval = pass_rate_interval(10_000, 10_000);
        assert!((interval.lower - 0.025_f64.powf(1e-4)).abs() < 1e-12);
        assert_eq!(interval.upper, 1.0);
        let interval = pass_rate_interval(0, 20);
        assert_eq!(interval.lower, 0.0);
        assert!((interval.upper - (1.0 - 0.025_f64.powf(0.05))).abs() < 1e-12);
        // The binomial distribution itself at the ends for 3 of 8.
        let interval = pass_rate_interval(3, 8);
        let probability = |p: f64, from: u32, to: u32| -> f64 {
            let term = |k: u32| {
                let choose = (0..k).fold(1.0, |c, i| c * f64::from(8 - i) / f64::from(i + 1));
                choose * p.powi(k as i32) * (1.0 - p).powi(8 - k as i32)
            };
            (from..=to).map(term).sum()
        };
        assert!((probability(interval.lower, 3, 8) - 0.025).abs() < 1e-10);
        assert!((probability(interval.upper, 0, 3) - 0.025).abs() < 1e-10);
    }
}
