//! What a page shows of a sweep, and which curves show it.

use synth::claim::Claim;
use synth::model::Kind;

use crate::base::number::label;
use crate::batch::sweep::finished::Finished;
use crate::batch::sweep::outcome::PointOutcome;
use crate::batch::sweep::table::metric_names;
use crate::report::axis::{PlotAxis, Spacing};
use crate::report::chart::{Figure, FAINT, INK};
use crate::report::series::{Mark, Series, COLOURS};

/// Most curves of one figure.
const CURVES: usize = COLOURS.len();
/// Metrics of a model that are drawn.
const MODEL_METRICS: [&str; 3] = ["gamma", "guaranteed_gain", "certified_angle_deg"];

/// A sweep with the names of its axes.
pub struct View<'a> {
    /// The sweep.
    pub sweep: &'a Finished<'a>,
    /// Names and units of the axes.
    pub labels: Vec<String>,
    /// The values of each axis.
    pub values: Vec<&'a [f64]>,
}

impl<'a> View<'a> {
    /// Axes are named by their last key, or by the full name where that key is another's too.
    pub fn new(sweep: &'a Finished<'a>) -> Self {
        let names = sweep.grid.names();
        let last = |name: &String| name.rsplit('.').next().unwrap_or(name).to_string();
        let labels = names.iter().map(|name| {
            let short = last(name);
            let unique = names.iter().filter(|other| last(other) == short).count() == 1;
            let shown = if unique { short } else { name.clone() };
            labelled(&shown, sweep.subject.unit(name))
        });
        View {
            sweep,
            labels: labels.collect(),
            values: sweep.grid.axes().map(|(_, values)| values).collect(),
        }
    }

    /// Whether a model was swept, not a scenario.
    pub fn of_model(&self) -> bool {
        self.sweep.subject.kind() == Kind::Model
    }

    /// A metric as text, its unit in brackets.
    pub fn named(&self, metric: &str) -> String {
        labelled(metric, self.sweep.subject.unit(metric))
    }

    /// The value that is shown of a point: of a model, only what is proved counts.
    pub fn shown(&self, outcome: &PointOutcome, metric: &str) -> Option<f64> {
        let counts = !self.of_model() || outcome.good();
        outcome.metric(metric).filter(|_| counts)
    }

