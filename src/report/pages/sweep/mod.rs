//! The page of a sweep: one HTML file with its plots inside, readable offline, in the dark and on paper.

mod figures;
mod maps;
mod reasons;

use std::collections::HashSet;

use synth::model::Kind;

use figures::{curve, front, labelled, metrics, shown, trade_off, Labels};
use maps::{slices, verdict_colour, Range};
use reasons::{reasons, Reason};

use crate::base::number::label;
use crate::batch::sweep::finished::{Finished, CSV_FILE, PARQUET_FILE};
use crate::batch::sweep::outcome::PointOutcome;
use crate::report::chart::{hexadecimal, FigureError};
use crate::report::html::{
    cell, cell_of_class, division, escape, figure, legend, paragraph, Header, HtmlCell, HtmlTable,
    Page, Section,
};
use crate::report::plot::Plot;
use crate::run::summary::RunVerdict;

const STYLE: &str = include_str!("sweep.css");

/// Most plots of metrics against axes.
const PLOTS: usize = 24;
/// Most rows of the table of points.
const ROWS: usize = 1000;
/// Most reasons that are listed.
const REASONS: usize = 60;
/// Metrics of a model that have a map.
const MAPPED: [&str; 2] = ["gamma", "certified_angle_deg"];

/// The page.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn page(sweep: &Finished) -> Result<String, FigureError> {
    let labels = Labels::new(sweep.subject, sweep.grid);
    let front = match sweep.subject.kind() {
        Kind::Model => front(sweep.outcomes),
        _ => Vec::new(),
    };
    let reasons = reasons(sweep.outcomes);
    let mut sections = Vec::new();
    sections.extend(pareto(sweep, &labels, &front)?);
    sections.extend(maps(sweep, &labels, &reasons)?);
    sections.extend(curves(sweep, &labels)?);
    sections.extend(why(sweep, &labels, &reasons));
    sections.push(points(sweep, &labels, &front));
    let page = Page {
        title: format!("Sweep of {}", sweep.file),
        style: STYLE,
        header: header(sweep, &labels),
        sections,
        footer: vec![provenance(sweep)],
    };
    Ok(page.to_html())
}

fn words(verdict: &str) -> String {
    verdict.replace('_', " ")
}

fn header(sweep: &Finished, labels: &Labels) -> Header {
    let (good, total) = (
        sweep.outcomes.iter().filter(|point| point.good()).count(),
        sweep.outcomes.len(),
    );
    let broken = RunVerdict::ProofBroken.name();
    let alarm = sweep.outcomes.iter().any(|point| point.verdict == broken);
    let class = match (alarm, good == total) {
        (true, _) => "alarm",
        (_, true) => "good",
        (_, false) => "bad",
    };
    let answer = match sweep.subject.kind() {
        Kind::Model => "are proved",
        _ => "meet every requirement",
    };
    let mut table = HtmlTable::new("numbers");
    let axes = sweep.grid.names().into_iter().zip(sweep.grid.axes());
    for (name, (written, (_, values))) in labels.axes.iter().zip(axes) {
        table.named_row(name, [cell(listed(values)), cell(written)]);
    }
    for (verdict, count) in sweep.verdicts() {
        table.named_row(&words(verdict), [cell(count.to_string()), cell("")]);
    }
    Header {
        class,
        verdict: format!("{good} of {total} points {answer}."),
        remark: String::new(),
        title: format!("Sweep of {}", sweep.file),
        body: table.to_html(),
    }
}

/// Values as text: all of a few, the ends of many.
fn listed(values: &[f64]) -> String {
    match values {
        [first, .., last] if values.len() > 8 => {
            format!(
                "{} values from {} to {}",
                values.len(),
                label(*first),
                label(*last)
            )
        }
        few => few
            .iter()
            .map(|&value| label(value))
            .collect::<Vec<_>>()
            .join(", "),
    }
}

fn drawn(plot: &Plot) -> Result<String, FigureError> {
    let named = plot.series.iter().filter(|series| !series.name.is_empty());
    let names = named.map(|series| (&series.name, hexadecimal(series.colour)));
    Ok(figure("", &plot.title, &(legend(names) + &plot.to_svg()?)))
}

