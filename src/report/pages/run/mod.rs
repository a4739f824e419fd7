//! The page of a run.

pub mod figures;
pub mod inner;
pub mod intermittent;
pub mod prescribed;

use figures::figures;

use crate::base::number::{short, short_or_none};
use crate::base::table::Table;
use crate::plants::SystemKind;
use crate::report::chart::FigureError;
use crate::report::html::{
    cell, cell_of_class, list, paragraph, source, Header, HtmlTable, Page, Section,
};
use crate::run::summary::{CertificateOutcome, RunVerdict, Summary};
use crate::sim::link::LinkOutcome;
use crate::sim::metrics::{listed, Metric};

/// The page of a run.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn page(summary: &Summary, trajectory: &Table) -> Result<String, FigureError> {
    let mut sections = vec![metrics(summary)];
    sections.extend(requirements(summary));
    sections.extend(summary.link.as_ref().map(link));
    sections.extend(summary.certificate.as_ref().map(certificate));
    sections.extend(notes(summary));
    for figure in figures(summary, trajectory) {
        sections.push(figure.section()?);
    }
    let page = Page {
        title: format!("{}: run report", summary.scenario),
        style: "",
        header: header(summary),
        sections,
        footer: provenance(summary),
    };
    Ok(page.to_html())
}

fn header(summary: &Summary) -> Header {
    let class = match summary.verdict {
        RunVerdict::RequirementsMet => "good",
        RunVerdict::RequirementsMissed => "bad",
        RunVerdict::Diverged | RunVerdict::ProofBroken => "alarm",
    };
    let proof = match &summary.certificate {
        Some(outcome) if outcome.broken() => "The proof was broken.",
        Some(outcome) if outcome.covers_run => {
            "The design is proved, the proof covers this run, and the run kept its bound."
        }
        Some(outcome) if outcome.proved => {
            "The design is proved; the proof does not cover this run."
        }
        Some(_) => "The design is NOT proved.",
        None => "Nothing is proved for this controller.",
    };
    let requirements = match (summary.verdict, summary.requirements.is_empty()) {
        (RunVerdict::RequirementsMet, true) => "The scenario states no requirement.",
        (verdict, _) => verdict.sentence(),
    };
    Header {
        class,
        verdict: requirements.to_string(),
        remark: proof.to_string(),
        title: summary.scenario.clone(),
        body: paragraph(&summary.controller) + &source(&summary.source),
    }
}

/// The metrics that every run lists first, after its messages and samples.
const FIRST: [Metric; 5] = [
    Metric::Bytes,
    Metric::Updates,
    Metric::ShortestIntervalS,
    Metric::MeanIntervalS,
    Metric::SettleSeconds,
];

fn metrics(summary: &Summary) -> Section {
    let line = |metric: Metric| {
        let value = match (summary.metric(metric), metric.entry().whole) {
            (Some(count), true) => count.to_string(),
            (value, _) => short_or_none(value),
        };
        (metric.entry().title(), value)
    };
    let mut rows: Vec<(String, String)> = vec![
        line(Metric::Triggers),
        ("Samples".to_string(), summary.samples.to_string()),
    ];
    rows.extend(FIRST.map(line));
    let spacecraft = summary.system == SystemKind::RigidBody;
    for entry in listed(spacecraft) {
        let (title, value) = line(entry.metric);
        // The inputs of another plant have units of their own.
        let title = match entry.metric {
            Metric::MaxTorque if !spacecraft => "Largest input".to_string(),
            Metric::Impulse if !spacecraft => "Integral of the input's magnitude".to_string(),
            _ => title,
        };
        rows.push((title, value));
    }
    rows.extend(bound_rows(summary));
    if summary.held_samples > 0 {
        let reason = summary.first_hold.as_deref().unwrap_or("unknown");
        rows.push((
            "Samples not used".to_string(),
            format!("{} ({reason})", summary.held_samples),
        ));
    }
    if let Some(mismatch) = summary.largest_membership_mismatch {
        rows.push(("Largest membership mismatch".to_string(), short(mismatch)));
    }
    Section::new("Numbers").with_table(&HtmlTable::numbers(&rows))
}

fn link(outcome: &LinkOutcome) -> Section {
    let rows = [
        ("Encoding", outcome.encoding.clone()),
        ("Messages", outcome.messages.to_string()),
        ("Words", outcome.words.to_string()),
        ("Bits sent", outcome.bits.to_string()),
        ("Bytes sent", outcome.bytes.to_string()),
        (
            "Resynchronisation words",
            outcome.resynchronisation_words.to_string(),
        ),
        ("Words lost", outcome.lost_words.to_string()),
        ("Words corrupted", outcome.corrupted_words.to_string()),
        ("Words refused", outcome.refused_words.to_string()),
        (
            "Shortest time between messages (s)",
            short_or_none(outcome.shortest_interval_s),
        ),
        (
            "Longest disagreement of the two ends (s)",
            short(outcome.longest_disagreement_s),
        ),
    ];
    Section::new("Link to the actuators").with_table(&HtmlTable::numbers(&rows))
}

