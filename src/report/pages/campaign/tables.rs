//! The tables of a campaign's page.

use super::data::{CampaignData, ListedRun};
use crate::base::number::short;
use crate::batch::campaign::folder::{run_folder_name, FAILED_FOLDER, SCENARIO_FILE};
use crate::batch::campaign::record::{Inputs, Results};
use crate::report::html::{escape, numbers, put};
use crate::run::files::{REPORT_FILE, SUMMARY_FILE, TRAJECTORY_FILE};
use crate::scenario::PlanFile;

/// A share in percent. Only all is 100 % and only none is 0 %.
pub(crate) fn percent(share: f64) -> String {
    let text = format!("{:.3}", 100.0 * share);
    let text = match text.as_str() {
        "100.000" if share < 1.0 => "99.999".to_string(),
        "0.000" if share > 0.0 => "0.001".to_string(),
        _ => text,
    };
    let short = text.trim_end_matches('0').trim_end_matches('.');
    format!("{short} %")
}

/// How many runs, drawn how, with which verdicts.
pub fn counts(inputs: &Inputs, results: &Results, body: &mut String) {
    let verdict = |name: &str| results.verdicts.get(name).copied().unwrap_or(0).to_string();
    let mut rows = vec![
        ("Runs", results.runs.to_string()),
        ("Drawn numbers", sampling(inputs).to_string()),
        ("Every requirement met", verdict("requirements_met")),
        ("A requirement missed", verdict("requirements_missed")),
        ("Diverged", verdict("diverged")),
        ("A proved bound broken", verdict("proof_broken")),
    ];
    if let Some(covered) = results.covered_runs {
        rows.push(("Covered by the proof of the design", covered.to_string()));
    }
    if let Some(shard) = inputs.shard {
        let text = format!("{} of {}", shard.index, shard.count);
        rows.push(("Part of a larger campaign", text));
    }
    numbers("Runs", &rows, body);
    body.push_str("</section>\n");
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
    format!(
        "<p class=\"source\">The interval is that of independent runs. These runs are spread evenly ({}), \
         so it is a guide only.</p>\n",
        sampling(inputs)
    )
}

/// Which requirement was missed how often.
pub fn requirements(results: &Results, body: &mut String) {
    if results.requirements.is_empty() {
        return;
    }
    body.push_str(
        "<section><h2>Requirements</h2>\n<table>\n\
         <tr><th>Requirement</th><th>Limit</th><th>Runs that missed it</th><th>Share</th></tr>\n",
    );
    for requirement in &results.requirements {
        let class = if requirement.missed == 0 {
            "good"
        } else {
            "bad"
        };
        let share = requirement.missed as f64 / results.runs.max(1) as f64;
        put(
            body,
            format_args!(
                "<tr><td>{}</td><td>{}</td><td class=\"{class}\">{}</td><td>{}</td></tr>\n",
                escape(&requirement.name),
                short(requirement.limit),
                requirement.missed,
                percent(share)
            ),
        );
    }
    body.push_str("</table></section>\n");
}

/// Quantiles of every metric.
pub fn metrics(results: &Results, body: &mut String) {
    body.push_str(
        "<section><h2>Metrics</h2>\n<div class=\"scroll\"><table class=\"ranked\">\n<tr><th>Metric</th>\
         <th>Runs that have it</th><th>Smallest</th><th>Median</th><th>95 %</th><th>Largest</th></tr>\n",
    );
    for (name, spread) in &results.metrics {
        put(
            body,
            format_args!(
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                escape(name),
                spread.count,
                short(spread.min),
                short(spread.median),
                short(spread.p95),
                short(spread.max)
            ),
        );
    }
    body.push_str("</table></div></section>\n");
}

/// The worst runs, each with what is kept of it, or how to run it again.
pub fn worst(
    data: &CampaignData,
    inputs: &Inputs,
    results: &Results,
    link: &str,
    body: &mut String,
) {
    put(
        body,
        format_args!(
            "<section><h2>The {} worst runs</h2>\n<p class=\"source\">Sorted by verdict, then by the \
             smallest margin relative to its limit (negative: missed).</p>\n\
             <div class=\"scroll\"><table class=\"ranked\">\n<tr><th>Run</th><th>Verdict</th>\
             <th>Closest requirement</th><th>Margin</th>",
            data.worst.len()
        ),
    );
    for name in &data.shown {
        put(body, format_args!("<th>{}</th>", escape(name)));
    }
    body.push_str("<th>Files</th></tr>\n");
    for run in &data.worst {
        row(run, link, body);
    }
    body.push_str("</table></div>\n");
    let design = match inputs.design_sha256 {
        Some(_) => " --design design.json",
        None => "",
    };
    let total = match inputs.sampling {
        PlanFile::LatinHypercube => format!(" --runs {}", inputs.runs),
        _ => String::new(),
    };
    put(
        body,
        format_args!(
            "<p>{} failed runs are kept with their trajectories, {} are not. Any run K can be made again, in \
             the campaign's folder: <code>steadfast simulate {SCENARIO_FILE}{design} --run-index K --seed \
             {}{total} -o run-K</code></p></section>\n",
            results.kept.len(),
            results.not_kept,
            inputs.seed
        ),
    );
}

fn row(run: &ListedRun, link: &str, body: &mut String) {
    let (class, verdict) = match run.verdict.as_str() {
        "requirements_met" => ("good", "met"),
        "requirements_missed" => ("bad", "missed"),
        "diverged" => ("bad", "diverged"),
        "proof_broken" => ("bad", "PROVED BOUND BROKEN"),
        other => ("bad", other),
    };
    let margin = match run.margin {
        Some(margin) if margin.is_finite() => percent_signed(margin),
        Some(_) => "has none".to_string(),
        None => String::new(),
    };
    put(
        body,
        format_args!(
            "<tr><td>{}</td><td class=\"{class}\">{}</td><td>{}</td><td>{margin}</td>",
            run.run,
            escape(verdict),
            escape(run.requirement.as_deref().unwrap_or(""))
        ),
    );
    for value in &run.values {
        let value = value.map_or("none".to_string(), short);
        put(body, format_args!("<td>{value}</td>"));
    }
    put(body, format_args!("<td>{}</td></tr>\n", files(run, link)));
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

/// A margin in percent of the limit.
fn percent_signed(margin: f64) -> String {
    format!("{:.1}&nbsp;%", 100.0 * margin)
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
