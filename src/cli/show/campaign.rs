//! The results of a campaign.

use std::path::Path;

use serde::Serialize;
use synth::claim::Claim;

use super::facts::written;
use crate::base::number::short;
use crate::batch::campaign::record::{Inputs, Results};
use crate::batch::store::chunks::Shard;
use crate::cli::answer::{Answer, Exit};

/// The results, and what they are about.
#[derive(Debug, Serialize)]
struct CampaignReport<'a> {
    /// The results.
    #[serde(flatten)]
    results: &'a Results,
    /// Name of the scenario.
    scenario: &'a str,
    /// Seed of the campaign.
    seed: u64,
    /// The part of the campaign; null for all of it.
    shard: Option<Shard>,
    /// Where the files are.
    folder: String,
}

/// Yes where every run met every requirement.
pub fn answer(results: &Results, inputs: &Inputs, folder: &Path) -> Answer {
    let report = CampaignReport {
        results,
        scenario: &inputs.scenario,
        seed: inputs.seed,
        shard: inputs.shard,
        folder: folder.to_string_lossy().into_owned(),
    };
    let exit = Exit::of(results.failures == 0);
    Answer::new(exit, &report, &lines(results, inputs, folder))
}

fn lines(results: &Results, inputs: &Inputs, folder: &Path) -> Vec<String> {
    let interval = &results.pass_rate_interval;
    let percent = |share: f64| 100.0 * share;
    let mut lines = vec![
        format!("scenario: {}", inputs.scenario),
        format!("runs: {}; failures: {}", results.runs, results.failures),
        format!(
            "pass rate: {} %, {} % confidence: {} % to {} % ({})",
            Claim::AtLeast(percent(results.pass_rate)),
            percent(interval.confidence),
            Claim::AtLeast(percent(interval.lower)),
            Claim::AtMost(percent(interval.upper)),
            interval.method
        ),
    ];
    for (verdict, count) in results.verdicts.iter().filter(|(_, count)| **count > 0) {
        lines.push(format!("  {verdict}: {count}"));
    }
    if let Some(covered) = results.covered_runs {
        let hint = match covered < results.runs {
            true => " (simulate --run-index says of any why it is not covered)",
            false => "",
        };
        lines.push(format!("runs that the proof covers: {covered}{hint}"));
    }
    for requirement in &results.requirements {
        lines.push(format!(
            "requirement {} {}: missed in {} runs",
            requirement.name, requirement.limit, requirement.missed
        ));
    }
    let title = ["metric", "runs", "min", "median", "p95", "max"];
    lines.push(row(title.map(str::to_string)));
    for (name, spread) in &results.metrics {
        lines.push(row([
            name.clone(),
            spread.count.to_string(),
            short(spread.min),
            short(spread.median),
            short(spread.p95),
            short(spread.max),
        ]));
    }
    if results.failures > 0 {
        lines.push(format!(
            "failed runs kept with their trajectory: {}; not kept: {} (simulate --run-index makes any again)",
            results.kept.len(),
            results.not_kept
        ));
    }
    lines.push(written(folder));
    lines
}

fn row(cells: [String; 6]) -> String {
    let [name, numbers @ ..] = cells;
    let numbers = numbers.map(|cell| format!("{cell:>14}"));
    format!("{name:<28}{}", numbers.concat())
}
