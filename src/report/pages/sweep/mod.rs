//! The page of a sweep: one HTML file with its plots inside, readable offline, in the dark and on paper.

mod figures;
mod maps;
mod plot;
mod reasons;
mod scale;

use std::collections::HashSet;
use std::fmt::Write;

use synth::model::Kind;

use figures::{curve, front, labelled, metrics, shown, trade_off, Labels};
use maps::{html, slices, verdict_colour, Range};
use plot::Plot;
use reasons::{reasons, Reason};
use scale::number;

use crate::batch::sweep::finished::{Finished, CSV_FILE, PARQUET_FILE};
use crate::batch::sweep::outcome::PointOutcome;
use crate::report::figure::FigureError;
use crate::report::html::{document_with_style, escape};

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
    let mut body = String::new();
    header(sweep, &labels, &mut body);
    pareto(sweep, &labels, &front, &mut body)?;
    maps(sweep, &labels, &reasons, &mut body)?;
    curves(sweep, &labels, &mut body)?;
    why(sweep, &labels, &reasons, &mut body);
    points(sweep, &labels, &front, &mut body);
    footer(sweep, &mut body);
    let title = format!("Sweep of {}", sweep.file);
    Ok(document_with_style(&title, STYLE, &body))
}

/// Writing to a string cannot fail.
fn put(body: &mut String, text: std::fmt::Arguments) {
    let _ = body.write_fmt(text);
}

fn words(verdict: &str) -> String {
    escape(&verdict.replace('_', " "))
}

fn header(sweep: &Finished, labels: &Labels, body: &mut String) {
    let (good, total) = (
        sweep.outcomes.iter().filter(|point| point.good()).count(),
        sweep.outcomes.len(),
    );
    let alarm = sweep
        .outcomes
        .iter()
        .any(|point| point.verdict == "proof_broken");
    let class = match (alarm, good == total) {
        (true, _) => "alarm",
        (_, true) => "good",
        (_, false) => "bad",
    };
    let answer = match sweep.subject.kind() {
        Kind::Model => "are proved",
        _ => "meet every requirement",
    };
    put(
        body,
        format_args!(
            "<header>\n<p class=\"verdict {class}\"><strong>{good} of {total} points {answer}.</strong></p>\n\
             <h1>Sweep of {}</h1>\n",
            escape(sweep.file)
        ),
    );
    body.push_str("<table class=\"numbers\">\n");
    for ((label, name), (_, values)) in labels
        .axes
        .iter()
        .zip(sweep.grid.names())
        .zip(sweep.grid.axes())
    {
        put(
            body,
            format_args!(
                "<tr><th>{}</th><td>{}</td><td>{}</td></tr>\n",
                escape(label),
                escape(&listed(values)),
                escape(&name)
            ),
        );
    }
    for (verdict, count) in sweep.verdicts() {
        let verdict = words(verdict);
        put(
            body,
            format_args!("<tr><th>{verdict}</th><td>{count}</td><td></td></tr>\n"),
        );
    }
    body.push_str("</table>\n</header>\n");
}

/// Values in words: all of a few, the ends of many.
fn listed(values: &[f64]) -> String {
    match values {
        [first, .., last] if values.len() > 8 => {
            format!(
                "{} values from {} to {}",
                values.len(),
                number(*first),
                number(*last)
            )
        }
        few => few
            .iter()
            .map(|&value| number(value))
            .collect::<Vec<_>>()
            .join(", "),
    }
}

fn figure(title: &str, legend: &str, svg: &str, body: &mut String) {
    let title = escape(title);
    put(
        body,
        format_args!("<figure><figcaption>{title}</figcaption>\n{legend}{svg}</figure>\n"),
    );
}

fn plot(plot: &Plot, body: &mut String) -> Result<(), FigureError> {
    let named = plot.series.iter().filter(|series| !series.name.is_empty());
    let mut legend = String::new();
    for series in named {
        let (colour, name) = (html(series.colour), escape(&series.name));
        put(
            &mut legend,
            format_args!("<span style=\"border-color: {colour}\">{name}</span>"),
        );
    }
    if !legend.is_empty() {
        legend = format!("<p class=\"legend\">{legend}</p>\n");
    }
    figure(&plot.title, &legend, &plot.to_svg()?, body);
    Ok(())
}

