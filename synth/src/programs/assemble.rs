//! Theorem 2 as a problem for a solver, with one certificate or two.

use crate::conditions::xu2020::{self, DesignUnknowns, SamplingEnd, Sector, Strictness};
use crate::conditions::Task;
use crate::reduce::{self, Cliques};
use sdp::lmi::{Affine, Condition, LmiProblem, Unknowns};
use sdp::solve::{Accuracy, Solver};

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

    /// The other one of the two small forms.
    pub(crate) fn other(self) -> Option<Self> {
        match self {
            Form::Chordal => Some(Form::VertexRelaxed),
            Form::VertexRelaxed => Some(Form::Chordal),
            Form::Full => None,
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
        let gain_unit = GAIN_UNIT * task.gain_unit();
        let (relative_gap, objective_unit) = match self {
            Goal::SmallestGain => (1e-8, gain_unit),
            Goal::LargestMargin { .. } | Goal::LargestMarginAtPeak { .. } => (1e-2, 1.0),
            Goal::LargestScale { .. } => (1e-4, REACH_UNIT),
            Goal::SmallestPeak => (1e-5, gain_unit),
            Goal::SmallestSlack => (1e-8, SLACK_UNIT),
        };
        Accuracy {
            relative_gap,
            objective_unit,
        }
    }

    /// The margin of the strict inequalities at a point with this objective, where a fixed margin is the specification's.
    pub(crate) fn margin(self, fixed: f64, objective: f64) -> f64 {
        match self {
            Goal::LargestMargin { .. } | Goal::LargestMarginAtPeak { .. } => {
                -MARGIN_UNIT * objective
            }
            Goal::SmallestSlack => fixed - objective,
            Goal::SmallestGain | Goal::SmallestPeak | Goal::LargestScale { .. } => fixed,
        }
    }

    /// Its name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Goal::SmallestGain => "smallest gain",
            Goal::LargestMargin { .. } | Goal::LargestMarginAtPeak { .. } => "largest margin",
            Goal::SmallestSlack => "smallest slack",
            Goal::LargestScale { .. } => "largest reach",
            Goal::SmallestPeak => "smallest peak",
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
const TRIGGER_WEIGHT_BOUND: f64 = 1e6;

/// One certificate of a program.
pub(crate) struct Part<'a> {
    /// What the names of its conditions begin with; nothing where there is one certificate.
    pub name: &'static str,
    /// The task in units of its own.
    pub task: &'a Task,
    /// Its unknowns, some of which other certificates may share.
    pub design: DesignUnknowns,
    /// The vertices at which (18) is stated.
    pub vertices: Vec<usize>,
}

impl<'a> Part<'a> {
    /// A certificate with (18) at every vertex.
    pub fn at_every_vertex(name: &'static str, task: &'a Task, design: DesignUnknowns) -> Self {
        Part {
            name,
            task,
            design,
            vertices: (0..task.system.vertices.len()).collect(),
        }
    }

    /// Conditions under the name of the certificate.
    fn named(&self, conditions: Vec<Condition>) -> Vec<Condition> {
        if self.name.is_empty() {
            return conditions;
        }
        let renamed = conditions.into_iter().map(|condition| {
            let name = format!("{} {}", self.name, condition.name());
            Condition::semidefinite(name, condition.expression().clone())
        });
        renamed.collect()
    }

    /// Every condition but (18), with those on the gain that the goal needs.
    fn side_conditions(&self, goal: Goal, strictness: &Strictness) -> Vec<Condition> {
        let stated = match goal {
            Goal::SmallestSlack | Goal::LargestScale { peak: None } => {
                xu2020::conditions_without_gain
            }
            Goal::LargestScale { .. } | Goal::SmallestPeak | Goal::LargestMarginAtPeak { .. } => {
                xu2020::conditions_with_peak
            }
            Goal::SmallestGain | Goal::LargestMargin { .. } => xu2020::side_conditions,
        };
        stated(self.task, &self.design, strictness)
    }

