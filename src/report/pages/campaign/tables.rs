//! The tables of a campaign's page.

use super::data::{CampaignData, ListedRun};
use crate::base::number::{percent, short, short_or_none};
use crate::batch::campaign::folder::{run_folder_name, FAILED_FOLDER, SCENARIO_FILE};
use crate::batch::campaign::record::{Inputs, Results};
use crate::report::html::{
    cell, cell_of_class, escape, html_cell, source, HtmlCell, HtmlTable, Section,
};
use crate::run::files::{REPORT_FILE, SUMMARY_FILE, TRAJECTORY_FILE};
use crate::run::summary::RunVerdict;
use crate::scenario::PlanFile;

/// How many runs have a verdict.
pub fn count(results: &Results, verdict: RunVerdict) -> u64 {
    let count = results.verdicts.get(verdict.name());
    count.copied().unwrap_or(0)
}

/// How many runs, drawn how, with which verdicts.
pub fn counts(inputs: &Inputs, results: &Results) -> Section {
    let count = |verdict| count(results, verdict).to_string();
    let mut rows = vec![
        ("Runs", results.runs.to_string()),
        ("Drawn numbers", sampling(inputs).to_string()),
        ("Every requirement met", count(RunVerdict::RequirementsMet)),
        (
            "A requirement missed",
            count(RunVerdict::RequirementsMissed),
        ),
        ("Diverged", count(RunVerdict::Diverged)),
        ("A proved bound broken", count(RunVerdict::ProofBroken)),
    ];
    if let Some(covered) = results.covered_runs {
        rows.push(("Covered by the proof of the design", covered.to_string()));
    }
    if let Some(shard) = inputs.shard {
        let text = format!("{} of {}", shard.index, shard.count);
        rows.push(("Part of a larger campaign", text));
    }
    Section::new("Runs").with_table(&HtmlTable::numbers(&rows))
}

fn sampling(inputs: &Inputs) -> &'static str {
    match inputs.sampling {
        PlanFile::Independent => "independent",
        PlanFile::LatinHypercube => "Latin hypercube",
        PlanFile::Sobol => "Sobol sequence",
    }
}

/// What the confidence interval does not say; empty for independent runs.
pub fn caution(inputs: &Inputs) -> String {
    if inputs.sampling == PlanFile::Independent {
        return String::new();
    }
    source(&format!(
        "The interval is that of independent runs. These runs are spread evenly ({}), so it is a guide only.",
        sampling(inputs)
    ))
}

/// Which requirement was missed how often; none without requirements.
pub fn requirements(results: &Results) -> Option<Section> {
    if results.requirements.is_empty() {
        return None;
    }
    let head = ["Requirement", "Limit", "Runs that missed it", "Share"];
    let mut table = HtmlTable::new("").head(head);
    for requirement in &results.requirements {
        let class = if requirement.missed == 0 {
            "good"
        } else {
            "bad"
        };
        let fraction = requirement.missed as f64 / results.runs.max(1) as f64;
        table.row([
            cell(&requirement.name),
            cell(short(requirement.limit)),
            cell_of_class(class, requirement.missed.to_string()),
            cell(percent(fraction)),
        ]);
    }
    Some(Section::new("Requirements").with_table(&table))
}

/// Quantiles of every metric.
pub fn metrics(results: &Results) -> Section {
    let head = [
        "Metric",
        "Runs that have it",
        "Smallest",
        "Median",
        "95 %",
        "Largest",
    ];
    let mut table = HtmlTable::new("ranked").within("scroll").head(head);
    for (name, quantiles) in &results.metrics {
        let numbers = [
            quantiles.min,
            quantiles.median,
            quantiles.p95,
            quantiles.max,
        ];
        let first = [cell(name), cell(quantiles.count.to_string())];
        let numbers = numbers.map(|number| cell(short(number)));
        table.row(first.into_iter().chain(numbers));
    }
    Section::new("Metrics").with_table(&table)
}

/// The worst runs, each with what is kept of it, or how to run it again.
pub fn worst(data: &CampaignData, inputs: &Inputs, results: &Results, link: &str) -> Section {
    let first = ["Run", "Verdict", "Closest requirement", "Margin"];
    let head = first.into_iter().chain(data.shown.iter().copied());
    let head = head.chain(["Files"]);
    let mut table = HtmlTable::new("ranked").within("scroll").head(head);
    for run in &data.worst {
        table.row(row(run, link));
    }
    let design = match inputs.design_sha256 {
        Some(_) => " --design design.json",
        None => "",
    };
    let total = match inputs.sampling {
        PlanFile::LatinHypercube => format!(" --runs {}", inputs.runs),
        _ => String::new(),
    };
    let again = format!(
        "<p>{} failed runs are kept with their trajectories, {} are not. Any run K can be made again, in the \
         campaign's folder: <code>steadfast simulate {SCENARIO_FILE}{design} --run-index K --seed \
         {}{total} -o run-K</code></p>\n",
        results.kept.len(),
        results.not_kept,
        inputs.seed
    );
    Section::new(&format!("The {} worst runs", data.worst.len()))
        .with(&source(
            "Sorted by verdict, then by the smallest margin relative to its limit (negative: missed).",
        ))
        .with_table(&table)
        .with(&again)
}

fn row(run: &ListedRun, link: &str) -> Vec<HtmlCell> {
    let (class, verdict) = match RunVerdict::named(&run.verdict) {
        Some(RunVerdict::RequirementsMet) => ("good", "met"),
        Some(RunVerdict::RequirementsMissed) => ("bad", "missed"),
        Some(RunVerdict::Diverged) => ("bad", "diverged"),
        Some(RunVerdict::ProofBroken) => ("bad", "PROVED BOUND BROKEN"),
        None => ("bad", run.verdict.as_str()),
    };
    let margin = match run.margin {
        Some(margin) if margin.is_finite() => format!("{:.1}&nbsp;%", 100.0 * margin),
        Some(_) => "has none".to_string(),
        None => String::new(),
    };
    let mut cells = vec![
        cell(run.run.to_string()),
        cell_of_class(class, verdict),
        cell(run.requirement.as_deref().unwrap_or("")),
        html_cell(margin),
    ];
    cells.extend(run.values.iter().map(|&value| cell(short_or_none(value))));
    cells.push(html_cell(files(run, link)));
    cells
}

/// Links to what is kept of a run.
fn files(run: &ListedRun, link: &str) -> String {
    if !run.trajectory {
        return "not kept".to_string();
    }
    let name = run_folder_name(run.run);
    let one = |file: &str, text: &str| {
        let target = escape(&format!("{link}/{FAILED_FOLDER}/{name}/{file}"));
        format!("<a href=\"{target}\">{text}</a>")
    };
    let mut out = vec![
        one(TRAJECTORY_FILE, "trajectory"),
        one(SUMMARY_FILE, "summary"),
    ];
    if run.page {
        out.insert(0, one(REPORT_FILE, "page"));
    }
    out.join(", ")
}