    /// The values that are shown of a metric.
    pub fn all(&self, metric: &'a str) -> impl Iterator<Item = f64> + '_ {
        let outcomes = self.sweep.outcomes.iter();
        outcomes.filter_map(move |outcome| self.shown(outcome, metric))
    }

    /// The metrics that differ between points, and those that do not.
    pub fn metrics(&self) -> (Vec<String>, Vec<String>) {
        let names = match self.of_model() {
            true => MODEL_METRICS.map(str::to_string).to_vec(),
            false => metric_names(self.sweep.outcomes),
        };
        let known = names
            .into_iter()
            .filter(|name| self.all(name).next().is_some());
        known.partition(|name| {
            let first = self.all(name).next();
            self.of_model() || self.all(name).any(|value| Some(value) != first)
        })
    }

    /// The axes with several values.
    pub fn varied(&self) -> Vec<usize> {
        let axes = 0..self.values.len();
        axes.filter(|&axis| self.values[axis].len() > 1).collect()
    }

    /// The distance of points that are neighbours along an axis only.
    pub fn stride(&self, axis: usize) -> usize {
        let faster = self.values[axis + 1..].iter();
        faster.map(|values| values.len()).product()
    }

    /// The points that have the first value of each of these axes.
    pub fn starts(&self, axes: &[usize]) -> Vec<usize> {
        let first = |point: &usize| {
            let mut axes = axes.iter();
            axes.all(|&axis| (point / self.stride(axis)) % self.values[axis].len() == 0)
        };
        (0..self.sweep.grid.points()).filter(first).collect()
    }

    /// The indices of an axis's values, from the smallest to the largest.
    pub fn order(&self, axis: usize) -> Vec<usize> {
        let values = self.values[axis];
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        order
    }

    /// The values of a point as text, without those of some axes.
    pub fn place(&self, point: &[f64], without: &[usize]) -> String {
        let named = self.labels.iter().zip(point).enumerate();
        let named = named.filter(|(axis, _)| !without.contains(axis));
        let named = named.map(|(_, (axis, &value))| format!("{axis} {}", label(value)));
        named.collect::<Vec<_>>().join(", ")
    }

    /// A metric against an axis: one curve for each choice of the other axes, as many as can be distinguished apart.
    pub fn curve(&self, metric: &str, axis: usize) -> Figure {
        let starts = self.starts(&[axis]);
        let chosen = evenly(starts.len(), CURVES);
        let mut series = Vec::new();
        let mut without = Vec::new();
        for (&choice, colour) in chosen.iter().zip(COLOURS) {
            let start = starts[choice];
            let points = self.order(axis).into_iter().map(|index| {
                let outcome = &self.sweep.outcomes[start + index * self.stride(axis)];
                (self.values[axis][index], self.shown(outcome, metric))
            });
            let points: Vec<(f64, Option<f64>)> = points.collect();
            let mut name = self.place(&self.sweep.grid.point(start), &[axis]);
            let runs = points.split(|(_, value)| value.is_none());
            for run in runs.filter(|run| !run.is_empty()) {
                let run = run.iter().filter_map(|&(at, value)| Some((at, value?)));
                series.push(Series {
                    colour: Some(colour),
                    ..Series::new(&std::mem::take(&mut name), Mark::Joined, run)
                });
            }
            let missing = points.iter().filter(|(_, value)| value.is_none());
            without.extend(missing.map(|&(at, _)| (at, 0.0)));
        }
        if !without.is_empty() {
            series.push(Series {
                colour: Some(INK),
                ..Series::new("no value", Mark::Crosses, without)
            });
        }
        let (across, up) = (&self.labels[axis], self.named(metric));
        let note = match chosen.len() < starts.len() {
            true => format!(" ({} of {} curves)", chosen.len(), starts.len()),
            false => String::new(),
        };
        plot(
            format!("{up} against {across}{note}"),
            [across, &up],
            series,
        )
    }
}

/// A figure of values against values.
fn plot(title: String, labels: [&str; 2], series: Vec<Series>) -> Figure {
    Figure {
        title,
        axes: labels.map(|label| PlotAxis::new(label, Spacing::Fitting)),
        series,
        narrow: true,
        ..Figure::default()
    }
}

/// A key as text, its unit in brackets. The unit stands at the end of the key, before the number of an entry.
pub fn labelled(key: &str, unit: &str) -> String {
    let (stem, entry) = key.split_at(key.find('[').unwrap_or(key.len()));
    let (end, written) = match unit {
        "" => return key.replace('_', " "),
        "s" if stem.ends_with("_seconds") => ("_seconds".to_string(), " (s)".to_string()),
        unit => (unit_key(unit), format!(" ({unit})")),
    };
    let stem = stem.strip_suffix(&end).unwrap_or(stem);
    format!("{stem}{entry}").replace('_', " ") + &written
}

/// How a unit is written in a key.
fn unit_key(unit: &str) -> String {
    let key = unit
        .replace("1/", "per_")
        .replace('/', "_")
        .replace("N m", "nm");
    format!("_{}", key.replace('^', "").replace(' ', "_"))
}

/// The points that no other beats: the larger angle costs the larger gamma. In the order of the angle.
pub fn front(outcomes: &[PointOutcome]) -> Vec<usize> {
    let known = |index: &usize| {
        let outcome = &outcomes[*index];
        let angle = outcome.metric("certified_angle_deg")?;
        Some((angle, outcome.metric("gamma")?)).filter(|_| outcome.good())
    };
    let candidates = (0..outcomes.len()).filter_map(|index| Some((index, known(&index)?)));
    let mut candidates: Vec<(usize, (f64, f64))> = candidates.collect();
    // The widest first; of equal angles the smallest gamma; of equal points the first.
    candidates
        .sort_by(|(i, a), (j, b)| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)).then(i.cmp(j)));
    let mut smallest = f64::INFINITY;
    let mut front: Vec<usize> = Vec::new();
    for (index, (_, gamma)) in candidates {
        if gamma < smallest {
            smallest = gamma;
            front.push(index);
        }
    }
    front.reverse();
    front
}

