//! Given gains refuted: a part of their conditions is enough.
//!
//! What cannot hold for one gain cannot hold for any set of gains with it in it, and what cannot hold for
//! some vertices cannot hold for all. Small parts come first, because they are decided in seconds.

use nalgebra::DMatrix;

use super::decide::refute_part;
use crate::conditions::{GainPlan, Task};
use crate::programs::{Answer, ConditionSubset, Decision, DesignRequest, Solvers, SynthesisError};
use sdp::solve::Observer;

/// State units that are tried for one gain.
const UNITS_ALONE: usize = 3;

/// State units that are tried for all gains together, a much larger problem.
const UNITS_TOGETHER: usize = 1;

/// Dual multipliers that refute the subject's given gains, where they can be found: from each gain alone, then from
/// all together. Gains with a mismatch bound are matched with their own vertices and the rest of their
/// conditions is left out.
pub(crate) fn refute_given(
    subject: DesignRequest,
    solvers: &Solvers,
    observer: Option<Observer>,
) -> Result<Option<Decision>, SynthesisError> {
    let matched = subject.task.gains.matched().is_some();
    let all: Vec<usize> = (0..subject.given.len()).collect();
    let alone = all.iter().map(|gain| {
        let gain = std::slice::from_ref(gain);
        let vertices = matched.then_some(gain);
        ConditionSubset {
            gains: gain,
            vertices,
        }
    });
    let together = ConditionSubset {
        gains: &all,
        vertices: None,
    };
    let alone = alone.map(|part| (part, UNITS_ALONE));
    let parts = alone.chain((all.len() > 1).then_some((together, UNITS_TOGETHER)));
    for (part, units) in parts {
        let task = restricted(subject.task, subject.given, part, matched);
        let restricted = DesignRequest {
            task: &task,
            part,
            ..subject
        };
        let decision = refute_part(restricted, units, solvers, observer.clone())?;
        if matches!(decision.answer, Answer::Infeasible(_)) {
            return Ok(Some(decision));
        }
    }
    Ok(None)
}

/// The task of a part.
fn restricted(task: &Task, given: &[DMatrix<f64>], part: ConditionSubset, matched: bool) -> Task {
    let mut out = task.clone();
    let gains = part
        .gains
        .iter()
        .filter_map(|&gain| given.get(gain).cloned());
    let gains: Vec<_> = gains.collect();
    if let Some(vertices) = part.vertices {
        let all = &task.system.vertices;
        let kept = vertices
            .iter()
            .filter_map(|&vertex| all.get(vertex).cloned());
        out.system.vertices = kept.collect();
    }
    out.gains = GainPlan::given(&gains, (matched && gains.len() > 1).then_some(0.0));
    out
}
