//! Percentile bands over time and distributions of metrics.

use std::path::Path;

use crate::batch::campaign::folder::{PROFILES_FILE, RUNS_FILE};
use crate::batch::campaign::record::{RequirementCount, Results};
use crate::batch::campaign::statistics::Ordered;
use crate::batch::campaign::table::column_f64;
use crate::batch::campaign::CampaignError;
use crate::report::axis::{ends, PlotAxis, Spacing};
use crate::report::chart::{Band, Figure};
use crate::report::series::Series;

/// Metrics whose distribution is drawn, where the campaign has them: name, title, axis.
const DISTRIBUTIONS: [(&str, &str, &str); 5] = [
    ("settle_seconds", "Settling time", "settling time (s)"),
    ("triggers", "Messages", "messages of a run"),
    (
        "tail_error_deg",
        "Largest error over the tail",
        "error (deg)",
    ),
    (
        "rms_state_norm",
        "Rms norm of the state over the tail",
        "norm of the state",
    ),
    (
        "lyapunov_ratio",
        "Largest x'Ux over its bound",
        "x'Ux over its bound",
    ),
];

/// Percentiles drawn: the outer band, the inner band, the median.
const OUTER: [f64; 2] = [0.05, 0.95];
const INNER: [f64; 2] = [0.25, 0.75];

/// A figure of percentile bands for each quantity of the profiles.
///
/// # Errors
/// A table that cannot be read.
pub fn bands(folder: &Path, results: &Results) -> Result<Vec<Figure>, CampaignError> {
    let path = folder.join(PROFILES_FILE);
    let times = &results.profile.times_s;
    let mut out = Vec::new();
    for quantity in &results.profile.quantities {
        let mut spreads = Vec::with_capacity(times.len());
        for index in 0..times.len() {
            let column = column_f64(&path, &format!("{quantity}_{index:03}"))?;
            let values = Ordered::new(column.into_iter().flatten());
            let wanted = [OUTER[0], INNER[0], 0.5, INNER[1], OUTER[1], 1.0];
            spreads.push(wanted.map(|fraction| values.at(fraction).unwrap_or(f64::NAN)));
        }
        out.push(band_figure(quantity, times, &spreads));
    }
    Ok(out)
}

fn band_figure(quantity: &str, times: &[f64], spreads: &[[f64; 6]]) -> Figure {
    let (title, label) = match quantity {
        "error_deg" => ("Attitude error of all runs", "error (deg)"),
        "rate_rad_s" => ("Rate error of all runs", "norm of the rate error (rad/s)"),
        "state_norm" => ("Norm of the state of all runs", "norm of the state"),
        other => (other, other),
    };
    let line = |name: &str, which: usize| {
        let values: Vec<f64> = spreads.iter().map(|spread| spread[which]).collect();
        Series::connected(name, times, &values)
    };
    let band = |name: &str, low: usize, high: usize, strength: f64| {
        let points = times.iter().zip(spreads);
        let points = points.map(|(&time, spread)| (time, spread[low], spread[high]));
        Band {
            name: name.to_string(),
            points: points
                .filter(|(_, low, high)| low.is_finite() && high.is_finite())
                .collect(),
            strength,
        }
    };
    let lines = vec![line("median", 2), line("largest of all runs", 5)];
    let end_s = times.last().copied().unwrap_or(0.0);
    let bands = vec![
        band("5 to 95 % of the runs", 0, 4, 0.22),
        band("25 to 75 %", 1, 3, 0.4),
    ];
    Figure {
        bands,
        ..Figure::over_time(title, label, end_s, lines).logarithmic()
    }
}

/// The distribution functions of the metrics that the campaign has.
///
/// # Errors
/// A table that cannot be read.
pub fn distributions(folder: &Path, results: &Results) -> Result<Vec<Figure>, CampaignError> {
    let path = folder.join(RUNS_FILE);
    let mut out = Vec::new();
    for (name, title, label) in DISTRIBUTIONS {
        if results.metrics.contains_key(name) {
            let values = column_f64(&path, name)?;
            let limits = results.requirements.iter().filter(|one| one.metric == name);
            out.push(distribution(title, label, &values, limits));
        }
    }
    Ok(out)
}

/// Fraction of all runs with at most that value; runs without the metric never reach it.
fn distribution<'a>(
    title: &str,
    label: &str,
    values: &[Option<f64>],
    limits: impl Iterator<Item = &'a RequirementCount>,
) -> Figure {
    let sorted = Ordered::new(values.iter().copied().flatten()).0;
    let marks: Vec<f64> = limits.map(|one| one.limit).collect();
    let within = ends(sorted.iter().chain(&marks).copied());
    let (low, high) = within.unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
    let room = 0.04 * (high - low).max(1e-3 * high.abs()).max(1e-9);
    let (start, end) = (low - room, high + room);
    let total = values.len().max(1) as f64;
    let fractions = (0..=sorted.len()).map(|count| count as f64 / total);
    let mut heights: Vec<f64> = fractions.collect();
    heights.push(sorted.len() as f64 / total);
    let places = [&[start], sorted.as_slice(), &[end]].concat();
    let missing = match values.len() - sorted.len() {
        0 => String::new(),
        missing => format!(" ({missing} of {} runs have none)", values.len()),
    };
    Figure {
        title: format!("{title}: share of the runs with at most that value{missing}"),
        axes: [
            PlotAxis::between(label, start, end),
            PlotAxis::new("share of the runs", Spacing::Linear),
        ],
        series: vec![Series::held("", &places, &heights)],
        limits: vec![0.0, 1.0],
        marks,
        ..Figure::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distribution_ends_at_the_share_of_runs_that_have_the_metric() {
        let values = [Some(3.0), None, Some(1.0), Some(2.0)];
        let limit = RequirementCount {
            name: "x at most".to_string(),
            metric: "x".to_string(),
            limit: 2.5,
            missed: 2,
        };
        let figure = distribution("X", "x", &values, [limit].iter());
        let points = &figure.series[0].points;
        assert_eq!(points.first().map(|point| point.1), Some(0.0));
        assert_eq!(points.last().map(|point| point.1), Some(0.75));
        assert!(points.contains(&(2.0, 0.25)) && points.contains(&(2.0, 0.5)));
        assert!(figure.title.contains("(1 of 4 runs have none)"));
        assert_eq!(figure.marks, [2.5]);
        figure.to_svg().unwrap();
    }

    #[test]
    fn bands_are_between_the_quantiles_of_the_runs() {
        let spread = Ordered::new((0..=100).map(f64::from));
        assert_eq!(spread.at(0.05), Some(5.0));
        assert_eq!(spread.at(0.5), Some(50.0));
        assert_eq!(Ordered::new(std::iter::empty()).at(0.5), None);
        let spreads = [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [f64::NAN; 6]];
        let figure = band_figure("error_deg", &[0.0, 1.0], &spreads);
        assert_eq!(figure.bands[0].points, [(0.0, 1.0, 5.0)]);
        assert_eq!(figure.bands[1].points, [(0.0, 2.0, 4.0)]);
        assert_eq!(figure.legend().len(), 4);
        figure.to_svg().unwrap();
    }
}
