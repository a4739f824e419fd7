//! The page of a comparison: one HTML file with its figures inside.

use super::{hashes, optional};
use crate::base::number::short_or_none;
use crate::batch::comparison::{Comparison, ControllerRow, Curves};
use crate::report::chart::Figure;
use crate::report::chart::FigureError;
use crate::report::html::{
    cell, escape, html_cell, judged, list, paragraph, row, section, table, Page, PageKind,
};
use crate::report::series::Series;
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
        line(&entry.title(), &|row| entry.text(value(row)))
    });
    let mut lines: Vec<MetricLine> = metrics.collect();
    lines.insert(bounds, link);
    lines.push(line("Sampling", &|row| row.sampling.clone()));
    lines.push(line("Proof", &|row| {
        row.proof.clone().unwrap_or("nothing is proved".to_string())
    }));
    lines
}

/// The page.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn page(comparison: &Comparison, curves: &[Curves]) -> Result<String, FigureError> {
    let mut sections = vec![section("Without a standard fault", &metrics(comparison))];
    sections.extend(optional("Standard faults", &faults(comparison)));
    sections.push(section("The controllers", &notes(comparison)));
    for figure in figures(comparison, curves) {
        sections.push(figure.section()?);
    }
    let (class, verdict) = verdict(comparison);
    let files = comparison.runs.iter().map(|row| {
        let digests = hashes(&row.scenario_sha256, row.design_sha256.as_deref());
        let shown = if row.design_sha256.is_some() { 2 } else { 1 };
        format!("{}: {}", row.label, digests[..shown].join(", "))
    });
    let page = Page {
        kind: PageKind::Comparison,
        title: TITLE.to_string(),
        class,
        verdict,
        heading: TITLE.to_string(),
        introduction: introduction(comparison),
        sections,
        footer: vec![vec![comparison.generator.clone()], files.collect()],
        ..Page::default()
    };
    Ok(page.to_html())
}

/// How many controllers meet every requirement, and how it is shown.
fn verdict(comparison: &Comparison) -> (&'static str, String) {
    let broken = |row: &&ControllerRow| row.verdict == RunVerdict::ProofBroken;
    let met = |row: &&ControllerRow| row.verdict == RunVerdict::RequirementsMet;
    if let Some(row) = comparison.runs.iter().find(broken) {
        let sentence = format!("{}: {}", row.label, row.verdict.sentence());
        return ("alarm", sentence);
    }
    if comparison.task.requirements.is_empty() {
        return ("good", "The task states no requirement.".to_string());
    }
    let total = comparison.runs.len();
    let met = comparison.runs.iter().filter(met).count();
    let class = if met == total { "good" } else { "bad" };
    let verdict = format!("{met} of {total} controllers meet every requirement.");
    (class, verdict)
}

/// What all controllers have in common.
fn introduction(comparison: &Comparison) -> String {
    let task = &comparison.task;
    let [a, b, c] = task.torque_limit_nm;
    let mut html = paragraph(&format!(
        "Runs of {} s; torque that can act: {a}, {b} and {c} N m; settled: error of at most {} deg; tail: \
         the last {} s.",
        task.duration_s, task.settle_tolerance_deg, task.tail_s,
    ));
    if let Some(file) = &task.taken_from {
        html += &paragraph(&format!(
            "Spacecraft, start, disturbance, limits and requirements of {file} for all."
        ));
    }
    if !task.requirements.is_empty() {
        let required: Vec<String> = task.requirements.iter().map(requirement).collect();
        html += &paragraph(&format!("Required: {}.", required.join("; ")));
    }
    html
}

fn requirement(requirement: &RequirementFile) -> String {
    let name = requirement.metric.key();
    match (requirement.at_most, requirement.at_least) {
        (Some(limit), _) => format!("{name} at most {limit}"),
        (None, Some(limit)) => format!("{name} at least {limit}"),
        (None, None) => name.to_string(),
    }
}

/// Headings, one for each controller.
fn title<'a>(comparison: &'a Comparison, first: &'a str) -> impl Iterator<Item = &'a str> {
    let labels = comparison.runs.iter().map(|row| row.label.as_str());
    std::iter::once(first).chain(labels)
}

