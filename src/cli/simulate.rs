//! `steadfast simulate SCENARIO.json`

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use super::campaign::{check_runs, told, unplanned};
use super::{files, print, CliError, EXIT_NO};
use crate::harness::campaign::plan::Plan;
use crate::harness::design::Design;
use crate::harness::link::LinkOutcome;
use crate::harness::output::{summary_text, write_run};
use crate::harness::scenario::{ControllerChoice, PlanFile, Scenario};
use crate::harness::simulation::{simulate, Outcome, SimulateError};
use crate::harness::summary::{CertificateOutcome, RunVerdict, Summary};

/// Arguments of `simulate`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct SimulateArgs {
    /// Scenario file
    scenario: PathBuf,
    /// Design file, for scenarios whose controller is a design
    #[arg(long)]
    design: Option<PathBuf>,
    /// Make one run of the scenario's campaign, by its index from 0
    #[arg(long, value_name = "K")]
    run_index: Option<u64>,
    /// Seed of the campaign; that of the scenario when left out
    #[arg(long, requires = "run_index")]
    seed: Option<u64>,
    /// Number of runs of the campaign; needed with a Latin hypercube
    #[arg(long, value_name = "N", requires = "run_index")]
    runs: Option<u64>,
    /// Folder for trajectory.csv, summary.json and report.html
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Runs a scenario. 0: every requirement is met; 2: one is missed, the run diverged or a proved bound
/// was broken.
pub fn run(args: &SimulateArgs) -> Result<ExitCode, CliError> {
    let text = files::text(&args.scenario)?;
    let scenario = Scenario::from_json(&text).map_err(|e| CliError::file(&args.scenario, e))?;
    if let Some(folder) = &args.output {
        files::check_folder(folder)?;
    }
    let design = design_of(&scenario, &args.scenario, args.design.as_deref())?;
    let outcome = match args.run_index {
        Some(run) => run_of_campaign(args, &text, &scenario, design.as_ref(), run)?,
        None => simulate(&scenario, design.as_ref(), args.output.is_some())
            .map_err(|error| CliError::unsuitable(&args.scenario, error))?,
    };
    if let Some(folder) = &args.output {
        write_run(folder, &outcome)?;
        eprintln!("written: {}", folder.join("report.html").display());
    }
    let summary = &outcome.summary;
    if args.json {
        print(summary_text(summary).trim_end());
    } else {
        print(&describe(summary));
    }
    if summary.verdict == RunVerdict::ProofBroken {
        eprintln!("{}", summary.verdict.sentence());
    }
    Ok(match summary.verdict {
        RunVerdict::RequirementsMet => ExitCode::SUCCESS,
        _ => ExitCode::from(EXIT_NO),
    })
}

/// The command line's design, or the scenario's, whose path starts at the scenario's folder; its
/// verdict goes to standard error.
pub(super) fn design_of(
    scenario: &Scenario,
    scenario_path: &Path,
    given: Option<&Path>,
) -> Result<Option<Design>, CliError> {
    let Some(path) = design_path(scenario, scenario_path, given) else {
        return Ok(None);
    };
    let needs_one = matches!(scenario.controller, ControllerChoice::Design(_));
    if given.is_some() && !needs_one {
        let error = SimulateError::UnusedDesign;
        return Err(CliError::unsuitable(scenario_path, error));
    }
    let design = read_design(&path)?;
    announce(&design);
    Ok(Some(design))
}

/// Path of the command line's design, or of the scenario's.
pub(super) fn design_path(
    scenario: &Scenario,
    scenario_path: &Path,
    given: Option<&Path>,
) -> Option<PathBuf> {
    match (given, &scenario.controller) {
        (Some(path), _) => Some(path.to_path_buf()),
        (None, ControllerChoice::Design(Some(file))) => {
            Some(scenario_path.parent().unwrap_or(Path::new(".")).join(file))
        }
        (None, _) => None,
    }
}

/// The very run that a campaign makes.
fn run_of_campaign(
    args: &SimulateArgs,
    text: &str,
    scenario: &Scenario,
    design: Option<&Design>,
    run: u64,
) -> Result<Outcome, CliError> {
    let sampling = scenario.dispersions.as_ref().map(|all| all.sampling);
    let wrong = |argument, reason: String| Err(CliError::Argument { argument, reason });
    let runs = match args.runs {
        Some(runs) => runs,
        None if sampling == Some(PlanFile::LatinHypercube) => {
            let reason = "is needed, because a Latin hypercube depends on it".to_string();
            return wrong("--runs", reason);
        }
        None => run.saturating_add(1),
    };
    check_runs(runs)?;
    if run >= runs {
        let reason = format!("{run} is not allowed; it must be from 0 to {}", runs - 1);
        return wrong("--run-index", reason);
    }
    let plan = Plan::new(text, design, args.seed, runs);
    let plan = plan.map_err(|error| unplanned(&args.scenario, error))?;
    let outcome = plan.alone(run, args.output.is_some());
    let (_, outcome) = outcome.map_err(|error| told(&args.scenario, error))?;
    Ok(outcome)
}

pub(super) fn read_design(path: &Path) -> Result<Design, CliError> {
    let text = files::text(path)?;
    Design::from_json(&text).map_err(|error| CliError::file(path, error))
}

/// Says on standard error whether the design is proved, before it is used.
fn announce(design: &Design) {
    let verdict = if design.proved() {
        "PROVED"
    } else {
        "NOT PROVED"
    };
    match design.report.worst() {
        Some(worst) => eprintln!(
            "design '{}': {verdict}, smallest margin {:.3e} ({})",
            design.file.name, worst.margin, worst.name
        ),
        None => eprintln!("design '{}': {verdict}", design.file.name),
    }
}

