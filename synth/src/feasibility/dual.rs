//! Whether the dual solution of the smallest slack refutes a model.

use super::candidate::Source;
use crate::certify::infeasible::{refute, DualMultipliers, Refutation};
use crate::conditions::{GainPlan, Task};
use crate::design::ProblemUnits;
use crate::infeasibility::WeightsFile;
use crate::programs::{scaled, DesignRequest, Form, Goal, Session, Solved, SynthesisError};
use crate::scaling::Scaling;
use sdp::centre::{centred, refined};

/// Dual multipliers that are proved, as a file holds them.
pub(super) type Proof = (WeightsFile, Refutation);

/// The task in its units, with a threshold that leaves its dual feasible set an interior.
pub(super) fn solved_task(task: &Task, units: &ProblemUnits) -> (Scaling, Task) {
    let (scaling, mut task) = scaled(task, units);
    let threshold = &mut task.specification.trigger_threshold;
    *threshold = threshold.max(SMALLEST_THRESHOLD);
    (scaling, task)
}

/// A plant has no design when the one that it is relaxed to has none.
pub(super) fn refute_relaxed(
    request: DesignRequest,
    session: &mut Session,
    units: &ProblemUnits,
) -> Result<Option<Proof>, SynthesisError> {
    let mut relaxed = request.model.clone();
    relaxed.plant = relaxed.plant.relaxed();
    let mut task = request.task.clone();
    task.system = relaxed.plant.takagi_sugeno();
    let mut own = session.fresh(Form::Chordal);
    let solved = own.solve(solved_task(&task, units), Goal::SmallestSlack);
    session.runs.append(&mut own.runs);
    let request = DesignRequest {
        model: &relaxed,
        ..request
    };
    Ok(refuted(request, &solved?))
}

/// The proof that the dual solution gives, if it gives one.
pub(super) fn refuted(request: DesignRequest, solved: &Solved) -> Option<Proof> {
    let margin = solved.task.specification.margin;
    let excess = solved.solution.objective - margin;
    if excess.is_nan() || excess <= 0.0 {
        return None;
    }
    let problem = solved.assembled.problem.lower();
    let duals = &solved.solution.duals;
    let shown = |duals: &[Vec<f64>], size: f64| {
        let source = Source {
            request,
            solved,
            duals,
            size,
        };
        let (file, weights) = as_read(&source)?;
        let refutation = refute(request.model, &weights);
        let proved = refutation.proved;
        proved.then_some((file, refutation))
    };
    let mut centres = Vec::new();
    for kept in KEPT {
        let (size, target) = (kept * excess, -(margin + kept * excess));
        let centre = centred(&problem, duals, target);
        if let Some(proof) = shown(centre.as_ref().unwrap_or(duals), size) {
            return Some(proof);
        }
        centres.extend(centre.map(|centre| (centre, size, target)));
    }
    // More digits take longer.
    centres.iter().find_map(|(centre, size, target)| {
        let centre = refined(&problem, centre, *target)?;
        shown(&centre, *size)
    })
}

/// Dual multipliers are about one free gain; or about given gains, in any mixture or each with its own vertex.
pub(super) fn refutable(task: &Task) -> bool {
    let gains = &task.gains;
    let stated = gains.given.is_some() && gains.matched().is_none_or(|kappa| kappa == 0.0);
    *gains == GainPlan::constant() || stated
}

/// The dual multipliers as a reader of their file gets them, `None` where no file may hold them.
fn as_read(source: &Source) -> Option<(WeightsFile, DualMultipliers)> {
    let file = WeightsFile::new(source.weights()?)?;
    let weights = file
        .weights(source.request.model, source.request.given)
        .ok()?;
    Some((file, weights))
}

/// The smallest trigger threshold with which the problem is solved: with 0 its dual feasible set has no
/// interior. A design for a larger threshold is one for the model's; the dual multipliers leave the held state
/// out, see [`Source::weights`].
const SMALLEST_THRESHOLD: f64 = 1e-6;

/// Fractions of the slack above the margin that the dual multipliers of a proof keep, tried in order; the rest moves
/// them into the interior. Close to feasibility only the second leaves enough.
const KEPT: [f64; 2] = [0.25, 0.02];
