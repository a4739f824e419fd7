//! The page of a campaign: how many runs pass, how the errors and metrics are spread, and which runs are
//! the worst.
//!
//! The tables are read a column at a time, so that the memory grows with the runs only, not with the
//! columns.

mod data;
mod figures;
mod tables;

use std::path::Path;

use super::page::{document, escape, put};
use super::FigureError;
use crate::harness::campaign::record::{CampaignFile, Inputs, Results, State};
use crate::harness::campaign::CampaignError;

pub use data::CampaignData;

/// Why a campaign's page cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum CampaignPageError {
    /// Its files.
    #[error(transparent)]
    Campaign(#[from] CampaignError),
    /// The campaign is still running.
    #[error(
        "the campaign is not complete; the same `campaign` command goes on where it stopped, and then \
         there is a report"
    )]
    Running,
    /// A figure.
    #[error("the report's figures cannot be drawn: {0}")]
    Figure(#[from] FigureError),
}

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

/// A share in percent. Only all is 100 % and only none is 0 %.
fn percent(share: f64) -> String {
    let text = format!("{:.3}", 100.0 * share);
    let text = match text.as_str() {
        "100.000" if share < 1.0 => "99.999".to_string(),
        "0.000" if share > 0.0 => "0.001".to_string(),
        _ => text,
    };
    let short = text.trim_end_matches('0').trim_end_matches('.');
    format!("{short} %")
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

#[cfg(test)]
mod tests {
    use super::percent;

    #[test]
    fn only_all_is_100_percent() {
        assert_eq!(percent(1.0), "100 %");
        assert_eq!(percent(0.999_999_9), "99.999 %");
        assert_eq!(percent(0.9988), "99.88 %");
        assert_eq!(percent(1e-9), "0.001 %");
        assert_eq!(percent(0.0), "0 %");
    }
}
