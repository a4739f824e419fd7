//! The figures of a run: those that its trajectory's columns allow.

use crate::base::table::Table;
use crate::plants::SystemKind;
use crate::report::chart::Figure;
use crate::report::series::{Mark, Series};
use crate::run::summary::Summary;
use crate::sim::metrics::Metric;

/// A run's trajectory, to be drawn over time.
struct RunFigures<'a> {
    summary: &'a Summary,
    trajectory: &'a Table,
    times: Vec<f64>,
}

/// The figures, without those that would be empty.
pub(super) fn figures(summary: &Summary, trajectory: &Table) -> Vec<Figure> {
    let Some(times) = trajectory.column("time_s") else {
        return Vec::new();
    };
    let run = RunFigures {
        summary,
        trajectory,
        times,
    };
    let mut out = match summary.system {
        SystemKind::RigidBody => [run.attitude(), run.intermittent()].concat(),
        _ => run.states(),
    };
    out.extend(run.prescribed());
    out.extend(run.messages());
    out.extend(run.certificates());
    out.retain(|figure| !figure.series.is_empty());
    out
}

impl RunFigures<'_> {
    fn figure(&self, title: impl Into<String>, label: &str, series: Vec<Series>) -> Figure {
        Figure::over_time(title, label, self.summary.scales.duration_s, series)
    }

    /// Columns with their names, connected or held.
    fn lines<C, N>(&self, columns: impl IntoIterator<Item = (C, N)>, held: bool) -> Vec<Series>
    where
        C: AsRef<str>,
        N: AsRef<str>,
    {
        let draw = if held {
            Series::held
        } else {
            Series::connected
        };
        let lines = columns.into_iter().filter_map(|(column, name)| {
            let values = self.trajectory.column(column.as_ref())?;
            Some(draw(name.as_ref(), &self.times, &values))
        });
        lines.collect()
    }

    /// The columns of three axes; `#` in the name stands for an axis.
    fn axes(&self, column: &str, held: bool) -> Vec<Series> {
        let named = [1, 2, 3].map(|axis| (of_axis(column, axis), format!("axis {axis}")));
        self.lines(named, held)
    }

    /// The torque limits of all axes, each once in both directions.
    fn torque_limits(&self) -> Vec<f64> {
        let limits = self.summary.scales.torque_limit.iter();
        let mut limits: Vec<f64> = limits.flat_map(|&limit| [-limit, limit]).collect();
        limits.sort_by(f64::total_cmp);
        limits.dedup();
        limits
    }

    fn attitude(&self) -> Vec<Figure> {
        let quaternion = [
            ("error_q0_scalar", "q0 (scalar)"),
            ("error_q1", "q1"),
            ("error_q2", "q2"),
            ("error_q3", "q3"),
        ];
        let scales = &self.summary.scales;
        // A tolerance on the components is drawn with them.
        let (title, tolerance) = match scales.settle_tolerance_component {
            Some(_) => ("Attitude error", None),
            None => (
                "Attitude error and settling tolerance",
                Some(scales.settle_tolerance),
            ),
        };
        let (quaternion, rates) = (
            self.lines(quaternion, false),
            self.axes("rate_#_rad_s", false),
        );
        let error = self.lines([("error_deg", "")], false);
        let torques = self.axes("torque_#_nm", true);
        vec![
            self.figure("Error quaternion", "component", quaternion),
            self.figure("Body rate", "rate error (rad/s)", rates),
            self.figure("Torque", "torque (N m)", torques)
                .limits(self.torque_limits()),
            self.figure(title, "error (deg)", error)
                .logarithmic()
                .limits(tolerance),
        ]
    }

    /// State and input of a plant that is no rigid body.
    fn states(&self) -> Vec<Figure> {
        let lines = |prefix: &str, held: bool| {
            let columns = self.trajectory.columns.iter();
            let numbered = columns.filter_map(|column| {
                let number: usize = column.strip_prefix(prefix)?.parse().ok()?;
                Some((column, number.to_string()))
            });
            self.lines(numbered, held)
        };
        vec![
            self.figure("State", "state", lines("state_", false)),
            self.figure("Input", "input", lines("input_", true)),
        ]
    }

    /// Of a controller that keeps its error in a funnel and its actuators off most of the time: Figures 2 to 6 of
    /// Lei et al. 2022; none for another controller.
    fn intermittent(&self) -> Vec<Figure> {
        let mut out: Vec<Figure> = (1..=3).filter_map(|axis| self.funnel(axis)).collect();
        if out.is_empty() {
            return out;
        }
        // What the paper's Figure 2 magnifies.
        let magnitudes = (1..=3).filter_map(|axis| {
            let values = self.trajectory.column(&of_axis("error_q#", axis))?;
            let values: Vec<f64> = values.iter().map(|value| value.abs()).collect();
            let name = format!("|q{axis}|");
            Some(Series::connected(&name, &self.times, &values))
        });
        let title = "Components of the error and settling tolerance";
        let magnitudes = self.figure(title, "magnitude", magnitudes.collect());
        let tolerance = self.summary.scales.settle_tolerance_component;
        out.push(magnitudes.logarithmic().limits(tolerance));
        out.push(self.rate_norm());
        // The paper's Figure 5: each component by itself.
        let torques = self.axes("torque_#_nm", true);
        let limits = &self.summary.scales.torque_limit;
        for (axis, (mut torque, limit)) in torques.into_iter().zip(limits).enumerate() {
            torque.name.clear();
            let title = format!("Torque about axis {}", axis + 1);
            let figure = self.figure(title, "torque (N m)", vec![torque]);
            out.push(figure.limits([*limit, -limit]));
        }
        let on = self.lines([("on", "")], true);
        out.push(self.figure("Actuators on (1) and off (0)", "on", on));
        // The paper's Figure 6.
        let energies = [("rate_error_v2_j", "V2"), ("envelope_s2_j", "envelope S2")];
        let (title, label) = ("V2 and its envelope S2", "energy of the rate error (J)");
        let energies = self.figure(title, label, self.lines(energies, false));
        out.extend(Some(energies.logarithmic()).filter(|figure| figure.series.len() == 2));
        out
    }

    /// The paper's Figure 2, axis by axis.
    fn funnel(&self, axis: usize) -> Option<Figure> {
        let width = self.trajectory.column(&of_axis("funnel_#", axis))?;
        let error = self.trajectory.column(&of_axis("error_q#", axis))?;
        let below: Vec<f64> = width.iter().map(|width| -width).collect();
        let line = |name: &str, values: &[f64]| Series::connected(name, &self.times, values);
        let lines = vec![
            line(&of_axis("q#", axis), &error),
            line("funnel, above", &width),
            line("funnel, below", &below),
        ];
        let title = format!("Component {axis} of the error in its funnel");
        Some(self.figure(title, "component", lines))
    }

    /// The paper's Figure 4, with the limit that the scenario requires.
    fn rate_norm(&self) -> Figure {
        let rates: Vec<Vec<f64>> = (1..=3)
            .filter_map(|axis| self.trajectory.column(&of_axis("rate_#_rad_s", axis)))
            .collect();
        let norm = |row: usize| {
            let squares = rates.iter().filter_map(|rate| rate.get(row));
            squares.map(|value| value * value).sum::<f64>().sqrt()
        };
        let norms: Vec<f64> = (0..self.times.len()).map(norm).collect();
        let name = format!("{} at most", Metric::MaxRate.key());
        let requirements = self.summary.requirements.iter();
        let limits = requirements.filter(|requirement| requirement.name == name);
        let norms = vec![Series::connected("", &self.times, &norms)];
        let label = "norm of the rate error (rad/s)";
        self.figure("Norm of the body rate", label, norms)
            .limits(limits.map(|requirement| requirement.limit))
    }

    /// Of a controller with prescribed bounds on its error, an estimated fault or a link.
    fn prescribed(&self) -> Vec<Figure> {
        let envelopes = (1..=3).map(|axis| {
            let columns =
                ["error", "lower", "upper"].map(|which| format!("envelope_{which}_{axis}"));
            let names = ["error", "lower bound", "upper bound"];
            let lines = self.lines(columns.into_iter().zip(names), false);
            let title = format!("Error q{axis} in its envelope");
            self.figure(title, "component", lines)
        });
        let envelopes = envelopes.filter(|figure| figure.series.len() == 3);
        let title = "Estimated fault against the torque limit";
        let faults = self.axes("fault_estimate_#_nm", false);
        let faults = self.figure(title, "torque (N m)", faults);
        let mut steps = self.axes("link_step_#", false);
        for (axis, line) in steps.iter_mut().enumerate() {
            let values = self.trajectory.column(&of_axis("link_step_#", axis + 1));
            let points = self.times.iter().copied().zip(values.unwrap_or_default());
            line.mark = Mark::Dots;
            line.points = points.filter(|&(_, value)| value != 0.0).collect();
        }
        let some = steps.iter().any(|line| !line.points.is_empty());
        let title = "Steps on the link: level, negative downwards";
        let steps = some.then(|| self.figure(title, "level", steps));
        let faults = faults.limits(self.torque_limits());
        envelopes.chain([faults]).chain(steps).collect()
    }

    fn messages(&self) -> Option<Figure> {
        let sent = self.trajectory.column("sent")?;
        let events = self.times.iter().zip(&sent);
        let events = events.filter(|(_, &sent)| sent > 0.5);
        let events: Vec<f64> = events.map(|(&time, _)| time).collect();
        let dots = vec![Series::intervals("", &events)];
        let label = "time since the last message (s)";
        let figure = self.figure("Inter-event times", label, dots);
        Some(figure.logarithmic())
    }

    fn certificates(&self) -> [Figure; 2] {
        let level = [("lyapunov", "x'Ux"), ("lyapunov_bound", "bound")];
        let inner = [
            ("inner_lyapunov", "x'Ux, inner"),
            ("inner_lyapunov_bound", "bound"),
        ];
        let [level, inner] = [level, inner].map(|columns| self.lines(columns, false));
        let title = "Lyapunov function against its bound";
        let inner_title = "Inner Lyapunov function against its bound";
        [
            self.figure(title, "x'Ux", level).logarithmic(),
            self.figure(inner_title, "x'Ux", inner)
                .logarithmic()
                .limits([1.0]),
        ]
    }
}

/// The name of a column with an axis in the place of `#`.
fn of_axis(column: &str, axis: usize) -> String {
    column.replace('#', &axis.to_string())
}
