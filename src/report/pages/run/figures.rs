//! The figures of a run.

use crate::base::table::Table;
use crate::plants::SystemKind;
use crate::report::figure::Figure;
use crate::report::series::Line;
use crate::run::summary::Summary;

/// Lines of (column, name) pairs; held values when requested.
type MakeLines<'a> = dyn Fn(&[(&str, &str)], bool) -> Vec<Line> + 'a;
/// A figure with a title, a label and lines.
type MakeFigure<'a> = dyn Fn(&str, &str, Vec<Line>) -> Figure + 'a;

/// The figures that the trajectory's columns allow.
pub(crate) fn figures(summary: &Summary, trajectory: &Table) -> Vec<Figure> {
    let Some(times) = trajectory.column("time_s") else {
        return Vec::new();
    };
    let collect = |columns: &[(&str, &str)], held: bool| -> Vec<Line> {
        let lines = columns.iter().filter_map(|(column, name)| {
            let values = trajectory.column(column)?;
            Some(if held {
                Line::held(name, &times, &values)
            } else {
                Line::connected(name, &times, &values)
            })
        });
        lines.collect()
    };
    let figure = |title: &str, label: &str, lines: Vec<Line>| Figure {
        title: title.to_string(),
        label: label.to_string(),
        lines,
        end_s: summary.scales.duration_s,
        ..Figure::default()
    };
    let mut out = Vec::new();
    if summary.system == SystemKind::RigidBody {
        out.extend(attitude_figures(summary, &collect, &figure));
        out.extend(super::intermittent::figures(summary, trajectory));
    } else {
        out.extend(state_figures(trajectory, &collect, &figure));
    }
    out.extend(super::prescribed::figures(summary, trajectory, &times));
    if let Some(sent) = trajectory.column("sent") {
        let events = times.iter().zip(&sent).filter(|(_, &sent)| sent > 0.5);
        let events: Vec<f64> = events.map(|(&time, _)| time).collect();
        let dots = Line::intervals("time since the last message", &events);
        out.push(Figure {
            logarithmic: true,
            ..figure(
                "Inter-event times",
                "time since the last message (s)",
                vec![dots],
            )
        });
    }
    let level = collect(&[("lyapunov", "x'Ux"), ("lyapunov_bound", "bound")], false);
    if !level.is_empty() {
        out.push(Figure {
            logarithmic: true,
            ..figure("Lyapunov function against its bound", "x'Ux", level)
        });
    }
    let columns = [
        ("inner_lyapunov", "x'Ux, inner"),
        ("inner_lyapunov_bound", "bound"),
    ];
    let inner = collect(&columns, false);
    if !inner.is_empty() {
        out.push(Figure {
            logarithmic: true,
            limits: vec![1.0],
            ..figure("Inner Lyapunov function against its bound", "x'Ux", inner)
        });
    }
    out
}

fn attitude_figures(summary: &Summary, collect: &MakeLines, figure: &MakeFigure) -> Vec<Figure> {
    let quaternion = [
        ("error_q0_scalar", "q0 (scalar)"),
        ("error_q1", "q1"),
        ("error_q2", "q2"),
        ("error_q3", "q3"),
    ];
    let rates = [
        ("rate_1_rad_s", "axis 1"),
        ("rate_2_rad_s", "axis 2"),
        ("rate_3_rad_s", "axis 3"),
    ];
    let torques = [
        ("torque_1_nm", "axis 1"),
        ("torque_2_nm", "axis 2"),
        ("torque_3_nm", "axis 3"),
    ];
    let mut limits: Vec<f64> = summary.scales.torque_limit.clone();
    limits.extend(summary.scales.torque_limit.iter().map(|limit| -limit));
    limits.sort_by(f64::total_cmp);
    limits.dedup();
    let error = collect(&[("error_deg", "attitude error")], false);
    // A tolerance on the components is drawn with them.
    let (title, tolerance) = match summary.scales.settle_tolerance_component {
        Some(_) => ("Attitude error", None),
        None => (
            "Attitude error and settling tolerance",
            Some(summary.scales.settle_tolerance),
        ),
    };
    vec![
        figure("Error quaternion", "component", collect(&quaternion, false)),
        figure("Body rate", "rate error (rad/s)", collect(&rates, false)),
        Figure {
            limits,
            ..figure("Torque", "torque (N m)", collect(&torques, true))
        },
        Figure {
            logarithmic: true,
            limits: tolerance.into_iter().collect(),
            ..figure(title, "error (deg)", error)
        },
    ]
}

fn state_figures(trajectory: &Table, collect: &MakeLines, figure: &MakeFigure) -> Vec<Figure> {
    let named = |prefix: &str| -> Vec<(String, String)> {
        let columns = trajectory.columns.iter();
        let columns = columns.filter_map(|column| {
            let number: usize = column.strip_prefix(prefix)?.parse().ok()?;
            Some((column.clone(), number.to_string()))
        });
        columns.collect()
    };
    let borrowed = |pairs: &[(String, String)], held: bool| {
        let pairs: Vec<_> = pairs
            .iter()
            .map(|(a, b)| (a.as_str(), b.as_str()))
            .collect();
        collect(&pairs, held)
    };
    vec![
        figure("State", "state", borrowed(&named("state_"), false)),
        figure("Input", "input", borrowed(&named("input_"), true)),
    ]
}