/// Switching and prescribed bounds, for the controllers that have them.
fn bound_rows(summary: &Summary) -> Vec<(String, String)> {
    let mut rows = Vec::new();
    if let (Some(on), Some(off)) = (summary.turn_ons, summary.turn_offs) {
        rows.push(("Turned on; off".to_string(), format!("{on}; {off}")));
        let fraction = short(100.0 * summary.on_time_share);
        rows.push(("Time with a torque (%)".to_string(), fraction));
    }
    let usages = [
        ("Largest error over its prescribed bound", &summary.funnel),
        ("Largest trigger over its threshold", &summary.threshold),
    ];
    for (name, usage) in usages {
        if let Some(usage) = usage {
            let ratio = format!(
                "{:.6} at {} s",
                usage.largest_ratio,
                short(usage.largest_ratio_at_s)
            );
            rows.push((name.to_string(), ratio));
        }
    }
    rows
}

fn requirements(summary: &Summary) -> Option<Section> {
    if summary.requirements.is_empty() {
        return None;
    }
    let mut table = HtmlTable::new("").head(["Requirement", "Limit", "Value", ""]);
    for requirement in &summary.requirements {
        let (class, word) = if requirement.met {
            ("good", "met")
        } else {
            ("bad", "missed")
        };
        table.row([
            cell(&requirement.name),
            cell(short(requirement.limit)),
            cell(short_or_none(requirement.value)),
            cell_of_class(class, word),
        ]);
    }
    Some(Section::new("Requirements").with_table(&table))
}

fn certificate(outcome: &CertificateOutcome) -> Section {
    let yes = |value: bool| if value { "yes" } else { "NO" }.to_string();
    let never =
        |time: Option<f64>| time.map_or("never".to_string(), |t| format!("at {} s", short(t)));
    let mut rows: Vec<(&str, String)> = vec![
        ("Design proved from its numbers", yes(outcome.proved)),
        ("Proof covers this run", yes(outcome.covers_run)),
        (
            "x'Ux at the start (certified set: at most 1)",
            short(outcome.start_level),
        ),
        (
            "Largest x'Ux over its bound",
            format!(
                "{:.6} at {} s",
                outcome.largest_lyapunov_ratio,
                short(outcome.largest_lyapunov_ratio_at_s)
            ),
        ),
        (
            "Steps above the bound",
            outcome.bound_broken_steps.to_string(),
        ),
        (
            "Left the invariant set",
            never(outcome.left_invariant_set_s),
        ),
        ("Left the box of the model", never(outcome.left_box_s)),
        ("Largest output", short(outcome.peak_output)),
        ("Largest disturbance", short(outcome.peak_disturbance)),
        (
            "Guaranteed gain; gamma",
            format!(
                "{}; {}",
                short(outcome.guaranteed_gain),
                short(outcome.gamma)
            ),
        ),
    ];
    if let (Some(margin), Some(name)) = (outcome.worst_margin, &outcome.worst_condition) {
        rows.push(("Smallest margin", format!("{margin:.3e} ({name})")));
    }
    if let Some(ratio) = outcome.peak_ratio {
        let from = if outcome.from_rest_in_origin {
            short(ratio)
        } else {
            format!(
                "{} (no test of the gain: the run does not start in the origin)",
                short(ratio)
            )
        };
        rows.push(("Largest output over largest disturbance", from));
    }
    rows.extend(inner::rows(outcome));
    let section = Section::new("Certificate").with_table(&HtmlTable::numbers(&rows));
    if outcome.not_covered.is_empty() {
        return section;
    }
    section
        .with(&paragraph("The proof does not cover this run because of:"))
        .with(&list(&outcome.not_covered))
}

fn notes(summary: &Summary) -> Option<Section> {
    if summary.notes.is_empty() {
        return None;
    }
    Some(Section::new("Notes").with(&list(&summary.notes)))
}

fn provenance(summary: &Summary) -> Vec<Vec<String>> {
    let made = &summary.provenance;
    let design = made.design_sha256.as_deref().unwrap_or("none");
    vec![
        vec![format!(
            "{}; {}; random numbers: {} with seed {}",
            made.generator, made.integrator, made.random_generator, made.seed
        )],
        vec![
            format!("scenario SHA-256 {}", made.scenario_sha256),
            format!("design SHA-256 {design}"),
        ],
    ]
}