    /// (18) at the vertices.
    fn decrease(
        &self,
        unknowns: &mut Unknowns,
        form: Form,
        strictness: &Strictness,
    ) -> Vec<Condition> {
        let (task, design) = (self.task, &self.design);
        let cliques = match form {
            Form::Chordal => Cliques::Split,
            Form::VertexRelaxed => Cliques::Whole,
            Form::Full => return full_decrease(task, &self.vertices, design, strictness),
        };
        reduce::decrease_conditions(task, &self.vertices, unknowns, design, strictness, cliques)
    }
}

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
    let only = Part {
        name: "",
        task,
        design: DesignUnknowns::new(&mut unknowns, task, sector),
        vertices: chosen.to_vec(),
    };
    let (problem, design) = state(unknowns, only, None, form, goal);
    Assembled { problem, design }
}

/// States the conditions of one or two certificates, whose unknowns have been made, with the goal for the first. The
/// gain of the second is no requirement.
pub(crate) fn state(
    mut unknowns: Unknowns,
    mut first: Part,
    second: Option<Part>,
    form: Form,
    goal: Goal,
) -> (LmiProblem, DesignUnknowns) {
    let fixed = first.task.specification.margin;
    let gain_bound = &mut first.design.gain_bound;
    let mut reach = Affine::identity(1, 1.0);
    let (strictness, objective) = match goal {
        Goal::SmallestGain | Goal::SmallestPeak => (Strictness::fixed(fixed), gain_bound.clone()),
        Goal::LargestMargin { gain_bound: bound } | Goal::LargestMarginAtPeak { peak: bound } => {
            let margin = unknowns.scalar("margin");
            *gain_bound = Affine::identity(1, bound);
            (Strictness::unknown(MARGIN_UNIT * &margin), -margin)
        }
        Goal::LargestScale { peak } => {
            let scale_squared = unknowns.scalar("scale squared");
            *gain_bound = Affine::identity(1, peak.unwrap_or(0.0));
            reach = scale_squared.clone();
            (Strictness::fixed(fixed), -scale_squared)
        }
        Goal::SmallestSlack => {
            let slack = unknowns.scalar("slack");
            let margin = Affine::identity(1, fixed) - slack.clone();
            (Strictness::unknown(margin), slack)
        }
    };
    let mut conditions = first.named(first.side_conditions(goal, &strictness));
    conditions.extend(xu2020::containment(
        first.task,
        &first.design,
        &reach,
        &strictness,
    ));
    if let Some(second) = &second {
        let without_gain = second.side_conditions(Goal::SmallestSlack, &strictness);
        conditions.extend(second.named(without_gain));
    }
    if let Goal::LargestMargin { .. } | Goal::LargestMarginAtPeak { .. } = goal {
        let last = second.as_ref().unwrap_or(&first);
        if !last.task.held_is_sample {
            conditions.push(bounded_trigger_weight(&last.design));
        }
    }
    for part in [Some(&first), second.as_ref()].into_iter().flatten() {
        conditions.extend(part.named(part.decrease(&mut unknowns, form, &strictness)));
    }
    let problem = LmiProblem {
        unknowns,
        objective,
        conditions,
    };
    (problem, first.design)
}

/// Without a threshold (nu = 0) nothing else bounds the trigger weight, and a solver that looks for
/// the largest margin would increase it without bound.
fn bounded_trigger_weight(design: &DesignUnknowns) -> Condition {
    // A solver's feasibility tolerance is relative to the largest constant: keep it at 1.
    let unit = Affine::identity(design.trigger_weight.nrows(), 1.0);
    let share = 1.0 / TRIGGER_WEIGHT_BOUND * &design.trigger_weight;
    Condition::semidefinite("trigger weight bounded", unit - share)
}

fn full_decrease(
    task: &Task,
    chosen: &[usize],
    design: &DesignUnknowns,
    strictness: &Strictness,
) -> Vec<Condition> {
    let mut out = Vec::new();
    for &interval in SamplingEnd::of(task) {
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
