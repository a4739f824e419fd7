//! The second certificate of a design with two.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::certificate::CertificateFile;
use crate::certify::theorem1::Certificate;
use crate::certify::{Report, Verdict};
use crate::model::Model;

/// What proves the controller on the larger set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OuterFile {
    /// Above 0: the outer functional uses this multiple of `controller.trigger_weight`. The trigger
    /// itself does not depend on a factor of its weight.
    pub trigger_multiple: f64,
    /// The unknowns of Theorem 1 on the outer box, for the model's `specs.outer`.
    pub certificate: CertificateFile,
}

/// How the unknowns that two certificates share were scaled against each other; enough, with the units,
/// to state the very problem again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Coupling {
    /// Size of the inner set over that of the outer: the inverse multipliers are in the ratio of its
    /// square.
    pub inner_scale: f64,
    /// Multiple of the trigger weight in the outer functional.
    pub trigger_multiple: f64,
}

/// The large-set certificate with the model it belongs to.
#[derive(Debug, Clone, PartialEq)]
pub struct LargeSetCertificate {
    /// The model on the box of the large set.
    pub model: Model,
    /// The numbers, those of the controller included.
    pub certificate: Certificate,
}

/// Prefix of the names of the large-set conditions.
const OUTER: &str = "outer ";

/// The report on two certificates: proved when both are.
pub(super) fn both(mut inner: Report, outer: &Report) -> Report {
    if outer.verdict == Verdict::NotProved {
        inner.verdict = Verdict::NotProved;
    }
    let named = outer.conditions.iter().cloned().map(|mut condition| {
        condition.name.insert_str(0, OUTER);
        condition
    });
    inner.conditions.extend(named);
    for assumption in &outer.not_covered {
        if !inner.not_covered.contains(assumption) {
            inner.not_covered.push(assumption.clone());
        }
    }
    inner
}