fn describe(summary: &Summary) -> String {
    let mut lines = vec![
        format!("scenario: {}", summary.scenario),
        format!("controller: {}", summary.controller),
        format!("verdict: {}", summary.verdict.sentence()),
        format!(
            "messages: {} in {} samples, {} bytes; torque updates: {}",
            summary.triggers, summary.samples, summary.bytes, summary.updates
        ),
    ];
    let interval = (summary.shortest_interval_s, summary.mean_interval_s);
    if let (Some(shortest), Some(mean)) = interval {
        lines.push(format!(
            "between messages: {shortest:.4} s shortest, {mean:.3} s mean"
        ));
    }
    let bound = summary.max_transmissions_per_s;
    lines.push(match (summary.min_inter_event_s, bound) {
        (Some(shortest), Some(most)) => format!(
            "messages per second: {:.4}; the sampling allows one every {shortest} s, {most:.6} per second",
            summary.triggers_per_s
        ),
        _ => format!("messages per second: {:.4}", summary.triggers_per_s),
    });
    lines.push(match summary.settle_seconds {
        Some(seconds) => format!("settled: from {seconds:.3} s on"),
        None => "settled: no".to_string(),
    });
    let errors = [
        ("final error", summary.final_error_deg, "deg"),
        ("rms error over the tail", summary.rms_error_deg, "deg"),
        ("norm of the final state", summary.final_state_norm, ""),
        ("rms norm over the tail", summary.rms_state_norm, ""),
        ("largest rate", summary.max_rate, "rad/s"),
    ];
    for (name, value, unit) in errors {
        if let Some(value) = value {
            lines.push(format!("{name}: {value:.5} {unit}").trim_end().to_string());
        }
    }
    // The inputs of a plant that is no spacecraft have units of their own.
    let (input, unit, impulse_unit) = match summary.system == "rigid_body" {
        true => ("torque", " N m", " N m s"),
        false => ("input", "", ""),
    };
    lines.push(format!(
        "largest {input}: {:.4}{unit}; impulse: {:.4}{impulse_unit}",
        summary.max_torque, summary.impulse
    ));
    if let Some(link) = &summary.link {
        describe_link(link, &mut lines);
    }
    describe_bounds(summary, &mut lines);
    if let Some(outcome) = &summary.certificate {
        describe_certificate(outcome, &mut lines);
    }
    for requirement in &summary.requirements {
        let met = if requirement.met { "met" } else { "MISSED" };
        let value = requirement
            .value
            .map_or("none".to_string(), |value| value.to_string());
        lines.push(format!(
            "requirement {} {}: {value}, {met}",
            requirement.name, requirement.limit
        ));
    }
    lines.extend(summary.notes.iter().map(|note| format!("note: {note}")));
    lines.join("\n")
}

fn describe_link(link: &LinkOutcome, lines: &mut Vec<String>) {
    lines.push(format!("link: {}", link.encoding));
    lines.push(format!(
        "link messages: {}; words: {}; bits: {}",
        link.messages, link.words, link.bits
    ));
    if link.lost_words + link.corrupted_words > 0 {
        lines.push(format!(
            "link words lost: {}; corrupted: {}; refused: {}; longest disagreement: {:.3} s",
            link.lost_words, link.corrupted_words, link.refused_words, link.longest_disagreement_s
        ));
    }
}

/// Switching and prescribed bounds, for the controllers that have them.
fn describe_bounds(summary: &Summary, lines: &mut Vec<String>) {
    if let (Some(on), Some(off)) = (summary.turn_ons, summary.turn_offs) {
        let share = 100.0 * summary.on_time_share;
        lines.push(format!(
            "actuators: turned on {on} and off {off} times, {share:.1} % of the time with a torque"
        ));
    }
    let usages = [
        ("error over its prescribed bound", &summary.funnel),
        ("trigger over its threshold", &summary.threshold),
    ];
    for (name, usage) in usages {
        if let Some(usage) = usage {
            lines.push(format!(
                "largest {name}: {:.6} at {:.3} s",
                usage.largest_ratio, usage.largest_ratio_at_s
            ));
        }
    }
}

fn describe_certificate(outcome: &CertificateOutcome, lines: &mut Vec<String>) {
    let proved = if outcome.proved {
        "proved"
    } else {
        "NOT proved"
    };
    lines.push(format!(
        "design: {proved}; x'Ux at the start {:.4}",
        outcome.start_level
    ));
    lines.push(format!(
        "largest x'Ux over its bound: {:.6} at {:.3} s",
        outcome.largest_lyapunov_ratio, outcome.largest_lyapunov_ratio_at_s
    ));
    if let Some(ratio) = outcome.peak_ratio.filter(|_| outcome.from_rest_in_origin) {
        lines.push(format!(
            "sup|y| / sup|tau| from rest: {ratio:.5}; guaranteed: {:.5}; gamma: {:.5}",
            outcome.guaranteed_gain, outcome.gamma
        ));
    }
    if let Some(inner) = &outcome.inner {
        lines.push(inner.sentence());
    }
    if outcome.covers_run {
        lines.push("the proof covers this run".to_string());
    } else {
        lines.push("the proof does not cover this run:".to_string());
        let reasons = outcome.not_covered.iter();
        lines.extend(reasons.map(|reason| format!("  - {reason}")));
    }
}
