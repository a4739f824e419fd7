//! The page of a run.

mod figures;
use synth::claim::Claim;

use super::{hashes, optional};
use crate::base::number::{short, short_or_none};
use crate::base::table::Table;
use crate::plants::SystemKind;
use crate::report::chart::FigureError;
use crate::report::html::{
    cell, escape, judged, list, numbers, paragraph, row, section, source, table, Page, PageKind,
};
use crate::run::summary::{CertificateOutcome, InnerOutcome, RunVerdict, Summary};
use crate::sim::link::LinkOutcome;
use crate::sim::metrics::{listed, Metric};
use crate::sim::network::NetworkOutcome;

/// The page of a run.
///
/// # Errors
/// A figure that cannot be drawn.
pub fn page(summary: &Summary, trajectory: &Table) -> Result<String, FigureError> {
    let certificate = summary.certificate.as_ref();
    let mut sections = vec![section("Numbers", &numbers(metrics(summary)))];
    sections.extend(optional("Requirements", &requirements(summary)));
    let link = summary.link.as_ref();
    sections.extend(link.map(|link| section("Link to the actuators", &numbers(link_rows(link)))));
    let network = summary.network.as_ref();
    sections.extend(network.map(|network| section("Network", &numbers(network_rows(network)))));
    sections.extend(certificate.map(certificate_section));
    let notes = summary.notes.iter().map(|note| escape(note));
    sections.extend((!summary.notes.is_empty()).then(|| section("Notes", &list(notes))));
    for figure in figures::figures(summary, trajectory) {
        sections.push(figure.section()?);
    }
    let made = &summary.provenance;
    let page = Page {
        kind: PageKind::Run,
        title: format!("{}: run report", summary.scenario),
        class: match summary.verdict {
            RunVerdict::RequirementsMet if is_doubtful(summary) => "caution",
            RunVerdict::RequirementsMet => "good",
            RunVerdict::RequirementsMissed => "bad",
            RunVerdict::Diverged | RunVerdict::ProofBroken => "alarm",
        },
        verdict: match (summary.verdict, summary.requirements.is_empty()) {
            (RunVerdict::RequirementsMet, true) => "The scenario states no requirement.",
            (verdict, _) => verdict.sentence(),
        }
        .to_string(),
        remark: remark(summary),
        heading: summary.scenario.clone(),
        introduction: paragraph(&summary.controller) + &source(&summary.source),
        sections,
        footer: vec![
            vec![format!(
                "{}; {}; random numbers: {} with seed {}",
                made.generator, made.integrator, made.random_generator, made.seed
            )],
            hashes(&made.scenario_sha256, made.design_sha256.as_deref()),
        ],
    };
    Ok(page.to_html())
}

/// Whether a run that meets its requirements still is none to be content with: the proof of its design does not cover
/// it, or it did not settle.
fn is_doubtful(summary: &Summary) -> bool {
    let uncovered = summary.certificate.as_ref();
    let uncovered = uncovered.is_some_and(|outcome| !outcome.covers_run);
    uncovered || summary.unsettled().is_some()
}

/// What stands beside the verdict: what is proved, and that the run did not settle.
fn remark(summary: &Summary) -> String {
    let proof = proof(summary.certificate.as_ref()).to_string();
    [Some(proof), summary.unsettled()]
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(" ")
}

