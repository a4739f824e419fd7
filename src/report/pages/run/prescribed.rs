//! Figures of a run with prescribed bounds on its error, an estimated fault or a link.

use crate::base::table::Table;
use crate::report::figure::Figure;
use crate::report::series::{Line, Mark};
use crate::run::summary::Summary;

/// The figures that the trajectory's columns allow.
pub(crate) fn figures(summary: &Summary, trajectory: &Table, times: &[f64]) -> Vec<Figure> {
    let blank = |title: String, label: &str| Figure {
        title,
        label: label.to_string(),
        end_s: summary.scales.duration_s,
        ..Figure::default()
    };
    let connected = |column: &str, name: &str| {
        let values = trajectory.column(column)?;
        Some(Line::connected(name, times, &values))
    };
    let mut out = Vec::new();
    for axis in 1..=3 {
        let lines = [
            connected(&format!("envelope_error_{axis}"), "error"),
            connected(&format!("envelope_lower_{axis}"), "lower bound"),
            connected(&format!("envelope_upper_{axis}"), "upper bound"),
        ];
        if let [Some(error), Some(lower), Some(upper)] = lines {
            out.push(Figure {
                lines: vec![error, lower, upper],
                ..blank(format!("Error q{axis} in its envelope"), "component")
            });
        }
    }
    let faults = per_axis(|axis| {
        connected(
            &format!("fault_estimate_{axis}_nm"),
            &format!("axis {axis}"),
        )
    });
    if !faults.is_empty() {
        let limits = summary.scales.torque_limit.iter();
        let mut limits: Vec<f64> = limits.flat_map(|&limit| [-limit, limit]).collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        out.push(Figure {
            lines: faults,
            limits,
            ..blank(
                "Estimated fault against the torque limit".to_string(),
                "torque (N m)",
            )
        });
    }
    let steps = per_axis(|axis| {
        let steps = trajectory.column(&format!("link_step_{axis}"))?;
        Some(dots(&format!("axis {axis}"), times, &steps))
    });
    if steps.iter().any(|line| !line.points.is_empty()) {
        out.push(Figure {
            lines: steps,
            ..blank(
                "Steps on the link: level, negative downwards".to_string(),
                "level",
            )
        });
    }
    out
}

fn per_axis(line: impl Fn(u8) -> Option<Line>) -> Vec<Line> {
    (1..=3).filter_map(line).collect()
}

/// A dot for each value that is not zero.
fn dots(name: &str, times: &[f64], values: &[f64]) -> Line {
    let pairs = times.iter().copied().zip(values.iter().copied());
    Line {
        name: name.to_string(),
        points: pairs.filter(|&(_, value)| value != 0.0).collect(),
        mark: Mark::Dot,
    }
}
