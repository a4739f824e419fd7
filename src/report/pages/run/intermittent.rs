//! Figures of a controller that keeps its error in a funnel and its actuators off most of the time: those
//! of Lei et al. 2022, Figures 2 to 6.

use crate::base::table::Table;
use crate::report::figure::Figure;
use crate::report::series::Line;
use crate::run::summary::Summary;
use crate::sim::metrics::Metric;

/// The figures that the trajectory's columns allow; none for another controller.
pub fn figures(summary: &Summary, trajectory: &Table) -> Vec<Figure> {
    let columns = FunnelFigures::new(summary, trajectory);
    let Some(columns) = columns else {
        return Vec::new();
    };
    let mut out: Vec<Figure> = (1..=3).filter_map(|axis| columns.funnel(axis)).collect();
    if out.is_empty() {
        return out;
    }
    out.push(columns.magnitudes());
    out.push(columns.rate_norm());
    out.extend((1..=3).filter_map(|axis| columns.torque(axis)));
    out.extend(columns.raster());
    out.extend(columns.energy());
    out
}

struct FunnelFigures<'a> {
    summary: &'a Summary,
    trajectory: &'a Table,
    times: Vec<f64>,
}

impl<'a> FunnelFigures<'a> {
    fn new(summary: &'a Summary, trajectory: &'a Table) -> Option<Self> {
        Some(Self {
            summary,
            trajectory,
            times: trajectory.column("time_s")?,
        })
    }

    fn line(&self, name: &str, values: &[f64]) -> Line {
        Line::connected(name, &self.times, values)
    }

    fn figure(&self, title: &str, label: &str, lines: Vec<Line>) -> Figure {
        Figure {
            title: title.to_string(),
            label: label.to_string(),
            lines,
            end_s: self.summary.scales.duration_s,
            ..Figure::default()
        }
    }

    /// The paper's Figure 2, axis by axis.
    fn funnel(&self, axis: usize) -> Option<Figure> {
        let width = self.trajectory.column(&format!("funnel_{axis}"))?;
        let error = self.trajectory.column(&format!("error_q{axis}"))?;
        let below: Vec<f64> = width.iter().map(|width| -width).collect();
        let lines = vec![
            self.line(&format!("q{axis}"), &error),
            self.line("funnel, above", &width),
            self.line("funnel, below", &below),
        ];
        let title = format!("Component {axis} of the error in its funnel");
        Some(self.figure(&title, "component", lines))
    }

    /// What the paper's Figure 2 magnifies.
    fn magnitudes(&self) -> Figure {
        let lines = (1..=3).filter_map(|axis| {
            let values = self.trajectory.column(&format!("error_q{axis}"))?;
            let values: Vec<f64> = values.iter().map(|value| value.abs()).collect();
            Some(self.line(&format!("|q{axis}|"), &values))
        });
        let tolerance = self.summary.scales.settle_tolerance_component;
        let figure = self.figure(
            "Components of the error and settling tolerance",
            "magnitude",
            lines.collect(),
        );
        Figure {
            logarithmic: true,
            limits: tolerance.into_iter().collect(),
            ..figure
        }
    }

    /// The paper's Figure 4, with the limit that the scenario requires.
    fn rate_norm(&self) -> Figure {
        let rates: Vec<Vec<f64>> = (1..=3)
            .filter_map(|axis| self.trajectory.column(&format!("rate_{axis}_rad_s")))
            .collect();
        let norm = |row: usize| {
            let squares = rates.iter().filter_map(|rate| rate.get(row));
            squares.map(|value| value * value).sum::<f64>().sqrt()
        };
        let norms: Vec<f64> = (0..self.times.len()).map(norm).collect();
        let name = format!("{} at most", Metric::MaxRate.key());
        let requirements = self.summary.requirements.iter();
        let limits = requirements.filter(|requirement| requirement.name == name);
        let figure = self.figure(
            "Norm of the body rate",
            "norm of the rate error (rad/s)",
            vec![self.line("norm", &norms)],
        );
        Figure {
            limits: limits.map(|requirement| requirement.limit).collect(),
            ..figure
        }
    }

    /// The paper's Figure 5: each component by itself.
    fn torque(&self, axis: usize) -> Option<Figure> {
        let torque = self.trajectory.column(&format!("torque_{axis}_nm"))?;
        let line = Line::held(&format!("axis {axis}"), &self.times, &torque);
        let limit = self.summary.scales.torque_limit.get(axis - 1)?;
        let title = format!("Torque about axis {axis}");
        Some(Figure {
            limits: vec![*limit, -limit],
            ..self.figure(&title, "torque (N m)", vec![line])
        })
    }

    fn raster(&self) -> Option<Figure> {
        let on = self.trajectory.column("on")?;
        let line = Line::held("actuators", &self.times, &on);
        Some(self.figure("Actuators on (1) and off (0)", "on", vec![line]))
    }

    /// The paper's Figure 6.
    fn energy(&self) -> Option<Figure> {
        let energy = self.trajectory.column("rate_error_v2_j")?;
        let envelope = self.trajectory.column("envelope_s2_j")?;
        let lines = vec![
            self.line("V2", &energy),
            self.line("envelope S2", &envelope),
        ];
        Some(Figure {
            logarithmic: true,
            ..self.figure(
                "V2 and its envelope S2",
                "energy of the rate error (J)",
                lines,
            )
        })
    }
}
