//! The page of a campaign: how many runs pass, how the errors and metrics are spread, and which runs are
//! the worst.
//!
//! The tables are read a column at a time, so that the memory grows with the runs only, not with the
//! columns.

mod figures;
mod worst;

use std::path::Path;

use synth::claim::Claim;

use super::files::ReportError;
use super::{hashes, optional};
use crate::base::number::{percent, short};
use crate::batch::campaign::record::{CampaignFile, Inputs, Results, State};
use crate::report::html::{
    cell, division, judged, numbers, row, section, source, table, Page, PageKind,
};
use crate::run::summary::RunVerdict;
use crate::scenario::PlanFile;

/// The page of a campaign's folder. `link` is how the page calls the folder, such as `.`.
///
/// # Errors
/// A campaign that is not complete or whose files are not what they should be.
pub fn page(folder: &Path, link: &str) -> Result<String, ReportError> {
    let record = CampaignFile::read(folder)?;
    let inputs = &record.inputs;
    let results = match (record.state, &record.results) {
        (State::Complete, Some(results)) => results,
        _ => return Err(ReportError::Running),
    };
    let worst = worst::worst(folder, inputs, results, link)?;
    let mut sections = vec![section("Runs", &numbers(counts(inputs, results)))];
    sections.extend(optional("Requirements", &requirements(results)));
    let bands = figures::bands(folder, results)?;
    for figure in bands
        .iter()
        .chain(&figures::distributions(folder, results)?)
    {
        sections.push(figure.section()?);
    }
    sections.push(section("Metrics", &metrics(results)));
    sections.push(worst);
    let (class, verdict) = verdict(results);
    let interval = &results.pass_rate_interval;
    let page = Page {
        kind: PageKind::Campaign,
        title: format!("{}: campaign report", inputs.scenario),
        class,
        verdict,
        remark: format!(
            "{} Pass rate {}; {} % confidence interval {} to {} ({}).",
            proof(results),
            percent(results.pass_rate),
            100.0 * interval.confidence,
            format_args!("{} %", Claim::AtLeast(100.0 * interval.lower)),
            format_args!("{} %", Claim::AtMost(100.0 * interval.upper)),
            interval.method
        ),
        heading: inputs.scenario.clone(),
        introduction: caution(inputs),
        sections,
        footer: vec![
            vec![format!(
                "{}; seed {}; runs {} to {} of {}",
                inputs.generator,
                inputs.seed,
                inputs.first_run,
                inputs.end_run.saturating_sub(1),
                inputs.runs
            )],
            hashes(&inputs.scenario_sha256, inputs.design_sha256.as_deref()),
        ],
    };
    Ok(page.to_html())
}

/// How many runs have a verdict.
fn count(results: &Results, verdict: RunVerdict) -> u64 {
    let count = results.verdicts.get(verdict.name());
    count.copied().unwrap_or(0)
}

/// How many runs met every requirement, and how it is shown.
fn verdict(results: &Results) -> (&'static str, String) {
    let broken = count(results, RunVerdict::ProofBroken);
    let diverged = count(results, RunVerdict::Diverged);
    let uncovered = results.covered_runs.is_some_and(|runs| runs < results.runs);
    let class = match (broken + diverged, results.failures) {
        (0, 0) if uncovered => "caution",
        (0, 0) => "good",
        (0, _) => "bad",
        _ => "alarm",
    };
    let (passed, runs) = (results.runs - results.failures, results.runs);
    let mut verdict = match results.requirements.is_empty() {
        true => format!("{passed} of {runs} runs passed; the scenario states no requirement."),
        false => format!("{passed} of {runs} runs met every requirement."),
    };
    if broken > 0 {
        verdict = format!(
            "A PROVED BOUND WAS BROKEN in {broken} runs: the proof or the program is wrong. {verdict}"
        );
    }
    if diverged > 0 {
        verdict += &format!(" {diverged} diverged.");
    }
    (class, verdict)
}

/// Of how many runs something is proved, in a sentence.
fn proof(results: &Results) -> String {
    match results.covered_runs {
        None => "Nothing is proved for this controller.".to_string(),
        Some(covered) if covered == results.runs => "The proof covers every run.".to_string(),
        Some(covered) => format!(
            "The proof covers {covered} of {} runs; the others were simulated only.",
            results.runs
        ),
    }
}

/// How many runs, sampled how, with which verdicts.
fn counts(inputs: &Inputs, results: &Results) -> Vec<(&'static str, String)> {
    let verdicts = [
        ("Every requirement met", RunVerdict::RequirementsMet),
        ("A requirement missed", RunVerdict::RequirementsMissed),
        ("Diverged", RunVerdict::Diverged),
        ("A proved bound broken", RunVerdict::ProofBroken),
    ];
    let mut rows = vec![
        ("Runs", results.runs.to_string()),
        ("Sampled numbers", sampling(inputs).to_string()),
    ];
    rows.extend(verdicts.map(|(name, verdict)| (name, count(results, verdict).to_string())));
    if let Some(covered) = results.covered_runs {
        rows.push(("Covered by the proof of the design", covered.to_string()));
    }
    if let Some(shard) = inputs.shard {
        let text = format!("{} of {}", shard.index, shard.count);
        rows.push(("Part of a larger campaign", text));
    }
    rows
}

fn sampling(inputs: &Inputs) -> &'static str {
    match inputs.sampling {
        PlanFile::Independent => "independent",
        PlanFile::LatinHypercube => "Latin hypercube",
        PlanFile::Sobol => "Sobol sequence",
    }
}

/// What the confidence interval does not say; empty for independent runs.
fn caution(inputs: &Inputs) -> String {
    if inputs.sampling == PlanFile::Independent {
        return String::new();
    }
    source(&format!(
        "The interval is that of independent runs. These runs are spread evenly ({}), so it is a guide only.",
        sampling(inputs)
    ))
}

/// Which requirement was missed how often; empty without requirements.
fn requirements(results: &Results) -> String {
    if results.requirements.is_empty() {
        return String::new();
    }
    let rows = results.requirements.iter().map(|requirement| {
        let fraction = requirement.missed as f64 / results.runs.max(1) as f64;
        row([
            cell(&requirement.name),
            cell(short(requirement.limit)),
            judged(requirement.missed == 0, requirement.missed.to_string()),
            cell(percent(fraction)),
        ])
    });
    let title = ["Requirement", "Limit", "Runs that missed it", "Fraction"];
    table("", title, rows)
}

/// Quantiles of every metric.
fn metrics(results: &Results) -> String {
    let title = [
        "Metric",
        "Runs that have it",
        "Smallest",
        "Median",
        "95 %",
        "Largest",
    ];
    let rows = results.metrics.iter().map(|(name, own)| {
        let numbers = [own.min, own.median, own.p95, own.max].map(short);
        let first = [name.clone(), own.count.to_string()];
        row(first.into_iter().chain(numbers).map(cell))
    });
    division("scroll", &table("ranked", title, rows))
}
