//! What a report says of the inner certificate of a design with two.

use crate::base::number::short;
use crate::run::summary::{CertificateOutcome, InnerOutcome};

/// Rows of the certificate's table; none for a design with one certificate.
pub(crate) fn rows(outcome: &CertificateOutcome) -> Vec<(&'static str, String)> {
    let Some(inner) = &outcome.inner else {
        return Vec::new();
    };
    let entered = match inner.entered_s {
        Some(time) => format!("{} s", short(time)),
        None => "never".to_string(),
    };
    vec![
        ("Inner certificate holds from", entered),
        (
            "Inner: largest x'Ux over its bound",
            format!(
                "{:.6} at {} s",
                inner.largest_lyapunov_ratio,
                short(inner.largest_lyapunov_ratio_at_s)
            ),
        ),
        (
            "Inner: steps above the bound; outside",
            format!("{}; {}", inner.bound_broken_steps, inner.outside_steps),
        ),
        ("Inner: largest output", short(inner.peak_output)),
    ]
}

impl InnerOutcome {
    /// In one line.
    pub fn sentence(&self) -> String {
        match self.entered_s {
            None => "inner certificate: its set was not entered".to_string(),
            Some(time) => format!(
                "inner certificate: holds from {time:.3} s on; largest x'Ux over its bound {:.6} at {:.3} s",
                self.largest_lyapunov_ratio, self.largest_lyapunov_ratio_at_s
            ),
        }
    }
}
