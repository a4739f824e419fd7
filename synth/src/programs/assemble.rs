//! Theorem 2 as a problem for a solver.

use crate::conditions::xu2020::{self, DesignUnknowns, SamplingEnd, Sector, Strictness};
use crate::conditions::Task;
use crate::reduce::{self, Cliques};
use sdp::lmi::{Affine, Condition, LmiProblem, Unknowns};
use sdp::solve::{Accuracy, Backend, Solver};

/// How the decrease condition (18) is put to the solver; all have the same solutions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// No sector unknowns, vertex slack and cliques: many small cones.
    Chordal,
    /// No sector unknowns, vertex slack, cliques not split: few unknowns.
    VertexRelaxed,
    /// One large cone for each vertex and each end of the sampling interval, as published.
    Full,
}

impl Form {
    /// Its name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Form::Chordal => "reduced",
            Form::VertexRelaxed => "slack",
            Form::Full => "full",
        }
    }

    /// The form that a solver is fastest with.
    pub fn suited_to(solver: Solver) -> Self {
        match solver {
            Solver::Clarabel => Form::Chordal,
            Solver::Structured => Form::VertexRelaxed,
        }
    }

    /// This form for another solver: the one that solver is fastest with, unless the published form is requested.
    pub(crate) fn for_backend(self, backend: &dyn Backend) -> Self {
        match (self, backend.solver()) {
            (Form::Full, _) | (_, None) => self,
            (_, Some(solver)) => Form::suited_to(solver),
        }
    }

    /// The form of this name.
    pub fn named(name: &str) -> Option<Self> {
        let all = [Form::Chordal, Form::VertexRelaxed, Form::Full];
        all.into_iter().find(|form| form.name() == name)
    }
}

/// The optimum that a program is solved for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Goal {
    /// The smallest gain bound gamma, every strict inequality with the specification's margin.
    SmallestGain,
    /// The largest common margin with gamma at the given value: a point well inside the feasible set.
    LargestMargin {
        /// The gain bound, at least the smallest one.
        gain_bound: f64,
    },
    /// The smallest slack t with which all conditions but the gain's hold: positive when they cannot
    /// hold. Any gain bound large enough satisfies the gain's.
    SmallestSlack,
    /// The largest common scale of the sets to be scaled, as the smallest -s^2; with C'C <= peak phi U
    /// where a peak is given.
    LargestScale {
        /// Bound on g.
        peak: Option<f64>,
    },
    /// The smallest g with C'C <= g phi U: with xi it bounds the gain by sqrt(g xi).
    SmallestPeak,
    /// The largest common margin with g at the given value.
    LargestMarginAtPeak {
        /// g.
        peak: f64,
    },
}

impl Goal {
    /// When a solver may stop. The margin need not be the largest: any point well
    /// inside the feasible set suffices, and the check decides.
    pub fn accuracy(self, task: &Task) -> Accuracy {
        let (relative_gap, objective_unit) = match self {
            Goal::SmallestGain => (1e-8, GAIN_UNIT * task.disturbance_weight_unit),
            Goal::LargestMargin { .. } | Goal::LargestMarginAtPeak { .. } => (1e-2, 1.0),
            Goal::LargestScale { .. } => (1e-4, REACH_UNIT),
            Goal::SmallestPeak => (1e-5, GAIN_UNIT * task.disturbance_weight_unit),
            Goal::SmallestSlack => (1e-8, SLACK_UNIT),
        };
        Accuracy {
            relative_gap,
            objective_unit,
        }
    }

    /// Its name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Goal::SmallestGain => "smallest gain",
            Goal::LargestMargin { .. } => "largest margin",
            Goal::SmallestSlack => "smallest slack",
            Goal::LargestScale { .. } => "largest reach",
            Goal::SmallestPeak => "smallest peak",
            Goal::LargestMarginAtPeak { .. } => "largest margin",
        }
    }
}

/// A problem with handles on its unknowns.
#[derive(Debug, Clone)]
pub struct Assembled {
    /// The problem, ready for a backend.
    pub problem: LmiProblem,
    /// The unknowns of Theorem 2.
    pub design: DesignUnknowns,
}

/// Unit of the margin that [`Goal::LargestMargin`] maximises, so that its optimum is of the order
/// of one and a solver's relative tolerance means something.
pub const MARGIN_UNIT: f64 = 1e-4;

/// Gains are resolved down to about this size, in units of the scaled xi.
const GAIN_UNIT: f64 = 0.25;

/// Squared scales are resolved down to about this size.
const REACH_UNIT: f64 = 1e-2;

