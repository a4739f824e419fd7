//! The page of a sweep: one HTML file with its plots inside, readable offline, in the dark and on paper.

mod figures;
mod maps;
mod reasons;

use synth::model::Kind;

use figures::{claim_text, front, trade_off, View};
use maps::{slices, verdict_colour};
use reasons::{reasons, Reason};

use super::optional;
use crate::base::number::label;
use crate::batch::sweep::finished::{Finished, CSV_FILE, PARQUET_FILE};
use crate::batch::sweep::outcome::PointOutcome;
use crate::report::chart::{hexadecimal, FigureError};
use crate::report::html::{
    captioned, cell, division, escape, heading, judged, paragraph, row, row_of_class, section,
    table, Page, PageKind,
};
use crate::run::summary::RunVerdict;

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
    let view = View::new(sweep);
    let front = match view.of_model() {
        true => front(sweep.outcomes),
        false => Vec::new(),
    };
    let reasons = reasons(sweep.outcomes);
    let mut sections = Vec::new();
    sections.extend(optional("Trade-off", &pareto(&view, &front)?));
    sections.extend(optional("Feasibility", &maps(&view, &reasons)?));
    sections.extend(optional("Curves", &curves(&view)?));
    sections.extend(optional("Why points failed", &why(&view, &reasons)));
    sections.push(section("Points", &points(&view, &front)));
    let good = sweep.outcomes.iter().filter(|point| point.good()).count();
    let total = sweep.outcomes.len();
    let broken = RunVerdict::ProofBroken.name();
    let alarm = sweep.outcomes.iter().any(|point| point.verdict == broken);
    let answer = match view.of_model() {
        true => "are proved",
        false => "meet every requirement",
    };
    let uncovered = sweep.covered().is_some_and(|covered| covered < total);
    let page = Page {
        kind: PageKind::Sweep,
        title: format!("Sweep of {}", sweep.file),
        class: match (alarm, good == total) {
            (true, _) => "alarm",
            (_, true) if uncovered => "caution",
            (_, true) => "good",
            (_, false) => "bad",
        },
        verdict: format!("{good} of {total} points {answer}."),
        remark: remark(sweep),
        heading: format!("Sweep of {}", sweep.file),
        introduction: introduction(&view),
        sections,
        footer: vec![provenance(sweep)],
    };
    Ok(page.to_html())
}

/// Of how many points something is proved; empty for a model, whose verdicts say it.
fn remark(sweep: &Finished) -> String {
    let total = sweep.outcomes.len();
    match (sweep.subject.kind(), sweep.covered()) {
        (Kind::Model, _) => String::new(),
        (_, None) => "Nothing is proved for this controller.".to_string(),
        (_, Some(covered)) if covered == total => "The proof covers every point.".to_string(),
        (_, Some(covered)) => format!(
            "The proof covers {covered} of {total} points; what is shown of the others was simulated only."
        ),
    }
}

/// What is said of a point: its verdict, and that the proof does not cover it.
fn answer(point: &PointOutcome) -> String {
    match point.uncovered() {
        true => format!("{}, not covered by the proof", words(&point.verdict)),
        false => words(&point.verdict),
    }
}

/// Why the answer is no, and why the proof does not cover the point.
fn reason(point: &PointOutcome) -> String {
    let uncovered = point.not_covered.as_ref();
    let uncovered = uncovered.map(|reasons| format!("not covered: {reasons}"));
    let parts = point.reason.iter().cloned().chain(uncovered);
    parts.collect::<Vec<_>>().join("; ")
}

fn words(verdict: &str) -> String {
    verdict.replace('_', " ")
}