fn pareto(
    sweep: &Finished,
    labels: &Labels,
    front: &[usize],
    body: &mut String,
) -> Result<(), FigureError> {
    let Some(trade_off) = trade_off(sweep.outcomes, front) else {
        return Ok(());
    };
    body.push_str("<section><h2>Trade-off</h2>\n<div class=\"plots\">\n");
    plot(&trade_off, body)?;
    body.push_str(
        "<figure class=\"wide\"><figcaption>Points that no other beats: a larger proved angle costs a \
         larger gamma</figcaption>\n<table class=\"front\">\n<tr>",
    );
    for label in &labels.axes {
        put(body, format_args!("<th>{}</th>", escape(label)));
    }
    body.push_str("<th>certified angle (deg)</th><th>gamma</th><th>guaranteed gain</th></tr>\n");
    for &index in front {
        let point = &sweep.outcomes[index];
        body.push_str("<tr>");
        cells(point.values.iter().copied().map(Some), body);
        let shown = ["certified_angle_deg", "gamma", "guaranteed_gain"];
        cells(shown.into_iter().map(|metric| point.metric(metric)), body);
        body.push_str("</tr>\n");
    }
    body.push_str("</table></figure>\n</div></section>\n");
    Ok(())
}

fn cells(values: impl Iterator<Item = Option<f64>>, body: &mut String) {
    for value in values {
        let text = value.map_or(String::new(), number);
        put(body, format_args!("<td>{text}</td>"));
    }
}

fn maps(
    sweep: &Finished,
    labels: &Labels,
    reasons: &[Reason],
    body: &mut String,
) -> Result<(), FigureError> {
    let (slices, total) = slices(sweep.grid, labels);
    if slices.is_empty() {
        return Ok(());
    }
    body.push_str("<section><h2>Feasibility</h2>\n<p class=\"key\">");
    for (verdict, _) in sweep.verdicts() {
        let colour = html(verdict_colour(verdict));
        let verdict = words(verdict);
        put(
            body,
            format_args!("<span><i style=\"background: {colour}\"></i>{verdict}</span>"),
        );
    }
    body.push_str("</p>\n");
    if !reasons.is_empty() {
        body.push_str("<p>Letters stand for the <a href=\"#why\">reasons</a>.</p>\n");
    }
    if slices.len() < total {
        let count = slices.len();
        put(
            body,
            format_args!("<p>{count} of {total} choices of the other axes are drawn.</p>\n"),
        );
    }
    body.push_str("<div class=\"plots\">\n");
    for slice in &slices {
        let map = slice.answers(sweep.grid, labels, sweep.outcomes, reasons);
        figure(&map.title, "", &map.to_svg()?, body);
        if sweep.subject.kind() != Kind::Model {
            continue;
        }
        for metric in MAPPED {
            let Some(range) = Range::of(sweep.subject, sweep.outcomes, metric) else {
                continue;
            };
            let label = labelled(metric, sweep.subject.unit(metric));
            let data = (sweep.subject, sweep.outcomes);
            let map = slice.shades(sweep.grid, labels, data, metric, &label);
            figure(&map.title, &shades(&range), &map.to_svg()?, body);
        }
    }
    body.push_str("</div></section>\n");
    Ok(())
}

fn shades(range: &Range) -> String {
    let scale = if range.logarithmic() {
        ", at equal ratios"
    } else {
        ""
    };
    format!(
        "<p class=\"legend\">{}<i class=\"shades\" style=\"background: {}\"></i>{}{scale}; x: no proved value</p>\n",
        number(range.low),
        maps::gradient(),
        number(range.high)
    )
}

fn curves(sweep: &Finished, labels: &Labels, body: &mut String) -> Result<(), FigureError> {
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
        return Ok(());
    }
    body.push_str("<section><h2>Curves</h2>\n<div class=\"plots\">\n");
    for &(metric, axis) in wanted.iter().take(PLOTS) {
        let (subject, grid) = (sweep.subject, sweep.grid);
        plot(
            &curve(subject, grid, sweep.outcomes, metric, axis, labels),
            body,
        )?;
    }
    body.push_str("</div>\n");
    if wanted.len() > PLOTS {
        let (count, file) = (wanted.len(), CSV_FILE);
        put(
            body,
            format_args!("<p>{PLOTS} of {count} plots are drawn; every number is in {file}.</p>\n"),
        );
    }
    if !constant.is_empty() {
        let names = escape(&constant.join(", "));
        put(
            body,
            format_args!("<p>The same at every point: {names}.</p>\n"),
        );
    }
    body.push_str("</section>\n");
    Ok(())
}

