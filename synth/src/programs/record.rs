//! What is said of a solver's run, and of who made a file.

use std::collections::BTreeMap;

use serde::Serialize;
use sha2::{Digest, Sha256};
use time::format_description::well_known::Rfc3339;
use time::OffsetDateTime;

use sdp::lmi::{dual_trace, Condition};
use sdp::solve::Solution;

/// A condition that carries the dual solution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Blocking {
    /// Its name.
    pub name: String,
    /// Its fraction of the dual solution's trace.
    pub share: f64,
}

/// Conditions by their fraction of the dual solution's trace, largest first, those below 1 % left out.
/// The cliques of a reduced condition (18) count together, at all its vertices.
pub(crate) fn blocking(conditions: &[Condition], solution: &Solution) -> Vec<Blocking> {
    let mut traces = BTreeMap::<String, f64>::new();
    for (condition, dual) in conditions.iter().zip(&solution.duals) {
        let trace = dual_trace(condition.side(), dual);
        let whole = match condition.name().split_once(" clique ") {
            Some((whole, _)) => format!("{whole} all vertices"),
            None => condition.name().to_string(),
        };
        if trace.is_finite() {
            *traces.entry(whole).or_default() += trace;
        }
    }
    let total: f64 = traces.values().sum();
    let shares = traces.into_iter().map(|(name, trace)| Blocking {
        name,
        share: trace / total.max(f64::MIN_POSITIVE),
    });
    let mut shares: Vec<Blocking> = shares.filter(|condition| condition.share >= 0.01).collect();
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    shares
}

/// The program that made a file, with its version.
pub const GENERATOR: &str = concat!("steadfast ", env!("CARGO_PKG_VERSION"));

/// Date and time, UTC, to the second.
pub(crate) fn now() -> String {
    let now = OffsetDateTime::now_utc().replace_nanosecond(0);
    let date = now.ok().and_then(|now| now.format(&Rfc3339).ok());
    date.unwrap_or_default()
}

/// SHA-256 of a text, in hexadecimal.
pub fn sha256_of(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
