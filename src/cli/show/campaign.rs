//! The results of a campaign, as text and as JSON.

use std::path::Path;

use serde_json::{json, Value};

use crate::batch::campaign::record::{Inputs, Results};
use crate::cli::answer::print;

/// Prints the results.
pub(crate) fn print_results(results: &Results, inputs: &Inputs, folder: &Path, json: bool) {
    if json {
        print(&object(results, inputs, folder).to_string());
    } else {
        print(&describe(results, inputs, folder));
    }
}

fn object(results: &Results, inputs: &Inputs, folder: &Path) -> Value {
    let mut object = serde_json::to_value(results).unwrap_or_default();
    if let Value::Object(keys) = &mut object {
        keys.insert("scenario".to_string(), json!(inputs.scenario));
        keys.insert("seed".to_string(), json!(inputs.seed));
        keys.insert("shard".to_string(), json!(inputs.shard));
        let folder = folder.to_string_lossy().into_owned();
        keys.insert("folder".to_string(), json!(folder));
    }
    object
}

fn describe(results: &Results, inputs: &Inputs, folder: &Path) -> String {
    let interval = &results.pass_rate_interval;
    let percent = |fraction: f64| 100.0 * fraction;
    let mut lines = vec![
        format!("scenario: {}", inputs.scenario),
        format!("runs: {}; failures: {}", results.runs, results.failures),
        format!(
            "pass rate: {:.4} %, {} % confidence: {:.4} % to {:.4} % ({})",
            percent(results.pass_rate),
            percent(interval.confidence),
            percent(interval.lower),
            percent(interval.upper),
            interval.method
        ),
    ];
    for (verdict, count) in results.verdicts.iter().filter(|(_, count)| **count > 0) {
        lines.push(format!("  {verdict}: {count}"));
    }
    if let Some(covered) = results.covered_runs {
        lines.push(format!("runs that the proof covers: {covered}"));
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
        let number = |value: f64| format!("{value:.6}");
        lines.push(row([
            name.clone(),
            spread.count.to_string(),
            number(spread.min),
            number(spread.median),
            number(spread.p95),
            number(spread.max),
        ]));
    }
    if results.failures > 0 {
        lines.push(format!(
            "failed runs kept with their trajectory: {}; not kept: {} (simulate --run-index makes any again)",
            results.kept.len(),
            results.not_kept
        ));
    }
    lines.push(format!("written: {}", folder.display()));
    lines.join("\n")
}

fn row(cells: [String; 6]) -> String {
    let [name, numbers @ ..] = cells;
    let numbers = numbers.map(|cell| format!("{cell:>14}"));
    format!("{name:<28}{}", numbers.concat())
}
