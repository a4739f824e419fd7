//! The worst runs of a campaign, each with what is kept of it, or how to run it again.

use std::path::Path;

use crate::base::number::{short, short_or_none};
use crate::batch::campaign::folder::{
    run_folder, run_folder_name, FAILED_FOLDER, RUNS_FILE, SCENARIO_FILE,
};
use crate::batch::campaign::record::{Inputs, Results};
use crate::batch::campaign::table::{column_f64, column_text};
use crate::batch::campaign::CampaignError;
use crate::report::html::{cell, division, escape, html_cell, judged, row, section, source, table};
use crate::run::files::{REPORT_FILE, SUMMARY_FILE, TRAJECTORY_FILE};
use crate::run::summary::RunVerdict;
use crate::scenario::PlanFile;
use crate::sim::metrics::METRICS;

/// Runs in the list.
const LISTED: usize = 20;
/// Metrics shown of them, where the campaign has them.
const SHOWN: [&str; 6] = [
    "settle_seconds",
    "final_error_deg",
    "tail_error_deg",
    "final_state_norm",
    "triggers",
    "lyapunov_ratio",
];

/// A run of the list.
struct ListedRun {
    /// Its index.
    run: u64,
    /// Its verdict as files have it.
    verdict: String,
    /// The requirement with the smallest margin.
    requirement: String,
    /// That margin, relative to the limit; negative when it is missed.
    margin: Option<f64>,
    /// Whether the limit is 0, so that nothing is relative to it.
    absolute: bool,
    /// Values of the metrics shown.
    values: Vec<Option<f64>>,
}

/// The section; `link` is how the page calls the folder.
pub fn worst(
    folder: &Path,
    inputs: &Inputs,
    results: &Results,
    link: &str,
) -> Result<String, CampaignError> {
    let mut shown = SHOWN.to_vec();
    shown.retain(|name| results.metrics.contains_key(*name));
    let worst = listed(folder, results, &shown)?;
    let first = ["Run", "Verdict", "Closest requirement", "Margin"];
    let names = first
        .into_iter()
        .chain(shown.iter().copied())
        .chain(["Files"]);
    let rows = worst.iter().map(|run| line(run, &shown, folder, link));
    let rows = table("ranked", names, rows);
    let order =
        "Sorted by verdict, then by the smallest margin relative to its limit, or the margin itself where the \
         limit is 0 (negative: missed).";
    let html = source(order) + &division("scroll", &rows) + &again(inputs, results);
    Ok(section(&format!("The {} worst runs", worst.len()), &html))
}

/// The worst runs of a folder first, with the values of these metrics.
fn listed(
    folder: &Path,
    results: &Results,
    shown: &[&str],
) -> Result<Vec<ListedRun>, CampaignError> {
    let runs = folder.join(RUNS_FILE);
    let verdicts = column_text(&runs, "verdict")?;
    let requirements = column_text(&runs, "worst_requirement")?;
    let margins = column_f64(&runs, "worst_margin")?;
    let indices = column_f64(&runs, "run")?;
    let shown = shown.iter().map(|name| column_f64(&runs, name));
    let columns = shown.collect::<Result<Vec<_>, _>>()?;
    let number = |column: &[Option<f64>], place: usize| column.get(place).copied().flatten();
    let text = |column: &[Option<String>], place: usize| {
        let text = column.get(place).cloned().flatten();
        text.unwrap_or_default()
    };
    let severity = |place: usize| {
        let known = RunVerdict::named(&text(&verdicts, place));
        known.map_or(RunVerdict::ALL.len(), RunVerdict::severity)
    };
    let mut order: Vec<usize> = (0..verdicts.len()).collect();
    order.sort_by(|&a, &b| {
        let margin = |place| number(&margins, place).unwrap_or(0.0);
        let severities = severity(a).cmp(&severity(b));
        severities
            .then(margin(a).total_cmp(&margin(b)))
            .then(a.cmp(&b))
    });
    let worst = order.into_iter().take(LISTED).map(|place| ListedRun {
        run: number(&indices, place).unwrap_or(0.0) as u64,
        verdict: text(&verdicts, place),
        requirement: text(&requirements, place),
        margin: number(&margins, place),
        absolute: {
            let name = text(&requirements, place);
            let mut own = results.requirements.iter();
            own.any(|requirement| requirement.name == name && requirement.limit == 0.0)
        },
        values: columns.iter().map(|column| number(column, place)).collect(),
    });
    Ok(worst.collect())
}

fn line(run: &ListedRun, shown: &[&str], folder: &Path, link: &str) -> String {
    let verdict = RunVerdict::named(&run.verdict);
    let word = match verdict {
        Some(RunVerdict::RequirementsMet) => "met",
        Some(RunVerdict::RequirementsMissed) => "missed",
        Some(RunVerdict::Diverged) => "diverged",
        Some(RunVerdict::ProofBroken) => "PROVED BOUND BROKEN",
        None => run.verdict.as_str(),
    };
    let margin = match run.margin {
        Some(margin) if margin.is_finite() && run.absolute => short(margin),
        Some(margin) if margin.is_finite() => format!("{:.1}&nbsp;%", 100.0 * margin),
        Some(_) => "has none".to_string(),
        None => String::new(),
    };
    let first = [
        cell(run.run.to_string()),
        judged(verdict == Some(RunVerdict::RequirementsMet), word),
        cell(&run.requirement),
        html_cell(&margin),
    ];
    let values = run.values.iter().zip(shown);
    let values = values.map(|(&value, name)| {
        let entry = METRICS.iter().find(|entry| entry.key == *name);
        cell(entry.map_or_else(|| short_or_none(value), |entry| entry.text(value)))
    });
    let files = html_cell(&files(run.run, folder, link));
    row(first.into_iter().chain(values).chain([files]))
}

/// Links to what is kept of a run.
fn files(run: u64, folder: &Path, link: &str) -> String {
    let kept = run_folder(folder, run);
    if !kept.join(TRAJECTORY_FILE).exists() {
        return "not kept".to_string();
    }
    let name = run_folder_name(run);
    let files = [
        (REPORT_FILE, "page"),
        (TRAJECTORY_FILE, "trajectory"),
        (SUMMARY_FILE, "summary"),
    ];
    let there = files
        .into_iter()
        .filter(|(file, _)| *file != REPORT_FILE || kept.join(file).exists());
    let links = there.map(|(file, text)| {
        let target = escape(&format!("{link}/{FAILED_FOLDER}/{name}/{file}"));
        format!("<a href=\"{target}\">{text}</a>")
    });
    links.collect::<Vec<_>>().join(", ")
}

/// The command that makes any run again.
fn again(inputs: &Inputs, results: &Results) -> String {
    let design = match inputs.design_sha256 {
        Some(_) => " --design design.json",
        None => "",
    };
    let total = match inputs.sampling {
        PlanFile::LatinHypercube => format!(" --runs {}", inputs.runs),
        _ => String::new(),
    };
    format!(
        "<p>{} failed runs are kept with their trajectories, {} are not. Any run K can be made again, in the \
         campaign's folder: <code>steadfast simulate {SCENARIO_FILE}{design} --run-index K --seed \
         {}{total} -o run-K</code></p>\n",
        results.kept.len(),
        results.not_kept,
        inputs.seed
    )
}
