//! The page of a comparison: one HTML file with its figures inside.

use std::fmt::Write;

use crate::batch::comparison::{Comparison, Curves, Row};
use crate::batch::verdict::verdict_name;
use crate::report::figure::{Figure, FigureError};
use crate::report::html::{document, escape};
use crate::report::series::Line;
use crate::run::summary::RunVerdict;
use crate::scenario::RequirementFile;
use crate::sim::metrics::metric_name;

/// A line of the page's table: its name and its value for a controller.
type MetricLine = (&'static str, fn(&Row) -> String);

const METRICS: [MetricLine; 16] = [
    ("Settled from (s)", |row| number(row.settle_seconds)),
    ("Final error (deg)", |row| number(row.final_error_deg)),
    ("Rms error over the tail (deg)", |row| {
        number(row.rms_error_deg)
    }),
    ("Largest rate (rad/s)", |row| number(row.max_rate)),
    ("Largest torque (N m)", |row| number(Some(row.max_torque))),
    ("Impulse (N m s)", |row| number(Some(row.impulse))),
    ("Torque updates", |row| row.updates.to_string()),
    ("Messages", |row| row.triggers.to_string()),
    ("Bits sent", |row| row.bits.to_string()),
    ("Bytes sent", |row| row.bytes.to_string()),
    ("Shortest time between messages (s)", |row| {
        number(row.shortest_interval_s)
    }),
    ("Mean time between messages (s)", |row| {
        number(row.mean_interval_s)
    }),
    ("Bytes on the link to the actuators", |row| {
        row.link
            .as_ref()
            .map_or("no link".to_string(), |link| link.bytes.to_string())
    }),
    ("Largest share of prescribed bounds", |row| {
        number(row.funnel_ratio)
    }),
    ("Sampling", |row| row.sampling.clone()),
    ("Proof", |row| {
        row.proof.clone().unwrap_or("none".to_string())
    }),
];

/// The page.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn page(comparison: &Comparison, curves: &[Curves]) -> Result<String, FigureError> {
    let mut body = String::new();
    header(comparison, &mut body);
    metrics(comparison, &mut body);
    faults(comparison, &mut body);
    notes(comparison, &mut body);
    for figure in figures(comparison, curves) {
        figure.write_section(&mut body)?;
    }
    provenance(comparison, &mut body);
    Ok(document("Comparison of controllers", &body))
}

fn number(value: Option<f64>) -> String {
    value.map_or("none".to_string(), crate::base::number::short)
}

/// Writing to a string cannot fail.
fn put(body: &mut String, text: std::fmt::Arguments) {
    let _ = body.write_fmt(text);
}

fn header(comparison: &Comparison, body: &mut String) {
    let broken = |row: &&Row| row.verdict == RunVerdict::ProofBroken;
    let met = |row: &&Row| row.verdict == RunVerdict::RequirementsMet;
    let total = comparison.runs.len();
    let (class, sentence) = if let Some(row) = comparison.runs.iter().find(broken) {
        let sentence = format!("{}: {}", row.label, row.verdict.sentence());
        ("alarm", sentence)
    } else if comparison.task.requirements.is_empty() {
        ("good", "The task states no requirement.".to_string())
    } else {
        let met = comparison.runs.iter().filter(met).count();
        let class = if met == total { "good" } else { "bad" };
        (
            class,
            format!("{met} of {total} controllers meet every requirement."),
        )
    };
    let task = &comparison.task;
    let [a, b, c] = task.torque_limit_nm;
    put(
        body,
        format_args!(
            "<header>\n<p class=\"verdict {class}\"><strong>{}</strong></p>\n\
             <h1>Comparison of controllers</h1>\n<p>Runs of {} s; torque that can act: {a}, {b} and {c} \
             N m; settled: error of at most {} deg; tail: the last {} s.</p>\n",
            escape(&sentence),
            task.duration_s,
            task.settle_tolerance_deg,
            task.tail_s,
        ),
    );
    if let Some(file) = &task.taken_from {
        let file = escape(file);
        put(body, format_args!("<p>Spacecraft, start, disturbance, limits and requirements of {file} for all.</p>\n"));
    }
    if !task.requirements.is_empty() {
        let required: Vec<String> = task.requirements.iter().map(requirement).collect();
        let required = escape(&required.join("; "));
        put(body, format_args!("<p>Required: {required}.</p>\n"));
    }
    body.push_str("</header>\n");
}

fn requirement(requirement: &RequirementFile) -> String {
    let name = metric_name(requirement.metric);
    match (requirement.at_most, requirement.at_least) {
        (Some(limit), _) => format!("{name} at most {limit}"),
        (None, Some(limit)) => format!("{name} at least {limit}"),
        (None, None) => name,
    }
}

fn heads(comparison: &Comparison, first: &str, body: &mut String) {
    put(
        body,
        format_args!("<table>\n<tr><th>{}</th>", escape(first)),
    );
    for row in &comparison.runs {
        put(body, format_args!("<th>{}</th>", escape(&row.label)));
    }
    body.push_str("</tr>\n");
}