fn pareto(
    sweep: &Finished,
    labels: &Labels,
    front: &[usize],
) -> Result<Option<Section>, FigureError> {
    let Some(trade_off) = trade_off(sweep.outcomes, front) else {
        return Ok(None);
    };
    let metrics = ["certified_angle_deg", "gamma", "guaranteed_gain"];
    let names = ["certified angle (deg)", "gamma", "guaranteed gain"];
    let axes = labels.axes.iter().map(String::as_str);
    let mut table = HtmlTable::new("front").head(axes.chain(names));
    for &index in front {
        let point = &sweep.outcomes[index];
        let values = point.values.iter().copied().map(Some);
        let shown = metrics.into_iter().map(|metric| point.metric(metric));
        table.row(values.chain(shown).map(number_cell));
    }
    let title = "Points that no other beats: a larger proved angle costs a larger gamma";
    let best = figure("wide", title, &table.to_html());
    let plots = division("plots", &(drawn(&trade_off)? + &best));
    Ok(Some(Section::new("Trade-off").with(&plots)))
}

fn number_cell(value: Option<f64>) -> HtmlCell {
    cell(value.map_or(String::new(), label))
}

fn maps(
    sweep: &Finished,
    labels: &Labels,
    reasons: &[Reason],
) -> Result<Option<Section>, FigureError> {
    let (slices, total) = slices(sweep.grid, labels);
    if slices.is_empty() {
        return Ok(None);
    }
    let key = sweep.verdicts().into_keys().map(|verdict| {
        let colour = hexadecimal(verdict_colour(verdict));
        let verdict = escape(&words(verdict));
        format!("<span><i style=\"background: {colour}\"></i>{verdict}</span>")
    });
    let key = key.collect::<String>();
    let mut section = Section::new("Feasibility").with(&format!("<p class=\"key\">{key}</p>\n"));
    if !reasons.is_empty() {
        section = section.with("<p>Letters stand for the <a href=\"#why\">reasons</a>.</p>\n");
    }
    if slices.len() < total {
        let count = slices.len();
        section = section.with(&paragraph(&format!(
            "{count} of {total} choices of the other axes are drawn."
        )));
    }
    let mut plots = String::new();
    for slice in &slices {
        let map = slice.answers(sweep.grid, labels, sweep.outcomes, reasons);
        plots += &figure("", &map.title, &map.to_svg()?);
        if sweep.subject.kind() != Kind::Model {
            continue;
        }
        for metric in MAPPED {
            let Some(range) = Range::of(sweep.subject, sweep.outcomes, metric) else {
                continue;
            };
            let name = labelled(metric, sweep.subject.unit(metric));
            let data = (sweep.subject, sweep.outcomes);
            let map = slice.shades(sweep.grid, labels, data, metric, &name);
            plots += &figure("", &map.title, &(shades(&range) + &map.to_svg()?));
        }
    }
    Ok(Some(section.with(&division("plots", &plots))))
}

fn shades(range: &Range) -> String {
    let scale = if range.logarithmic() {
        ", at equal ratios"
    } else {
        ""
    };
    format!(
        "<p class=\"legend\">{}<i class=\"shades\" style=\"background: {}\"></i>{}{scale}; x: no proved value</p>\n",
        label(range.low),
        maps::gradient(),
        label(range.high)
    )
}

fn curves(sweep: &Finished, labels: &Labels) -> Result<Option<Section>, FigureError> {
    let (metrics, constant) = metrics(sweep.subject, sweep.outcomes);
    let sizes = sweep.grid.axes().map(|(_, values)| values.len());
    let axes: Vec<usize> = sizes
        .enumerate()
        .filter(|(_, size)| *size > 1)
        .map(|(axis, _)| axis)
        .collect();
    let wanted = metrics
        .iter()
        .flat_map(|metric| axes.iter().map(move |&axis| (metric, axis)));
    let wanted: Vec<(&String, usize)> = wanted.collect();
    if wanted.is_empty() {
        return Ok(None);
    }
    let mut plots = String::new();
    for &(metric, axis) in wanted.iter().take(PLOTS) {
        let (subject, grid) = (sweep.subject, sweep.grid);
        let plot = curve(subject, grid, sweep.outcomes, metric, axis, labels);
        plots += &drawn(&plot)?;
    }
    let mut section = Section::new("Curves").with(&division("plots", &plots));
    if wanted.len() > PLOTS {
        let count = wanted.len();
        section = section.with(&paragraph(&format!(
            "{PLOTS} of {count} plots are drawn; every number is in {CSV_FILE}."
        )));
    }
    if !constant.is_empty() {
        let names = constant.join(", ");
        section = section.with(&paragraph(&format!("The same at every point: {names}.")));
    }
    Ok(Some(section))
}

