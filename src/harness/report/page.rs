//! The page around the figures, verdict first.

use std::fmt::Write;

use super::figures::{Figure, FigureError};
use super::series::Line;
use crate::harness::link::LinkOutcome;
use crate::harness::recorder::Table;
use crate::harness::summary::{CertificateOutcome, RunVerdict, Summary};

const STYLE: &str = include_str!("page.css");

/// The page of a run.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn page(summary: &Summary, trajectory: &Table) -> Result<String, FigureError> {
    let mut body = String::new();
    header(summary, &mut body);
    metrics(summary, &mut body);
    requirements(summary, &mut body);
    if let Some(outcome) = &summary.link {
        link(outcome, &mut body);
    }
    if let Some(outcome) = &summary.certificate {
        certificate(outcome, &mut body);
    }
    notes(summary, &mut body);
    for figure in figures(summary, trajectory) {
        figure.write_section(&mut body)?;
    }
    provenance(summary, &mut body);
    let title = format!("{}: run report", summary.scenario);
    Ok(document(&title, &body))
}

/// A page around its body.
pub fn document(title: &str, body: &str) -> String {
    document_with_style(title, "", body)
}

/// A page around its body, with further lines of style.
pub fn document_with_style(title: &str, style: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<style>\n{STYLE}{style}</style>\n</head>\n<body>\n{body}</body>\n</html>\n",
        escape(title)
    )
}

impl Figure {
    /// Writes the figure with its title and legend.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn write_section(&self, body: &mut String) -> Result<(), FigureError> {
        let svg = self.to_svg()?;
        let title = escape(&self.title);
        put(body, format_args!("<section><h2>{title}</h2>\n"));
        legend(self, body);
        put(body, format_args!("{svg}</section>\n"));
        Ok(())
    }
}

/// Text for HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// Writing to a string cannot fail.
pub(super) fn put(body: &mut String, text: std::fmt::Arguments) {
    let _ = body.write_fmt(text);
}

fn header(summary: &Summary, body: &mut String) {
    let class = match summary.verdict {
        RunVerdict::RequirementsMet => "good",
        RunVerdict::RequirementsMissed => "bad",
        RunVerdict::Diverged | RunVerdict::ProofBroken => "alarm",
    };
    let proof = match &summary.certificate {
        Some(outcome) if outcome.broken() => "The proof was broken.",
        Some(outcome) if outcome.covers_run => {
            "The design is proved, the proof covers this run, and the run kept its bound."
        }
        Some(outcome) if outcome.proved => {
            "The design is proved; the proof does not cover this run."
        }
        Some(_) => "The design is NOT proved.",
        None => "Nothing is proved for this controller.",
    };
    let requirements = match (summary.verdict, summary.requirements.is_empty()) {
        (RunVerdict::RequirementsMet, true) => "The scenario states no requirement.",
        (verdict, _) => verdict.sentence(),
    };
    put(
        body,
        format_args!(
            "<header>\n<p class=\"verdict {class}\"><strong>{}</strong> {}</p>\n<h1>{}</h1>\n\
             <p>{}</p>\n<p class=\"source\">{}</p>\n</header>\n",
            escape(requirements),
            escape(proof),
            escape(&summary.scenario),
            escape(&summary.controller),
            escape(&summary.source)
        ),
    );
}

/// The head of a section and a table of names and values; the section stays open.
pub(super) fn numbers(title: &str, rows: &[(&str, String)], body: &mut String) {
    put(
        body,
        format_args!("<section><h2>{title}</h2>\n<table class=\"numbers\">\n"),
    );
    for (name, value) in rows {
        put(
            body,
            format_args!(
                "<tr><th>{}</th><td>{}</td></tr>\n",
                escape(name),
                escape(value)
            ),
        );
    }
    body.push_str("</table>\n");
}