/// Gamma against the certified angle, with the front; `None` without one.
pub fn trade_off(outcomes: &[PointOutcome], front: &[usize]) -> Option<Figure> {
    let at = |outcome: &PointOutcome| {
        let angle = outcome.metric("certified_angle_deg")?;
        Some((angle, outcome.metric("gamma")?))
    };
    let proved = outcomes.iter().filter(|outcome| outcome.good());
    let proved = Series {
        colour: Some(FAINT),
        ..Series::new("proved", Mark::Points, proved.filter_map(at))
    };
    let on_front = front.iter().filter_map(|&index| at(&outcomes[index]));
    let on_front = Series {
        colour: Some(COLOURS[0]),
        ..Series::new("Pareto front", Mark::Steps, on_front)
    };
    let title = "gamma against certified angle".to_string();
    let labels = ["certified angle at rest (deg)", "gamma"];
    let some = !on_front.points.is_empty();
    some.then(|| plot(title, labels, vec![proved, on_front]))
}

/// At most `count` of `of` indices, at equal distances, the first and the last among them.
fn evenly(of: usize, count: usize) -> Vec<usize> {
    match of <= count {
        true => (0..of).collect(),
        false => (0..count)
            .map(|index| index * (of - 1) / (count - 1))
            .collect(),
    }
}

/// What a design claims is rounded to the safe side.
pub fn claim_text(metric: &str, value: f64) -> String {
    match metric {
        "gamma" | "guaranteed_gain" => format!("{:.4}", Claim::AtMost(value)),
        "certified_angle_deg" | "worst_margin" => format!("{:.4}", Claim::AtLeast(value)),
        _ => label(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Number;

    fn proved(angle: f64, gamma: f64) -> PointOutcome {
        let of = |value| Number::from_f64(value);
        PointOutcome {
            point: 0,
            values: vec![0.0],
            verdict: "proved".to_string(),
            reason: None,
            metrics: vec![
                ("certified_angle_deg".to_string(), of(angle)),
                ("gamma".to_string(), of(gamma)),
            ],
            ..PointOutcome::default()
        }
    }

    #[test]
    fn the_front_has_the_points_that_no_other_beats() {
        let mut not_proved = proved(90.0, 0.01);
        not_proved.verdict = "not_proved".to_string();
        let points = [
            proved(10.0, 0.1),
            proved(20.0, 0.3),
            proved(15.0, 0.4),
            proved(20.0, 0.2),
            proved(5.0, 0.1),
            proved(30.0, 0.5),
            not_proved,
            proved(30.0, 0.5),
        ];
        assert_eq!(front(&points), [0, 3, 5]);
        assert_eq!(front(&points[6..7]), [0; 0]);
    }

    #[test]
    fn labels_are_words_with_units() {
        assert_eq!(labelled("phi_per_s", "1/s"), "phi (1/s)");
        assert_eq!(
            labelled("torque_limit_nm[*]", "N m"),
            "torque limit[*] (N m)"
        );
        assert_eq!(
            labelled("certified_angle_deg", "deg"),
            "certified angle (deg)"
        );
        assert_eq!(
            labelled("inertia_kg_m2[0][0]", "kg m^2"),
            "inertia[0][0] (kg m^2)"
        );
        assert_eq!(labelled("max_rate", "rad/s"), "max rate (rad/s)");
        assert_eq!(labelled("gamma", ""), "gamma");
    }

    #[test]
    fn curves_are_chosen_over_the_whole_range() {
        assert_eq!(evenly(3, 6), [0, 1, 2]);
        assert_eq!(evenly(11, 6), [0, 2, 4, 6, 8, 10]);
    }
}