fn why(sweep: &Finished, labels: &Labels, reasons: &[Reason]) -> Option<Section> {
    if reasons.is_empty() {
        return None;
    }
    let mut table = HtmlTable::new("").within("wide").head([
        "",
        "Points",
        "Verdict",
        "Reason, with the numbers of the first",
        "The first",
    ]);
    for reason in reasons.iter().take(REASONS) {
        let first = reason
            .points
            .first()
            .and_then(|&point| sweep.outcomes.get(point));
        table.row([
            cell(&reason.letter),
            cell(reason.points.len().to_string()),
            cell(words(&reason.verdict)),
            cell(&reason.example),
            cell(first.map_or(String::new(), |point| place(point, labels))),
        ]);
    }
    let section = Section::new("Why points failed")
        .id("why")
        .with_table(&table);
    if reasons.len() <= REASONS {
        return Some(section);
    }
    let rest = reasons.len() - REASONS;
    Some(section.with(&paragraph(&format!("{rest} more are in {CSV_FILE}."))))
}

/// The values of a point as text.
fn place(point: &PointOutcome, labels: &Labels) -> String {
    let values = labels.axes.iter().zip(&point.values);
    let values = values.map(|(axis, &value)| format!("{axis} {}", label(value)));
    values.collect::<Vec<_>>().join(", ")
}

fn points(sweep: &Finished, labels: &Labels, front: &[usize]) -> Section {
    let mut columns = metrics(sweep.subject, sweep.outcomes).0;
    if sweep.subject.kind() == Kind::Model {
        columns.push("worst_margin".to_string());
    }
    columns.truncate(8);
    let named = columns
        .iter()
        .map(|name| labelled(name, sweep.subject.unit(name)));
    let head = labels.axes.iter().cloned();
    let head = head.chain(["verdict".to_string()]).chain(named);
    let mut table = HtmlTable::new("points")
        .within("wide")
        .head(head.chain(["reason".to_string()]));
    let front: HashSet<usize> = front.iter().copied().collect();
    for (index, point) in sweep.outcomes.iter().enumerate().take(ROWS) {
        let class = if front.contains(&index) { "front" } else { "" };
        let good = if point.good() { "good" } else { "bad" };
        let values = point.values.iter().copied().map(Some).map(number_cell);
        let shown = columns.iter().map(|name| shown(sweep.subject, point, name));
        let cells = values
            .chain([cell_of_class(good, words(&point.verdict))])
            .chain(shown.map(number_cell))
            .chain([cell(point.reason.as_deref().unwrap_or_default())]);
        table.row_of_class(class, cells);
    }
    let mut section = Section::new("Points").with_table(&table);
    let total = sweep.outcomes.len();
    if total > ROWS {
        section = section.with(&paragraph(&format!(
            "The first {ROWS} of {total} points; all are in {CSV_FILE}."
        )));
    }
    if !front.is_empty() {
        section = section.with(&paragraph("Points in bold are on the Pareto front."));
    }
    section
}

fn provenance(sweep: &Finished) -> Vec<String> {
    let identity = sweep.identity;
    let mut lines = vec![format!(
        "{}; {} SHA-256 {}",
        identity.generator, identity.kind, identity.file_sha256
    )];
    let solver = identity.solver.as_ref();
    lines.extend(solver.map(|solver| format!("solver: {solver}")));
    let design = identity.design_sha256.as_ref();
    lines.extend(design.map(|design| format!("design SHA-256 {design}")));
    lines.push(format!("every number: {CSV_FILE} and {PARQUET_FILE}"));
    lines
}