fn metrics(summary: &Summary, body: &mut String) {
    let number = |value: Option<f64>| value.map_or("none".to_string(), short);
    let mut rows: Vec<(&str, String)> = vec![
        ("Messages", summary.triggers.to_string()),
        ("Samples", summary.samples.to_string()),
        ("Bytes sent", summary.bytes.to_string()),
        ("Torque updates", summary.updates.to_string()),
        (
            "Shortest time between messages (s)",
            number(summary.shortest_interval_s),
        ),
        (
            "Mean time between messages (s)",
            number(summary.mean_interval_s),
        ),
        ("Settled from (s)", number(summary.settle_seconds)),
    ];
    if summary.system == "rigid_body" {
        rows.push(("Final error (deg)", number(summary.final_error_deg)));
        rows.push((
            "Rms error over the tail (deg)",
            number(summary.rms_error_deg),
        ));
        rows.push(("Largest rate (rad/s)", number(summary.max_rate)));
        rows.push(("Largest torque (N m)", short(summary.max_torque)));
        rows.push(("Impulse (N m s)", short(summary.impulse)));
    } else {
        rows.push(("Norm of the final state", number(summary.final_state_norm)));
        rows.push(("Rms norm over the tail", number(summary.rms_state_norm)));
        rows.push(("Largest input", short(summary.max_torque)));
        rows.push(("Integral of the input's magnitude", short(summary.impulse)));
    }
    rows.extend(bound_rows(summary));
    if summary.held_samples > 0 {
        let reason = summary.first_hold.as_deref().unwrap_or("unknown");
        rows.push((
            "Samples not used",
            format!("{} ({reason})", summary.held_samples),
        ));
    }
    if let Some(mismatch) = summary.largest_membership_mismatch {
        rows.push(("Largest membership mismatch", short(mismatch)));
    }
    numbers("Numbers", &rows, body);
    body.push_str("</section>\n");
}

fn link(outcome: &LinkOutcome, body: &mut String) {
    let seconds = |value: Option<f64>| value.map_or("none".to_string(), short);
    let rows = [
        ("Encoding", outcome.encoding.clone()),
        ("Messages", outcome.messages.to_string()),
        ("Words", outcome.words.to_string()),
        ("Bits sent", outcome.bits.to_string()),
        ("Bytes sent", outcome.bytes.to_string()),
        (
            "Resynchronisation words",
            outcome.resynchronisation_words.to_string(),
        ),
        ("Words lost", outcome.lost_words.to_string()),
        ("Words corrupted", outcome.corrupted_words.to_string()),
        ("Words refused", outcome.refused_words.to_string()),
        (
            "Shortest time between messages (s)",
            seconds(outcome.shortest_interval_s),
        ),
        (
            "Longest disagreement of the two ends (s)",
            short(outcome.longest_disagreement_s),
        ),
    ];
    numbers("Link to the actuators", &rows, body);
    body.push_str("</section>\n");
}

/// Switching and prescribed bounds, for the controllers that have them.
fn bound_rows(summary: &Summary) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    if let (Some(on), Some(off)) = (summary.turn_ons, summary.turn_offs) {
        rows.push(("Turned on; off", format!("{on}; {off}")));
        let share = short(100.0 * summary.on_time_share);
        rows.push(("Time with a torque (%)", share));
    }
    let usages = [
        ("Largest error over its prescribed bound", &summary.funnel),
        ("Largest trigger over its threshold", &summary.threshold),
    ];
    for (name, usage) in usages {
        if let Some(usage) = usage {
            let ratio = format!(
                "{:.6} at {} s",
                usage.largest_ratio,
                short(usage.largest_ratio_at_s)
            );
            rows.push((name, ratio));
        }
    }
    rows
}

fn requirements(summary: &Summary, body: &mut String) {
    if summary.requirements.is_empty() {
        return;
    }
    body.push_str(
        "<section><h2>Requirements</h2>\n<table>\n\
         <tr><th>Requirement</th><th>Limit</th><th>Value</th><th></th></tr>\n",
    );
    for requirement in &summary.requirements {
        let (class, word) = if requirement.met {
            ("good", "met")
        } else {
            ("bad", "missed")
        };
        let value = requirement.value.map_or("none".to_string(), short);
        put(
            body,
            format_args!(
                "<tr><td>{}</td><td>{}</td><td>{value}</td><td class=\"{class}\">{word}</td></tr>\n",
                escape(&requirement.name),
                short(requirement.limit)
            ),
        );
    }
    body.push_str("</table></section>\n");
}

