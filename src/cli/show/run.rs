//! A run as text.
use synth::claim::Claim;

use crate::base::number::short;
use crate::plants::SystemKind;
use crate::run::summary::{CertificateOutcome, Summary};
use crate::sim::link::LinkOutcome;
use crate::sim::metrics::{listed, MetricKind};
use crate::sim::network::NetworkOutcome;

/// What came of a run.
pub fn lines(summary: &Summary) -> Vec<String> {
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
            "between messages: {} s shortest, {} s mean",
            short(shortest),
            short(mean)
        ));
    }
    let bound = summary.max_transmissions_per_s;
    lines.push(match (summary.min_inter_event_s, bound) {
        (Some(shortest), Some(most)) => format!(
            "messages per second: {}; the sampling allows one every {} s, {} per second",
            short(summary.triggers_per_s),
            Claim::AtLeast(shortest),
            Claim::AtMost(most)
        ),
        _ => format!("messages per second: {}", short(summary.triggers_per_s)),
    });
    lines.push(match summary.settle_seconds.map(Claim::AtMost) {
        Some(seconds) => format!("settled: from {seconds} s on"),
        None => "settled: no".to_string(),
    });
    let spacecraft = summary.system == SystemKind::RigidBody;
    for entry in listed(spacecraft).filter(|entry| entry.kind != MetricKind::Effort) {
        if let Some(value) = summary.metric(entry.metric) {
            let line = format!("{}: {} {}", entry.label, short(value), entry.unit);
            lines.push(line.trim_end().to_string());
        }
    }
    // The inputs of another plant have units of their own.
    let (input, unit, impulse_unit) = match spacecraft {
        true => ("torque", " N m", " N m s"),
        false => ("input", "", ""),
    };
    lines.push(format!(
        "largest {input}: {}{unit}; impulse: {}{impulse_unit}",
        short(summary.max_torque),
        short(summary.impulse)
    ));
    if let Some(link) = &summary.link {
        describe_link(link, &mut lines);
    }
    if let Some(network) = &summary.network {
        describe_network(network, &mut lines);
    }
    describe_bounds(summary, &mut lines);
    if let Some(outcome) = &summary.certificate {
        describe_certificate(outcome, &mut lines);
    }
    for requirement in &summary.requirements {
        let met = if requirement.met { "met" } else { "MISSED" };
        lines.push(format!("requirement {}, {met}", requirement.as_text()));
    }
    lines.extend(summary.unsettled());
    lines.extend(summary.notes.iter().map(|note| format!("note: {note}")));
    lines
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

fn describe_network(network: &NetworkOutcome, lines: &mut Vec<String>) {
    lines.push(format!(
        "network: {} values in {} transmissions, {} lost (at most {} in a row), {} overtaken",
        network.values,
        network.transmissions,
        network.lost,
        network.longest_loss,
        network.dropped_as_old
    ));
    lines.push(format!(
        "longest delay: {} s; oldest sample behind a torque: {} s",
        Claim::AtMost(network.longest_delay_s),
        Claim::AtMost(network.oldest_sample_s)
    ));
}

/// Switching and prescribed bounds, for the controllers that have them.
fn describe_bounds(summary: &Summary, lines: &mut Vec<String>) {
    if let (Some(on), Some(off)) = (summary.turn_ons, summary.turn_offs) {
        let fraction = 100.0 * summary.on_time_share;
        lines.push(format!(
            "actuators: turned on {on} and off {off} times, {fraction:.1} % of the time with a torque"
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
        "design: {proved}; x'Ux at the start {}",
        Claim::AtMost(outcome.start_level)
    ));
    lines.push(format!(
        "largest x'Ux over its bound: {} at {:.3} s",
        Claim::AtMost(outcome.largest_lyapunov_ratio),
        outcome.largest_lyapunov_ratio_at_s
    ));
    let ratio = outcome.peak_ratio.filter(|_| outcome.from_rest_in_origin);
    if let (Some(ratio), Some([gain, gamma])) = (ratio, outcome.gains()) {
        let ratio = Claim::AtMost(ratio);
        lines.push(format!(
            "sup|y| / sup|tau| from rest: {ratio}; guaranteed: {gain}; gamma: {gamma}"
        ));
    }
    if let Some(inner) = &outcome.inner {
        lines.push(match inner.entered_s {
            None => match inner.late {
                true => "inner certificate: its set was not entered in the time that is proved".to_string(),
                false => "inner certificate: its set was not entered".to_string(),
            },
            Some(time) => format!(
                "inner certificate: holds from {time:.3} s on; largest x'Ux over its bound {} at {:.3} s",
                Claim::AtMost(inner.largest_lyapunov_ratio),
                inner.largest_lyapunov_ratio_at_s
            ),
        });
    }
    let inside = outcome.covered.iter();
    lines.extend(inside.map(|text| format!("within what was proved: {text}")));
    if outcome.covers_run {
        lines.push("the proof covers this run".to_string());
    } else {
        lines.push("the proof does not cover this run:".to_string());
        let reasons = outcome.not_covered.iter();
        lines.extend(reasons.map(|reason| format!("  - {reason}")));
    }
}
