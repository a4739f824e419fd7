//! The page of a comparison: one HTML file with its figures inside.

use crate::base::number::short_or_none;
use crate::batch::comparison::{Comparison, ControllerRow, Curves};
use crate::report::chart::FigureError;
use crate::report::figure::Figure;
use crate::report::html::{
    cell, cell_of_class, escape, html_cell, html_list, paragraph, Header, HtmlTable, Page, Section,
};
use crate::report::series::Line;
use crate::run::summary::RunVerdict;
use crate::scenario::RequirementFile;
use crate::sim::metrics::{compared, MetricKind};

/// Title and heading.
const TITLE: &str = "Comparison of controllers";

/// A line of the page's table: its name and its value for each controller.
type MetricLine = (String, Vec<String>);

/// The lines of the page's table: the compared metrics, what is on the link before the use of bounds.
fn metric_lines(runs: &[ControllerRow]) -> Vec<MetricLine> {
    let line = |head: &str, value: &dyn Fn(&ControllerRow) -> String| -> MetricLine {
        (head.to_string(), runs.iter().map(value).collect())
    };
    let link = line("Bytes on the link to the actuators", &|row| {
        let link = row.link.as_ref();
        link.map_or("no link".to_string(), |link| link.bytes.to_string())
    });
    let entries = compared();
    let bounds = entries.partition_point(|entry| entry.kind < MetricKind::Usage);
    let metrics = entries.into_iter().enumerate().map(|(index, entry)| {
        let value = |row: &ControllerRow| row.shown().get(index).and_then(|(_, value)| *value);
        line(&entry.title(), &|row| match value(row) {
            Some(count) if entry.whole => count.to_string(),
            other => short_or_none(other),
        })
    });
    let mut lines: Vec<MetricLine> = metrics.collect();
    lines.insert(bounds, link);
    lines.push(line("Sampling", &|row| row.sampling.clone()));
    lines.push(line("Proof", &|row| {
        row.proof.clone().unwrap_or("none".to_string())
    }));
    lines
}

/// The page.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn page(comparison: &Comparison, curves: &[Curves]) -> Result<String, FigureError> {
    let mut sections = vec![metrics(comparison)];
    sections.extend(faults(comparison));
    sections.push(notes(comparison));
    for figure in figures(comparison, curves) {
        sections.push(figure.section()?);
    }
    let page = Page {
        title: TITLE.to_string(),
        style: "",
        header: header(comparison),
        sections,
        footer: provenance(comparison),
    };
    Ok(page.to_html())
}

fn header(comparison: &Comparison) -> Header {
    let broken = |row: &&ControllerRow| row.verdict == RunVerdict::ProofBroken;
    let met = |row: &&ControllerRow| row.verdict == RunVerdict::RequirementsMet;
    let total = comparison.runs.len();
    let (class, verdict) = if let Some(row) = comparison.runs.iter().find(broken) {
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
    let mut body = paragraph(&format!(
        "Runs of {} s; torque that can act: {a}, {b} and {c} N m; settled: error of at most {} deg; tail: \
         the last {} s.",
        task.duration_s, task.settle_tolerance_deg, task.tail_s,
    ));
    if let Some(file) = &task.taken_from {
        body += &paragraph(&format!(
            "Spacecraft, start, disturbance, limits and requirements of {file} for all."
        ));
    }
    if !task.requirements.is_empty() {
        let required: Vec<String> = task.requirements.iter().map(requirement).collect();
        body += &paragraph(&format!("Required: {}.", required.join("; ")));
    }
    Header {
        class,
        verdict,
        remark: String::new(),
        title: TITLE.to_string(),
        body,
    }
}

fn requirement(requirement: &RequirementFile) -> String {
    let name = requirement.metric.key();
    match (requirement.at_most, requirement.at_least) {
        (Some(limit), _) => format!("{name} at most {limit}"),
        (None, Some(limit)) => format!("{name} at least {limit}"),
        (None, None) => name.to_string(),
    }
}

/// A table with a column for each controller.
fn table(comparison: &Comparison, first: &str) -> HtmlTable {
    let labels = comparison.runs.iter().map(|row| row.label.as_str());
    HtmlTable::new("").head(std::iter::once(first).chain(labels))
}

fn metrics(comparison: &Comparison) -> Section {
    let mut table = table(comparison, "");
    let verdicts = comparison.runs.iter().map(|row| {
        let class = match row.verdict {
            RunVerdict::RequirementsMet => "good",
            _ => "bad",
        };
        cell_of_class(class, row.verdict.name().replace('_', " "))
    });
    table.row(std::iter::once(cell("Requirements")).chain(verdicts));
    for (name, values) in metric_lines(&comparison.runs) {
        table.row(std::iter::once(cell(name)).chain(values.into_iter().map(cell)));
    }
    Section::new("Without a standard fault").with_table(&table)
}

fn faults(comparison: &Comparison) -> Option<Section> {
    if comparison.faults.is_empty() {
        return None;
    }
    let mut table = table(comparison, "Fault");
    for (index, (name, description)) in comparison.faults.iter().enumerate() {
        let (name, description) = (escape(&name.replace('_', " ")), escape(description));
        let fault = html_cell(format!("<strong>{name}</strong>: {description}"));
        let outcomes = comparison.runs.iter();
        let outcomes = outcomes.filter_map(|row| row.faults.get(index));
        let outcomes = outcomes.map(|outcome| match (outcome.survived, outcome.rms_error_deg) {
            (true, error) => {
                let error = short_or_none(error);
                cell_of_class("good", format!("survived; rms error {error} deg"))
            }
            (false, _) => cell_of_class("bad", &outcome.reason),
        });
        table.row(std::iter::once(fault).chain(outcomes));
    }
    let total = comparison.faults.len();
    let counts = comparison.runs.iter();
    let counts = counts.map(|row| cell(format!("{} of {total}", row.faults_survived)));
    table.row(std::iter::once(cell("Survived")).chain(counts));
    Some(Section::new("Standard faults").with_table(&table))
}

fn notes(comparison: &Comparison) -> Section {
    let items = comparison.runs.iter().map(|row| {
        let (label, words) = (escape(&row.label), escape(&row.controller));
        let mut item = format!("<strong>{label}</strong>: {words}");
        if let Some(link) = &row.link {
            item += &format!("; link: {}", escape(&link.encoding));
        }
        for note in &row.notes {
            item += &format!("<br>{}", escape(note));
        }
        item
    });
    Section::new("The controllers").with(&html_list(items))
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

fn provenance(comparison: &Comparison) -> Vec<Vec<String>> {
    let files = comparison.runs.iter().map(|row| {
        let (label, scenario) = (&row.label, &row.scenario_sha256);
        let design = row.design_sha256.as_ref();
        let design = design.map_or(String::new(), |design| format!(", design SHA-256 {design}"));
        format!("{label}: scenario SHA-256 {scenario}{design}")
    });
    vec![vec![comparison.generator.clone()], files.collect()]
}