fn certificate(outcome: &CertificateOutcome, body: &mut String) {
    let yes = |value: bool| if value { "yes" } else { "NO" }.to_string();
    let never =
        |time: Option<f64>| time.map_or("never".to_string(), |t| format!("at {} s", short(t)));
    let mut rows: Vec<(&str, String)> = vec![
        ("Design proved from its numbers", yes(outcome.proved)),
        ("Proof covers this run", yes(outcome.covers_run)),
        (
            "x'Ux at the start (certified set: at most 1)",
            short(outcome.start_level),
        ),
        (
            "Largest x'Ux over its bound",
            format!(
                "{:.6} at {} s",
                outcome.largest_lyapunov_ratio,
                short(outcome.largest_lyapunov_ratio_at_s)
            ),
        ),
        (
            "Steps above the bound",
            outcome.bound_broken_steps.to_string(),
        ),
        (
            "Left the invariant set",
            never(outcome.left_invariant_set_s),
        ),
        ("Left the box of the model", never(outcome.left_box_s)),
        ("Largest output", short(outcome.peak_output)),
        ("Largest disturbance", short(outcome.peak_disturbance)),
        (
            "Guaranteed gain; gamma",
            format!(
                "{}; {}",
                short(outcome.guaranteed_gain),
                short(outcome.gamma)
            ),
        ),
    ];
    if let (Some(margin), Some(name)) = (outcome.worst_margin, &outcome.worst_condition) {
        rows.push(("Smallest margin", format!("{margin:.3e} ({name})")));
    }
    if let Some(ratio) = outcome.peak_ratio {
        let from = if outcome.from_rest_in_origin {
            short(ratio)
        } else {
            format!(
                "{} (no test of the gain: the run does not start in the origin)",
                short(ratio)
            )
        };
        rows.push(("Largest output over largest disturbance", from));
    }
    rows.extend(super::inner::rows(outcome));
    numbers("Certificate", &rows, body);
    if !outcome.not_covered.is_empty() {
        body.push_str("<p>The proof does not cover this run because of:</p>\n<ul>\n");
        for reason in &outcome.not_covered {
            put(body, format_args!("<li>{}</li>\n", escape(reason)));
        }
        body.push_str("</ul>\n");
    }
    body.push_str("</section>\n");
}

fn legend(figure: &Figure, body: &mut String) {
    let lines = figure.legend();
    if lines.is_empty() {
        return;
    }
    body.push_str("<p class=\"legend\">");
    for (name, colour) in lines {
        put(
            body,
            format_args!(
                "<span style=\"border-color: {colour}\">{}</span>",
                escape(name)
            ),
        );
    }
    body.push_str("</p>\n");
}

fn notes(summary: &Summary, body: &mut String) {
    if summary.notes.is_empty() {
        return;
    }
    body.push_str("<section><h2>Notes</h2>\n<ul>\n");
    for note in &summary.notes {
        put(body, format_args!("<li>{}</li>\n", escape(note)));
    }
    body.push_str("</ul></section>\n");
}

fn provenance(summary: &Summary, body: &mut String) {
    let made = &summary.provenance;
    let design = made.design_sha256.as_deref().unwrap_or("none");
    put(
        body,
        format_args!(
            "<footer>\n<p>{}; {}; random numbers: {} with seed {}</p>\n\
             <p>scenario SHA-256 {}<br>design SHA-256 {}</p>\n</footer>\n",
            escape(&made.generator),
            escape(&made.integrator),
            escape(&made.random_generator),
            made.seed,
            escape(&made.scenario_sha256),
            escape(design)
        ),
    );
}

/// Five significant digits.
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let exponent = value.abs().log10().floor();
    if !(-4.0..6.0).contains(&exponent) {
        return format!("{value:.4e}");
    }
    let digits = (4.0 - exponent).clamp(0.0, 9.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        return text.trim_end_matches('0').trim_end_matches('.').to_string();
    }
    text
}

/// Lines of (column, name) pairs; held values when asked for.
type Collect<'a> = dyn Fn(&[(&str, &str)], bool) -> Vec<Line> + 'a;
/// A figure with a title, a label and lines.
type Draw<'a> = dyn Fn(&str, &str, Vec<Line>) -> Figure + 'a;

/// The figures that the trajectory's columns allow.
fn figures(summary: &Summary, trajectory: &Table) -> Vec<Figure> {
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
    if summary.system == "rigid_body" {
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

fn attitude_figures(summary: &Summary, collect: &Collect, figure: &Draw) -> Vec<Figure> {
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

fn state_figures(trajectory: &Table, collect: &Collect, figure: &Draw) -> Vec<Figure> {
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
