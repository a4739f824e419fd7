//! The two certificates as one problem.
//!
//! In SI units F = Fh Qh^-T and Upsilon = Qh^-1 Wh Qh^-T are common. The problem stays linear when the
//! inverse multipliers are proportional, Qh_inner = s^2 Qh_outer, with s the ratio of the sizes of the
//! two sets. Each certificate is stated in units of its own; the constants below convert the common
//! unknowns, which are in the units of the large set, into those of the inner one.

use nalgebra::DMatrix;

use crate::conditions::xu2020::{
    gain_error_unknowns, DesignUnknowns, MeasurementUnknowns, SectorUnknowns,
};
use crate::conditions::Task;
use crate::design::Coupling;
use crate::programs::{state, Form, Goal, Part};
use crate::scaling::Scaling;
use sdp::lmi::{Affine, LmiProblem, Unknowns};

/// The problem with handles on its unknowns.
pub(super) struct Coupled {
    pub problem: LmiProblem,
    pub inner: DesignUnknowns,
    pub outer: DesignUnknowns,
}

/// The unknowns that both certificates share, in the units of one of them.
struct SharedUnknowns {
    multiplier: Affine,
    gain: Affine,
    trigger_weight: Affine,
}

impl SharedUnknowns {
    fn new(unknowns: &mut Unknowns, task: &Task) -> Self {
        let (states, inputs) = (task.system.states(), task.system.inputs());
        SharedUnknowns {
            trigger_weight: unknowns.symmetric("Wh", states),
            multiplier: unknowns.general("Qh", states, states),
            gain: unknowns.general("Fh", inputs, states),
        }
    }

    /// The same unknowns in the inner units. State units are multiples of the identity.
    fn in_inner_units(&self, inner: &Scaling, outer: &Scaling, coupling: Coupling) -> Self {
        let size = inner.state[0] / outer.state[0];
        let multiplier = (coupling.inner_scale / size).powi(2);
        let inputs = outer.input.component_div(&inner.input);
        let gain = DMatrix::from_diagonal(&(inputs * (multiplier * size)));
        let trigger = (multiplier * size).powi(2) / coupling.trigger_multiple;
        SharedUnknowns {
            multiplier: multiplier * &self.multiplier,
            gain: &gain * &self.gain,
            trigger_weight: trigger * &self.trigger_weight,
        }
    }

    /// The unknowns of one certificate.
    fn with_own(&self, unknowns: &mut Unknowns, task: &Task, suffix: &str) -> DesignUnknowns {
        let (states, inputs) = (task.system.states(), task.system.inputs());
        let named = |name: &str| format!("{name} {suffix}");
        let sector = SectorUnknowns {
            anti_windup: unknowns.general(&named("Nh"), inputs, states),
            weight: unknowns.diagonal(&named("S"), inputs),
            // Here S stays away from zero: the dead zone is there to be used.
            row_unit: 1.0,
        };
        DesignUnknowns {
            lyapunov: unknowns.symmetric(&named("Uh"), states),
            integral_weight: unknowns.symmetric(&named("Yh"), states),
            free_state: unknowns.general(&named("L1h"), states, states),
            free_sample: unknowns.general(&named("L2h"), states, states),
            disturbance_weight: unknowns.scalar(&named("xi")),
            further_weights: Vec::new(),
            measurement: MeasurementUnknowns::for_task(unknowns, task, &format!(" {suffix}")),
            gain_error: gain_error_unknowns(unknowns, task, &format!(" {suffix}")),
            multiplier: self.multiplier.clone(),
            gain: self.gain.clone(),
            trigger_weight: self.trigger_weight.clone(),
            sector: Some(sector),
            further: Vec::new(),
            mismatch: Vec::new(),
            gain_bound: Affine::identity(1, UNBOUNDED_GAIN),
        }
    }
}

/// The large-set certificate's gamma is no requirement; the smallest one is computed from its solution.
pub(super) const UNBOUNDED_GAIN: f64 = 1e30;

/// States both certificates with the goal for the inner one.
pub(super) fn assemble(
    [(inner_units, inner), (outer_units, outer)]: &[(Scaling, Task); 2],
    coupling: Coupling,
    form: Form,
    goal: Goal,
) -> Coupled {
    let mut unknowns = Unknowns::new();
    let shared = SharedUnknowns::new(&mut unknowns, outer);
    let own = shared.in_inner_units(inner_units, outer_units, coupling);
    let mut inner_design = own.with_own(&mut unknowns, inner, "inner");
    let outer_design = shared.with_own(&mut unknowns, outer, "outer");
    if goal == Goal::SmallestGain {
        inner_design.gain_bound = inner.gain_unit() * unknowns.scalar("gamma");
    }
    let first = Part::at_every_vertex("inner", inner, inner_design);
    let second = Part::at_every_vertex("outer", outer, outer_design.clone());
    let (problem, inner) = state(unknowns, first, Some(second), form, goal);
    Coupled {
        problem,
        inner,
        outer: outer_design,
    }
}
