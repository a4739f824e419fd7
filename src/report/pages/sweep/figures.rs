//! Which curves show a sweep.

use synth::model::Kind;

use crate::base::number::label;
use crate::batch::sweep::outcome::PointOutcome;
use crate::batch::sweep::subject::Subject;
use crate::batch::sweep::table::metric_names;
use crate::batch::variation::grid::Grid;
use crate::report::chart::COLOURS;
use crate::report::plot::{Marker, Plot, Series, FAINT, INK};

/// Most curves of one plot.
const CURVES: usize = COLOURS.len();
/// Metrics of a model that are drawn.
const MODEL_METRICS: [&str; 3] = ["gamma", "guaranteed_gain", "certified_angle_deg"];

/// Names of what is drawn: axes and metrics with their units.
pub struct Labels {
    /// Of the axes.
    pub axes: Vec<String>,
}

impl Labels {
    /// The last key of each axis, or the full name where that is another's too.
    pub fn new(subject: &Subject, grid: &Grid) -> Self {
        let names = grid.names();
        let last = |name: &String| name.rsplit('.').next().unwrap_or(name).to_string();
        let axes = names.iter().map(|name| {
            let short = last(name);
            let unique = names.iter().filter(|other| last(other) == short).count() == 1;
            let shown = if unique { short } else { name.clone() };
            labelled(&shown, subject.unit(name))
        });
        Labels {
            axes: axes.collect(),
        }
    }
}

/// A key as text, its unit in brackets.
pub fn labelled(key: &str, unit: &str) -> String {
    let (end, written) = match unit {
        "" => return key.replace('_', " "),
        unit => (unit_key(unit), format!(" ({unit})")),
    };
    key.replacen(&end, "", 1).replace('_', " ") + &written
}

/// How a unit is written in a key.
fn unit_key(unit: &str) -> String {
    let key = unit
        .replace("1/", "per_")
        .replace('/', "_")
        .replace("N m", "nm");
    format!("_{}", key.replace('^', "").replace(' ', "_"))
}

/// The value that a curve shows: of a model, only what is proved counts.
pub fn shown(subject: &Subject, outcome: &PointOutcome, metric: &str) -> Option<f64> {
    let counts = subject.kind() == Kind::Scenario || outcome.good();
    outcome.metric(metric).filter(|_| counts)
}

/// The metrics that differ between points, and those that do not.
pub fn metrics(subject: &Subject, outcomes: &[PointOutcome]) -> (Vec<String>, Vec<String>) {
    let names = match subject.kind() {
        Kind::Model => MODEL_METRICS.map(str::to_string).to_vec(),
        _ => metric_names(outcomes),
    };
    let values = |name: &str| {
        let values = outcomes.iter();
        values
            .filter_map(|outcome| shown(subject, outcome, name))
            .collect::<Vec<_>>()
    };
    let known = names.into_iter().filter(|name| !values(name).is_empty());
    known.partition(|name| {
        let values = values(name);
        subject.kind() == Kind::Model || values.iter().any(|value| *value != values[0])
    })
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

/// Gamma against the certified angle, with the front.
pub fn trade_off(outcomes: &[PointOutcome], front: &[usize]) -> Option<Plot> {
    let at = |outcome: &PointOutcome| {
        Some((
            outcome.metric("certified_angle_deg")?,
            outcome.metric("gamma")?,
        ))
    };
    let proved = outcomes.iter().filter(|outcome| outcome.good());
    let series = |name: &str, colour, mark, points: Vec<(f64, f64)>| Series {
        name: name.to_string(),
        colour,
        mark,
        points,
    };
    let on_front = front.iter().filter_map(|&index| at(&outcomes[index]));
    let on_front: Vec<(f64, f64)> = on_front.collect();
    (!on_front.is_empty()).then(|| Plot {
        title: "gamma against certified angle".to_string(),
        horizontal: "certified angle at rest (deg)".to_string(),
        vertical: "gamma".to_string(),
        series: vec![
            series(
                "proved",
                FAINT,
                Marker::Dots,
                proved.filter_map(at).collect(),
            ),
            series("Pareto front", COLOURS[0], Marker::Steps, on_front),
        ],
    })
}

/// A metric against an axis: one curve for each choice of the other axes, as many as can be told apart.
pub fn curve(
    subject: &Subject,
    grid: &Grid,
    outcomes: &[PointOutcome],
    metric: &str,
    axis: usize,
    labels: &Labels,
) -> Plot {
    let groups = groups(grid, axis);
    let chosen = evenly(groups.len(), CURVES);
    let mut series = Vec::new();
    let mut without = Vec::new();
    for (&group, colour) in chosen.iter().zip(COLOURS) {
        let mut name = group_name(grid, &groups[group], axis, labels);
        let mut run: Vec<(f64, f64)> = Vec::new();
        let mut close = |run: &mut Vec<(f64, f64)>, name: &mut String| {
            if !run.is_empty() {
                series.push(Series {
                    name: std::mem::take(name),
                    colour,
                    mark: Marker::Joined,
                    points: std::mem::take(run),
                });
            }
        };
        for &point in &sorted(grid, &groups[group], axis) {
            let at = grid.point(point)[axis];
            match shown(subject, &outcomes[point], metric) {
                Some(value) => run.push((at, value)),
                None => {
                    without.push((at, 0.0));
                    close(&mut run, &mut name);
                }
            }
        }
        close(&mut run, &mut name);
    }
    if !without.is_empty() {
        series.push(Series {
            name: "no value".to_string(),
            colour: INK,
            mark: Marker::Crosses,
            points: without,
        });
    }
    let vertical = labelled(metric, subject.unit(metric));
    let note = match chosen.len() < groups.len() {
        true => format!(" ({} of {} curves)", chosen.len(), groups.len()),
        false => String::new(),
    };
    Plot {
        title: format!("{vertical} against {}{note}", labels.axes[axis]),
        horizontal: labels.axes[axis].clone(),
        vertical,
        series,
    }
}

/// The points of the grid that differ in one axis only, for every choice of the others.
fn groups(grid: &Grid, axis: usize) -> Vec<Vec<usize>> {
    let sizes: Vec<usize> = grid.axes().map(|(_, values)| values.len()).collect();
    let stride: usize = sizes[axis + 1..].iter().product();
    let starts = (0..grid.points()).filter(|point| (point / stride) % sizes[axis] == 0);
    starts
        .map(|start| (0..sizes[axis]).map(|step| start + step * stride).collect())
        .collect()
}

/// The points in the order of the axis's values.
fn sorted(grid: &Grid, points: &[usize], axis: usize) -> Vec<usize> {
    let mut points = points.to_vec();
    points.sort_by(|&a, &b| grid.point(a)[axis].total_cmp(&grid.point(b)[axis]));
    points
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

/// The values that the other axes have.
fn group_name(grid: &Grid, group: &[usize], axis: usize, labels: &Labels) -> String {
    let values = grid.point(group[0]);
    let others = values
        .iter()
        .enumerate()
        .filter(|(other, _)| *other != axis);
    let names = others.map(|(other, value)| format!("{} {}", labels.axes[other], label(*value)));
    names.collect::<Vec<_>>().join(", ")
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
            worst_condition: None,
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