/// What is proved of a run, in a sentence.
fn proof(certificate: Option<&CertificateOutcome>) -> &'static str {
    match certificate {
        Some(outcome) if outcome.broken() => "The proof was broken.",
        Some(outcome) if outcome.covers_run => {
            "The design is proved, the proof covers this run, and the run kept its bound."
        }
        Some(outcome) if outcome.proved => {
            "The design is proved; the proof does not cover this run."
        }
        Some(_) => "The design is NOT proved.",
        None => "Nothing is proved for this controller.",
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

fn metrics(summary: &Summary) -> Vec<(String, String)> {
    let line = |metric: Metric| {
        let entry = metric.entry();
        (entry.title(), entry.text(summary.metric(metric)))
    };
    let mut rows = vec![
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
    let mut more = |name: &str, value: String| rows.push((name.to_string(), value));
    if let (Some(on), Some(off)) = (summary.turn_ons, summary.turn_offs) {
        more("Turned on; off", format!("{on}; {off}"));
        let fraction = short(100.0 * summary.on_time_share);
        more("Time with a torque (%)", fraction);
    }
    let utilisations = [
        ("Largest error over its prescribed bound", &summary.funnel),
        ("Largest trigger over its threshold", &summary.threshold),
    ];
    for (name, utilisation) in utilisations {
        if let Some(own) = utilisation {
            more(name, ratio_at(own.largest_ratio, own.largest_ratio_at_s));
        }
    }
    if summary.held_samples > 0 {
        let reason = summary.first_hold.as_deref().unwrap_or("unknown");
        let text = format!("{} ({reason})", summary.held_samples);
        more("Samples not used", text);
    }
    if let Some(mismatch) = summary.largest_membership_mismatch {
        more("Largest membership mismatch", short(mismatch));
    }
    rows
}

/// A ratio and when it was reached.
fn ratio_at(ratio: f64, time_s: f64) -> String {
    format!("{} at {} s", Claim::AtMost(ratio), short(time_s))
}

fn network_rows(outcome: &NetworkOutcome) -> [(&'static str, String); 8] {
    let first = outcome.first_arrival_s;
    [
        ("values sent", outcome.values.to_string()),
        ("repetitions of each", outcome.repeats.to_string()),
        ("transmissions", outcome.transmissions.to_string()),
        (
            "lost",
            format!(
                "{}, at most {} in a row",
                outcome.lost, outcome.longest_loss
            ),
        ),
        ("dropped as old", outcome.dropped_as_old.to_string()),
        (
            "longest delay",
            format!("{} s", short(outcome.longest_delay_s)),
        ),
        (
            "first arrival",
            first.map_or("none".to_string(), |time| format!("{} s", short(time))),
        ),
        (
            "oldest sample behind a torque",
            format!("{} s", short(outcome.oldest_sample_s)),
        ),
    ]
}

fn link_rows(outcome: &LinkOutcome) -> [(&'static str, String); 11] {
    [
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
    ]
}

/// The table of the requirements; empty without any.
fn requirements(summary: &Summary) -> String {
    if summary.requirements.is_empty() {
        return String::new();
    }
    let rows = summary.requirements.iter().map(|requirement| {
        let word = if requirement.met { "met" } else { "missed" };
        row([
            cell(&requirement.name),
            cell(short(requirement.limit)),
            cell(requirement.value_as_text()),
            judged(requirement.met, word),
        ])
    });
    table("", ["Requirement", "Limit", "Value", ""], rows)
}

fn certificate_section(outcome: &CertificateOutcome) -> String {
    let mut html = numbers(certificate_rows(outcome));
    if !outcome.not_covered.is_empty() {
        html += &paragraph("The proof does not cover this run because of:");
        html += &list(outcome.not_covered.iter().map(|reason| escape(reason)));
    }
    if !outcome.covered.is_empty() {
        html += &paragraph("Within what was proved:");
        html += &list(outcome.covered.iter().map(|text| escape(text)));
    }
    section("Certificate", &html)
}

fn certificate_rows(outcome: &CertificateOutcome) -> Vec<(&'static str, String)> {
    let yes = |value: bool| if value { "yes" } else { "NO" }.to_string();
    let never =
        |time: Option<f64>| time.map_or("never".to_string(), |t| format!("at {} s", short(t)));
    let largest = outcome.largest_lyapunov_ratio;
    let mut rows = vec![
        ("Design proved from its numbers", yes(outcome.proved)),
        ("Proof covers this run", yes(outcome.covers_run)),
        (
            match outcome.proved {
                true => "x'Ux at the start (certified set: at most 1)",
                false => "x'Ux at the start",
            },
            Claim::AtMost(outcome.start_level).to_string(),
        ),
        (
            "Largest x'Ux over its bound",
            ratio_at(largest, outcome.largest_lyapunov_ratio_at_s),
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
    ];
    if let Some([gain, gamma]) = outcome.gains() {
        rows.push(("Guaranteed gain; gamma", format!("{gain}; {gamma}")));
    }
    if let (Some(margin), Some(name)) = (outcome.worst_margin, &outcome.worst_condition) {
        rows.push((
            "Smallest margin",
            format!("{:.4} ({name})", Claim::AtLeast(margin)),
        ));
    }
    if let Some(ratio) = outcome.peak_ratio {
        let caution = match outcome.from_rest_in_origin {
            true => "",
            false => " (no test of the gain: the run does not start in the origin)",
        };
        rows.push((
            "Largest output over largest disturbance",
            short(ratio) + caution,
        ));
    }
    rows.extend(outcome.inner.iter().flat_map(inner_rows));
    rows
}

/// Of the inner certificate of a design with two.
fn inner_rows(inner: &InnerOutcome) -> [(&'static str, String); 4] {
    let entered = inner.entered_s;
    let largest = inner.largest_lyapunov_ratio;
    [
        (
            "Inner certificate holds from",
            entered.map_or("never".to_string(), |time| format!("{} s", short(time))),
        ),
        (
            "Inner: largest x'Ux over its bound",
            ratio_at(largest, inner.largest_lyapunov_ratio_at_s),
        ),
        (
            "Inner: steps above the bound; outside",
            format!("{}; {}", inner.bound_broken_steps, inner.outside_steps),
        ),
        ("Inner: largest output", short(inner.peak_output)),
    ]
}