fn why(sweep: &Finished, labels: &Labels, reasons: &[Reason], body: &mut String) {
    if reasons.is_empty() {
        return;
    }
    body.push_str(
        "<section id=\"why\"><h2>Why points failed</h2>\n<div class=\"wide\"><table>\n\
         <tr><th></th><th>Points</th><th>Verdict</th><th>Reason, with the numbers of the first</th>\
         <th>The first</th></tr>\n",
    );
    for reason in reasons.iter().take(REASONS) {
        let first = reason
            .points
            .first()
            .and_then(|&point| sweep.outcomes.get(point));
        let place = first.map_or(String::new(), |point| place(point, labels));
        put(
            body,
            format_args!(
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                reason.letter,
                reason.points.len(),
                words(&reason.verdict),
                escape(&reason.example),
                escape(&place)
            ),
        );
    }
    body.push_str("</table></div>\n");
    if reasons.len() > REASONS {
        let rest = reasons.len() - REASONS;
        put(
            body,
            format_args!("<p>{rest} more are in {CSV_FILE}.</p>\n"),
        );
    }
    body.push_str("</section>\n");
}

/// The values of a point in words.
fn place(point: &PointOutcome, labels: &Labels) -> String {
    let values = labels.axes.iter().zip(&point.values);
    let values = values.map(|(label, &value)| format!("{label} {}", number(value)));
    values.collect::<Vec<_>>().join(", ")
}

fn points(sweep: &Finished, labels: &Labels, front: &[usize], body: &mut String) {
    let mut columns = metrics(sweep.subject, sweep.outcomes).0;
    if sweep.subject.kind() == Kind::Model {
        columns.push("worst_margin".to_string());
    }
    columns.truncate(8);
    body.push_str("<section><h2>Points</h2>\n<div class=\"wide\"><table class=\"points\">\n<tr>");
    for label in &labels.axes {
        put(body, format_args!("<th>{}</th>", escape(label)));
    }
    body.push_str("<th>verdict</th>");
    for name in &columns {
        let label = labelled(name, sweep.subject.unit(name));
        put(body, format_args!("<th>{}</th>", escape(&label)));
    }
    body.push_str("<th>reason</th></tr>\n");
    let front: HashSet<usize> = front.iter().copied().collect();
    for (index, point) in sweep.outcomes.iter().enumerate().take(ROWS) {
        let class = if front.contains(&index) {
            " class=\"front\""
        } else {
            ""
        };
        put(body, format_args!("<tr{class}>"));
        cells(point.values.iter().copied().map(Some), body);
        let class = if point.good() { "good" } else { "bad" };
        put(
            body,
            format_args!("<td class=\"{class}\">{}</td>", words(&point.verdict)),
        );
        cells(
            columns.iter().map(|name| shown(sweep.subject, point, name)),
            body,
        );
        let reason = point.reason.as_deref().unwrap_or_default();
        put(body, format_args!("<td>{}</td></tr>\n", escape(reason)));
    }
    body.push_str("</table></div>\n");
    let total = sweep.outcomes.len();
    if total > ROWS {
        put(
            body,
            format_args!("<p>The first {ROWS} of {total} points; all are in {CSV_FILE}.</p>\n"),
        );
    }
    if !front.is_empty() {
        body.push_str("<p>Points in bold are on the Pareto front.</p>\n");
    }
    body.push_str("</section>\n");
}

fn footer(sweep: &Finished, body: &mut String) {
    let identity = sweep.identity;
    put(
        body,
        format_args!(
            "<footer>\n<p>{}; {} SHA-256 {}",
            escape(&identity.generator),
            escape(&identity.kind),
            escape(&identity.file_sha256)
        ),
    );
    if let Some(solver) = &identity.solver {
        put(body, format_args!("<br>solver: {}", escape(solver)));
    }
    if let Some(design) = &identity.design_sha256 {
        put(body, format_args!("<br>design SHA-256 {}", escape(design)));
    }
    put(
        body,
        format_args!("<br>every number: {CSV_FILE} and {PARQUET_FILE}</p>\n</footer>\n"),
    );
}