/// Slacks are resolved down to about this size, in scaled units.
const SLACK_UNIT: f64 = 1e-3;

/// Largest trigger weight in the search for the largest margin, in scaled units.
const TRIGGER_WEIGHT_BOUND: f64 = 1e3;

/// States Theorem 2 for a task in scaled units, with (18) at every vertex.
pub fn assemble(task: &Task, form: Form, goal: Goal) -> Assembled {
    let all: Vec<usize> = (0..task.system.vertices.len()).collect();
    assemble_at(task, form, goal, &all)
}

/// States Theorem 2 with (18) at the chosen vertices only: a relaxation.
pub fn assemble_at(task: &Task, form: Form, goal: Goal, chosen: &[usize]) -> Assembled {
    let mut unknowns = Unknowns::new();
    let sector = match (form, &task.gains.given) {
        // Only gains that may be chosen need no sector unknowns.
        (Form::Chordal | Form::VertexRelaxed, None) => Sector::Unsaturated,
        _ => Sector::Unknown,
    };
    let mut design = DesignUnknowns::new(&mut unknowns, task, sector);
    let fixed = task.specification.margin;
    let mut reach = Affine::identity(1, 1.0);
    let (strictness, objective) = match goal {
        Goal::SmallestGain | Goal::SmallestPeak => {
            (Strictness::fixed(fixed), design.gain_bound.clone())
        }
        Goal::LargestMargin { gain_bound: bound } | Goal::LargestMarginAtPeak { peak: bound } => {
            let margin = unknowns.scalar("margin");
            design.gain_bound = Affine::identity(1, bound);
            (Strictness::unknown(MARGIN_UNIT * &margin), -margin)
        }
        Goal::LargestScale { peak } => {
            let scale_squared = unknowns.scalar("scale squared");
            design.gain_bound = Affine::identity(1, peak.unwrap_or(0.0));
            reach = scale_squared.clone();
            (Strictness::fixed(fixed), -scale_squared)
        }
        Goal::SmallestSlack => {
            let slack = unknowns.scalar("slack");
            let margin = Affine::identity(1, fixed) - slack.clone();
            (Strictness::unknown(margin), slack)
        }
    };
    let mut conditions = match goal {
        Goal::SmallestSlack | Goal::LargestScale { peak: None } => {
            xu2020::conditions_without_gain(task, &design, &strictness)
        }
        Goal::LargestScale { .. } | Goal::SmallestPeak | Goal::LargestMarginAtPeak { .. } => {
            xu2020::conditions_with_peak(task, &design, &strictness)
        }
        _ => xu2020::side_conditions(task, &design, &strictness),
    };
    conditions.extend(xu2020::containment(task, &design, &reach));
    if let Goal::LargestMargin { .. } | Goal::LargestMarginAtPeak { .. } = goal {
        conditions.push(bounded_trigger_weight(&design));
    }
    let mut reduced = |cliques| {
        reduce::decrease_conditions(task, chosen, &mut unknowns, &design, &strictness, cliques)
    };
    conditions.extend(match form {
        Form::Chordal => reduced(Cliques::Split),
        Form::VertexRelaxed => reduced(Cliques::Whole),
        Form::Full => full_decrease(task, chosen, &design, &strictness),
    });
    Assembled {
        problem: LmiProblem {
            unknowns,
            objective,
            conditions,
        },
        design,
    }
}

/// Without a threshold (nu = 0) nothing else bounds the trigger weight, and a solver that looks for
/// the largest margin would increase it without bound.
pub(crate) fn bounded_trigger_weight(design: &DesignUnknowns) -> Condition {
    // A solver's feasibility tolerance is relative to the largest constant: keep it at 1.
    let unit = Affine::identity(design.trigger_weight.nrows(), 1.0);
    let share = 1.0 / TRIGGER_WEIGHT_BOUND * &design.trigger_weight;
    Condition::semidefinite("trigger weight bounded", unit - share)
}

pub(crate) fn full_decrease(
    task: &Task,
    chosen: &[usize],
    design: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out = Vec::new();
    for interval in SamplingEnd::BOTH {
        for &vertex in chosen {
            if task.gains.matched().is_some() {
                out.push(xu2020::full_matched_condition(
                    task, vertex, interval, design, strictness,
                ));
                continue;
            }
            for rule in 0..design.gain_count() {
                let at_rule = design.with_rule(rule);
                out.push(xu2020::full_condition(
                    task, vertex, interval, &at_rule, strictness,
                ));
            }
        }
    }
    out
}