/// What was varied, and how many points have each verdict.
fn introduction(view: &View) -> String {
    let axes = view.labels.iter().zip(&view.values);
    let axes = axes.zip(view.sweep.grid.names());
    let axes = axes.map(|((name, values), written)| [name.clone(), listed(values), written]);
    let verdicts = view.sweep.verdicts().into_iter();
    let verdicts =
        verdicts.map(|(verdict, count)| [words(verdict), count.to_string(), String::new()]);
    let rows = axes.chain(verdicts);
    let rows = rows.map(|[name, a, b]| row([heading(name), cell(a), cell(b)]));
    table("numbers", [""; 0], rows)
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

/// Points that no other beats; empty without any.
fn pareto(view: &View, front: &[usize]) -> Result<String, FigureError> {
    let Some(trade_off) = trade_off(view.sweep.outcomes, front) else {
        return Ok(String::new());
    };
    let metrics = ["certified_angle_deg", "gamma", "guaranteed_gain"];
    let axes = view.labels.iter().cloned();
    let names = axes.chain(metrics.map(|metric| view.named(metric)));
    let rows = front.iter().map(|&index| {
        let point = &view.sweep.outcomes[index];
        let values = point.values.iter().copied().map(Some);
        let shown = metrics.map(|metric| metric_cell(metric, point.metric(metric)));
        row(values.map(number_cell).chain(shown))
    });
    let best = table("front", names, rows);
    let title = "Points that no other beats: a larger proved angle costs a larger gamma";
    let best = captioned(title, &division("wide", &best));
    Ok(division("plots", &(trade_off.captioned()? + &best)))
}

/// A metric of a point.
fn metric_cell(metric: &str, value: Option<f64>) -> String {
    let claim = value.map(|value| claim_text(metric, value));
    cell(claim.unwrap_or_default())
}

fn number_cell(value: Option<f64>) -> String {
    cell(value.map_or(String::new(), label))
}

/// Maps over two axes; empty where only one is varied.
fn maps(view: &View, reasons: &[Reason]) -> Result<String, FigureError> {
    let (slices, total) = slices(view);
    if slices.is_empty() {
        return Ok(String::new());
    }
    let key = view.sweep.verdicts().into_keys().map(|verdict| {
        let colour = hexadecimal(verdict_colour(verdict));
        let verdict = escape(&words(verdict));
        format!("<span><i style=\"background: {colour}\"></i>{verdict}</span>")
    });
    let mut html = format!("<p class=\"key\">{}</p>\n", key.collect::<String>());
    if view.sweep.outcomes.iter().any(PointOutcome::uncovered) {
        html += &paragraph("~ marks a point that the proof does not cover.");
    }
    if !reasons.is_empty() {
        html += "<p>Letters stand for the <a href=\"#why\">reasons</a>.</p>\n";
    }
    if slices.len() < total {
        html += &paragraph(&format!(
            "{} of {total} choices of the other axes are drawn.",
            slices.len()
        ));
    }
    let mut plots = String::new();
    for slice in &slices {
        plots += &slice.answers(reasons).captioned()?;
        let mapped = MAPPED.iter().filter(|_| view.of_model());
        for (map, key) in mapped.filter_map(|metric| slice.shades(metric)) {
            plots += &captioned(&map.title, &(key + &map.to_svg()?));
        }
    }
    Ok(html + &division("plots", &plots))
}

/// Metrics against axes; empty without any that differ.
fn curves(view: &View) -> Result<String, FigureError> {
    let (metrics, constant) = view.metrics();
    let axes = view.varied();
    let wanted = metrics
        .iter()
        .flat_map(|metric| axes.iter().map(move |&axis| (metric, axis)));
    let count = wanted.clone().count();
    if count == 0 {
        return Ok(String::new());
    }
    let plots = wanted
        .take(PLOTS)
        .map(|(metric, axis)| view.curve(metric, axis).captioned());
    let mut html = division("plots", &plots.collect::<Result<String, _>>()?);
    if count > PLOTS {
        html += &paragraph(&format!(
            "{PLOTS} of {count} plots are drawn; every number is in {CSV_FILE}."
        ));
    }
    if !constant.is_empty() {
        let names = constant.join(", ");
        html += &paragraph(&format!("The same at every point: {names}."));
    }
    Ok(html)
}

/// The reasons; empty without any.
fn why(view: &View, reasons: &[Reason]) -> String {
    if reasons.is_empty() {
        return String::new();
    }
    let title = [
        "",
        "Points",
        "Verdict",
        "Reason, with the numbers of the first",
        "The first",
    ];
    let rows = reasons.iter().take(REASONS).map(|reason| {
        let first = reason.points.first();
        let first = first.and_then(|&point| view.sweep.outcomes.get(point));
        row([
            cell(&reason.letter),
            cell(reason.points.len().to_string()),
            cell(words(&reason.verdict)),
            cell(&reason.example),
            cell(first.map_or(String::new(), |point| view.place(&point.values, &[]))),
        ])
    });
    let rows = division("wide", &table("", title, rows));
    let mut html = "<a id=\"why\"></a>".to_string() + &rows;
    if reasons.len() > REASONS {
        let rest = reasons.len() - REASONS;
        html += &paragraph(&format!("{rest} more are in {CSV_FILE}."));
    }
    html
}

/// The table of the points.
fn points(view: &View, front: &[usize]) -> String {
    let mut columns = view.metrics().0;
    if view.of_model() {
        columns.push("worst_margin".to_string());
    }
    columns.truncate(8);
    let named = columns.iter().map(|name| view.named(name));
    let names = view.labels.iter().cloned();
    let names = names.chain(["verdict".to_string()]).chain(named);
    let names = names.chain(["reason".to_string()]);
    let outcomes = view.sweep.outcomes;
    let rows = outcomes
        .iter()
        .take(ROWS)
        .enumerate()
        .map(|(index, point)| {
            let class = if front.contains(&index) { "front" } else { "" };
            let values = point.values.iter().copied().map(Some).map(number_cell);
            let shown = columns
                .iter()
                .map(|name| metric_cell(name, view.shown(point, name)));
            let cells = values
                .chain([judged(point.good() && !point.uncovered(), answer(point))])
                .chain(shown)
                .chain([cell(reason(point))]);
            row_of_class(class, cells)
        });
    let mut html = division("wide", &table("points", names, rows));
    let total = outcomes.len();
    if total > ROWS {
        html += &paragraph(&format!(
            "The first {ROWS} of {total} points; all are in {CSV_FILE}."
        ));
    }
    if !front.is_empty() {
        html += &paragraph("Points in bold are on the Pareto front.");
    }
    html
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
