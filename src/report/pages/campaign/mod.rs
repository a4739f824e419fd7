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
use tables::percent;

use crate::batch::campaign::record::{CampaignFile, Inputs, Results, State};
use crate::report::html::{document, escape, put};

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
    let mut body = String::new();
    header(&record.inputs, results, &mut body);
    tables::counts(&record.inputs, results, &mut body);
    tables::requirements(results, &mut body);
    for figure in figures::bands(folder, results)? {
        figure.write_section(&mut body)?;
    }
    for figure in figures::distributions(folder, results)? {
        figure.write_section(&mut body)?;
    }
    tables::metrics(results, &mut body);
    tables::worst(&data, &record.inputs, results, link, &mut body);
    provenance(&record.inputs, &mut body);
    let title = format!("{}: campaign report", record.inputs.scenario);
    Ok(document(&title, &body))
}

/// The verdict first: how many runs met every requirement, and how well that is known.
fn header(inputs: &Inputs, results: &Results, body: &mut String) {
    let verdict = |name: &str| results.verdicts.get(name).copied().unwrap_or(0);
    let (broken, diverged) = (verdict("proof_broken"), verdict("diverged"));
    let class = match (broken + diverged, results.failures) {
        (0, 0) => "good",
        (0, _) => "bad",
        _ => "alarm",
    };
    let passed = results.runs - results.failures;
    let interval = &results.pass_rate_interval;
    let mut sentence = match results.requirements.is_empty() {
        true => format!(
            "{passed} of {} runs passed; the scenario states no requirement.",
            results.runs
        ),
        false => format!("{passed} of {} runs met every requirement.", results.runs),
    };
    if broken > 0 {
        sentence = format!(
            "A PROVED BOUND WAS BROKEN in {broken} runs: the proof or the program is wrong. {sentence}"
        );
    }
    if diverged > 0 {
        sentence += &format!(" {diverged} diverged.");
    }
    let rate = format!(
        "Pass rate {}; {} % confidence interval {} to {} ({}).",
        percent(results.pass_rate),
        100.0 * interval.confidence,
        percent(interval.lower),
        percent(interval.upper),
        interval.method
    );
    put(
        body,
        format_args!(
            "<header>\n<p class=\"verdict {class}\"><strong>{}</strong> {}</p>\n<h1>{}</h1>\n{}</header>\n",
            escape(&sentence),
            escape(&rate),
            escape(&inputs.scenario),
            tables::caution(inputs)
        ),
    );
}

fn provenance(inputs: &Inputs, body: &mut String) {
    let design = inputs.design_sha256.as_deref().unwrap_or("none");
    put(
        body,
        format_args!(
            "<footer>\n<p>{}; seed {}; runs {} to {} of {}</p>\n\
             <p>scenario SHA-256 {}<br>design SHA-256 {}</p>\n</footer>\n",
            escape(&inputs.generator),
            inputs.seed,
            inputs.first_run,
            inputs.end_run.saturating_sub(1),
            inputs.runs,
            escape(&inputs.scenario_sha256),
            escape(design)
        ),
    );
}