fn metrics(comparison: &Comparison) -> String {
    let verdicts = comparison.runs.iter().map(|row| {
        let met = row.verdict == RunVerdict::RequirementsMet;
        judged(met, row.verdict.name().replace('_', " "))
    });
    let verdicts = row([cell("Requirements")].into_iter().chain(verdicts));
    let lines = metric_lines(&comparison.runs).into_iter();
    let lines = lines.map(|(name, values)| row([name].into_iter().chain(values).map(cell)));
    let rows = [verdicts].into_iter().chain(lines);
    table("", title(comparison, ""), rows)
}

/// The table of the standard faults; empty without any.
fn faults(comparison: &Comparison) -> String {
    if comparison.faults.is_empty() {
        return String::new();
    }
    let mut rows = Vec::new();
    for (index, (name, description)) in comparison.faults.iter().enumerate() {
        let (name, description) = (escape(&name.replace('_', " ")), escape(description));
        let fault = html_cell(&format!("<strong>{name}</strong>: {description}"));
        let outcomes = comparison.runs.iter();
        let outcomes = outcomes.filter_map(|row| row.faults.get(index));
        let outcomes = outcomes.map(|outcome| {
            let proof = outcome.proof.as_ref();
            let proof = proof.map_or(String::new(), |proof| format!("; {proof}"));
            match outcome.survived {
                true => {
                    let error = short_or_none(outcome.rms_error_deg);
                    judged(true, format!("passed; rms error {error} deg{proof}"))
                }
                false => judged(false, format!("{}{proof}", outcome.reason)),
            }
        });
        rows.push(row([fault].into_iter().chain(outcomes)));
    }
    let total = comparison.faults.len();
    let counts = comparison.runs.iter();
    let counts = counts.map(|row| cell(format!("{} of {total}", row.faults_survived)));
    rows.push(row([cell("Passed")].into_iter().chain(counts)));
    table("", title(comparison, "Fault"), rows)
}

fn notes(comparison: &Comparison) -> String {
    list(comparison.runs.iter().map(|row| {
        let (label, words) = (escape(&row.label), escape(&row.controller));
        let mut item = format!("<strong>{label}</strong>: {words}");
        if let Some(link) = &row.link {
            item += &format!("; link: {}", escape(&link.encoding));
        }
        for note in &row.notes {
            item += &format!("<br>{}", escape(note));
        }
        item
    }))
}

/// A figure with a line for each controller whose trajectory has the columns.
fn figures(comparison: &Comparison, curves: &[Curves]) -> [Figure; 3] {
    let figure = |title: &str, label: &str, line: &dyn Fn(&Curves) -> Option<Series>| {
        let lines = curves.iter().filter_map(line).collect();
        Figure::over_time(title, label, comparison.task.duration_s, lines)
    };
    let title = "Attitude error and settling tolerance";
    let errors = figure(title, "error (deg)", &|curve| {
        let [times, errors] = columns(curve, ["time_s", "error_deg"])?;
        Some(Series::connected(&curve.label, &times, &errors))
    });
    let messages = figure("Messages sent", "messages", &|curve| {
        let [times, sent] = columns(curve, ["time_s", "sent"])?;
        let counts = running_sum(sent);
        Some(Series::held(&curve.label, &times, &counts[1..]))
    });
    let impulses = figure("Impulse spent", "impulse (N m s)", &|curve| {
        let names = ["time_s", "torque_1_nm", "torque_2_nm", "torque_3_nm"];
        let [times, a, b, c] = columns(curve, names)?;
        let spans = times.windows(2).map(|pair| pair[1] - pair[0]);
        let magnitudes = a.iter().zip(&b).zip(&c);
        let magnitudes = magnitudes.map(|((a, b), c)| a.abs() + b.abs() + c.abs());
        let steps = spans.zip(magnitudes);
        let impulses = running_sum(steps.map(|(span, magnitude)| span * magnitude));
        Some(Series::connected(&curve.label, &times, &impulses))
    });
    [
        errors
            .logarithmic()
            .limits([comparison.task.settle_tolerance_deg]),
        messages.logarithmic(),
        impulses,
    ]
}

fn columns<const N: usize>(curve: &Curves, names: [&str; N]) -> Option<[Vec<f64>; N]> {
    let columns = names.map(|name| curve.trajectory.column(name));
    let columns: Option<Vec<_>> = columns.into_iter().collect();
    columns?.try_into().ok()
}

/// 0 and what it grows to with each step.
fn running_sum(steps: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let sums = steps.into_iter().scan(0.0, |sum, step| {
        *sum += step;
        Some(*sum)
    });
    [0.0].into_iter().chain(sums).collect()
}