fn metrics(comparison: &Comparison, body: &mut String) {
    body.push_str("<section><h2>Without a standard fault</h2>\n");
    heads(comparison, "", body);
    body.push_str("<tr><td>Requirements</td>");
    for row in &comparison.runs {
        let class = match row.verdict {
            RunVerdict::RequirementsMet => "good",
            _ => "bad",
        };
        let word = verdict_name(row.verdict).replace('_', " ");
        put(body, format_args!("<td class=\"{class}\">{word}</td>"));
    }
    body.push_str("</tr>\n");
    for (name, value) in METRICS {
        put(body, format_args!("<tr><td>{}</td>", escape(name)));
        for row in &comparison.runs {
            put(body, format_args!("<td>{}</td>", escape(&value(row))));
        }
        body.push_str("</tr>\n");
    }
    body.push_str("</table></section>\n");
}

fn faults(comparison: &Comparison, body: &mut String) {
    if comparison.faults.is_empty() {
        return;
    }
    body.push_str("<section><h2>Standard faults</h2>\n");
    heads(comparison, "Fault", body);
    for (index, (name, description)) in comparison.faults.iter().enumerate() {
        let name = escape(&name.replace('_', " "));
        let description = escape(description);
        put(
            body,
            format_args!("<tr><td><strong>{name}</strong>: {description}</td>"),
        );
        for outcome in comparison
            .runs
            .iter()
            .filter_map(|row| row.faults.get(index))
        {
            let (class, text) = match (outcome.survived, outcome.rms_error_deg) {
                (true, error) => ("good", format!("survived; rms error {} deg", number(error))),
                (false, _) => ("bad", outcome.reason.clone()),
            };
            put(
                body,
                format_args!("<td class=\"{class}\">{}</td>", escape(&text)),
            );
        }
        body.push_str("</tr>\n");
    }
    let total = comparison.faults.len();
    body.push_str("<tr><td>Survived</td>");
    for row in &comparison.runs {
        put(
            body,
            format_args!("<td>{} of {total}</td>", row.faults_survived),
        );
    }
    body.push_str("</tr>\n</table></section>\n");
}

fn notes(comparison: &Comparison, body: &mut String) {
    body.push_str("<section><h2>The controllers</h2>\n<ul>\n");
    for row in &comparison.runs {
        let (label, words) = (escape(&row.label), escape(&row.controller));
        put(body, format_args!("<li><strong>{label}</strong>: {words}"));
        if let Some(link) = &row.link {
            put(body, format_args!("; link: {}", escape(&link.encoding)));
        }
        for note in &row.notes {
            put(body, format_args!("<br>{}", escape(note)));
        }
        body.push_str("</li>\n");
    }
    body.push_str("</ul></section>\n");
}

fn figures(comparison: &Comparison, curves: &[Curves]) -> Vec<Figure> {
    let collect = |draw: &dyn Fn(&Curves) -> Option<Line>| -> Vec<Line> {
        curves.iter().filter_map(draw).collect()
    };
    let end_s = comparison.task.duration_s;
    let figure = |title: &str, label: &str, lines: Vec<Line>| Figure {
        title: title.to_string(),
        label: label.to_string(),
        lines,
        end_s,
        ..Figure::default()
    };
    let errors = collect(&|curve| {
        let (times, errors) = (column(curve, "time_s")?, column(curve, "error_deg")?);
        Some(Line::connected(&curve.label, &times, &errors))
    });
    let messages = collect(&|curve| {
        let (times, sent) = (column(curve, "time_s")?, column(curve, "sent")?);
        let counts = sent.iter().scan(0.0, |count, sent| {
            *count += sent;
            Some(*count)
        });
        Some(Line::held(
            &curve.label,
            &times,
            &counts.collect::<Vec<_>>(),
        ))
    });
    let efforts = collect(&|curve| {
        let times = column(curve, "time_s")?;
        let torques = ["torque_1_nm", "torque_2_nm", "torque_3_nm"];
        let torques = torques.map(|name| column(curve, name));
        let [Some(a), Some(b), Some(c)] = torques else {
            return None;
        };
        let spans = times.windows(2).map(|pair| pair[1] - pair[0]);
        let magnitudes = a.iter().zip(&b).zip(&c);
        let magnitudes = magnitudes.map(|((a, b), c)| a.abs() + b.abs() + c.abs());
        let mut impulses = vec![0.0];
        for (span, magnitude) in spans.zip(magnitudes) {
            impulses.push(impulses.last().copied().unwrap_or(0.0) + span * magnitude);
        }
        Some(Line::connected(&curve.label, &times, &impulses))
    });
    vec![
        Figure {
            logarithmic: true,
            limits: vec![comparison.task.settle_tolerance_deg],
            ..figure(
                "Attitude error and settling tolerance",
                "error (deg)",
                errors,
            )
        },
        Figure {
            logarithmic: true,
            ..figure("Messages sent", "messages", messages)
        },
        figure("Impulse spent", "impulse (N m s)", efforts),
    ]
}

fn column(curve: &Curves, name: &str) -> Option<Vec<f64>> {
    curve.trajectory.column(name)
}

fn provenance(comparison: &Comparison, body: &mut String) {
    put(
        body,
        format_args!("<footer>\n<p>{}</p>\n<p>", escape(&comparison.generator)),
    );
    for row in &comparison.runs {
        let (label, scenario) = (escape(&row.label), &row.scenario_sha256);
        put(body, format_args!("{label}: scenario SHA-256 {scenario}"));
        if let Some(design) = &row.design_sha256 {
            put(body, format_args!(", design SHA-256 {design}"));
        }
        body.push_str("<br>\n");
    }
    body.push_str("</p>\n</footer>\n");
}
