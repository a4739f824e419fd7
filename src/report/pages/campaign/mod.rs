//! The page of a campaign: how many runs pass, how the errors and metrics are spread, and which runs are
//! the worst.
//!
//! The tables are read a column at a time, so that the memory grows with the runs only, not with the
//! columns.

mod data;
pub mod error;
mod figures;
mod tables;

use std::path::Path;

use error::CampaignPageError;

use crate::base::number::percent;
use crate::batch::campaign::record::{CampaignFile, Inputs, Results, State};
use crate::report::html::{Header, Page};
use crate::run::summary::RunVerdict;

pub use data::CampaignData;

/// The page of a campaign's folder. `link` is how the page calls the folder, such as `.`.
///
/// # Errors
/// A campaign that is not complete or whose files are not what they should be.
pub fn page(folder: &Path, link: &str) -> Result<String, CampaignPageError> {
    let record = CampaignFile::read(folder)?;
    let results = match (record.state, &record.results) {
        (State::Complete, Some(results)) => results,
        _ => return Err(CampaignPageError::Running),
    };
    let data = CampaignData::read(folder, results)?;
    let mut sections = vec![tables::counts(&record.inputs, results)];
    sections.extend(tables::requirements(results));
    let mut drawn = figures::bands(folder, results)?;
    drawn.extend(figures::distributions(folder, results)?);
    for figure in drawn {
        sections.push(figure.section()?);
    }
    sections.push(tables::metrics(results));
    sections.push(tables::worst(&data, &record.inputs, results, link));
    let page = Page {
        title: format!("{}: campaign report", record.inputs.scenario),
        style: "",
        header: header(&record.inputs, results),
        sections,
        footer: provenance(&record.inputs),
    };
    Ok(page.to_html())
}

/// The verdict first: how many runs met every requirement, and how well that is known.
fn header(inputs: &Inputs, results: &Results) -> Header {
    let broken = tables::count(results, RunVerdict::ProofBroken);
    let diverged = tables::count(results, RunVerdict::Diverged);
    let class = match (broken + diverged, results.failures) {
        (0, 0) => "good",
        (0, _) => "bad",
        _ => "alarm",
    };
    let passed = results.runs - results.failures;
    let interval = &results.pass_rate_interval;
    let mut verdict = match results.requirements.is_empty() {
        true => format!(
            "{passed} of {} runs passed; the scenario states no requirement.",
            results.runs
        ),
        false => format!("{passed} of {} runs met every requirement.", results.runs),
    };
    if broken > 0 {
        verdict = format!(
            "A PROVED BOUND WAS BROKEN in {broken} runs: the proof or the program is wrong. {verdict}"
        );
    }
    if diverged > 0 {
        verdict += &format!(" {diverged} diverged.");
    }
    let remark = format!(
        "Pass rate {}; {} % confidence interval {} to {} ({}).",
        percent(results.pass_rate),
        100.0 * interval.confidence,
        percent(interval.lower),
        percent(interval.upper),
        interval.method
    );
    Header {
        class,
        verdict,
        remark,
        title: inputs.scenario.clone(),
        body: tables::caution(inputs),
    }
}

fn provenance(inputs: &Inputs) -> Vec<Vec<String>> {
    let design = inputs.design_sha256.as_deref().unwrap_or("none");
    vec![
        vec![format!(
            "{}; seed {}; runs {} to {} of {}",
            inputs.generator,
            inputs.seed,
            inputs.first_run,
            inputs.end_run.saturating_sub(1),
            inputs.runs
        )],
        vec![
            format!("scenario SHA-256 {}", inputs.scenario_sha256),
            format!("design SHA-256 {design}"),
        ],
    ]
}
