//! The unknowns of Theorem 2.

use crate::conditions::Task;
use sdp::lmi::{Affine, Unknowns};

/// The instants at which (18) is stated. Where every message acts at once these are the two ends of a sampling interval, r
/// in (18): the condition is affine in the time since the last sample, so its ends suffice, and of all admitted lengths the
/// longest is the worst. Where messages come late or are lost one condition covers every instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SamplingEnd {
    /// r = 1: just after a sample, where hbar x'Yx' counts.
    Start,
    /// r = 2: just before the next sample, where the integral term counts.
    End,
    /// Any instant, with the functional of a network with delay or loss: both terms count.
    Any,
}

impl SamplingEnd {
    /// Both ends.
    pub const BOTH: [SamplingEnd; 2] = [SamplingEnd::Start, SamplingEnd::End];

    /// The index r of (18).
    pub fn index(self) -> usize {
        match self {
            SamplingEnd::Start => 1,
            SamplingEnd::End | SamplingEnd::Any => 2,
        }
    }

    /// The instants of a task.
    pub fn of(task: &Task) -> &'static [SamplingEnd] {
        match task.imperfections.oldest_sample {
            None => &SamplingEnd::BOTH,
            Some(_) => &[SamplingEnd::Any],
        }
    }

    /// What the names of its conditions say of it.
    pub fn label(self) -> &'static str {
        match self {
            SamplingEnd::Start => " r=1",
            SamplingEnd::End => " r=2",
            SamplingEnd::Any => "",
        }
    }
}

/// Unit of the dead-zone row of (18). The best S tends to zero; in this unit its margin costs nothing
/// that shows in gamma.
pub const DEAD_ZONE_UNIT: f64 = 1024.0;

/// The unknowns of the sector condition (17). Shapes: n states, m inputs.
#[derive(Debug, Clone)]
pub struct SectorUnknowns {
    /// Nh, m x n: the anti-windup gain.
    pub anti_windup: Affine,
    /// S = M^-1, m x m, diagonal: the inverse sector weight.
    pub weight: Affine,
    /// Unit of the dead-zone row of (18): [`DEAD_ZONE_UNIT`] where the best S tends to zero.
    pub row_unit: f64,
}

impl SectorUnknowns {
    /// S in units of the dead-zone row.
    pub(super) fn weight_in_row_units(&self) -> Affine {
        self.row_unit.powi(2) * &self.weight
    }
}

/// Whether the sector condition has unknowns of its own.
///
/// With one certificate they are redundant: if (F, N) satisfies Theorem 2 then so does (F - N, 0)
/// with the same U, gamma and set (let the dead zone equal N x(t_k) in the quadratic form), and the
/// infimum over S is approached as S -> 0, where the dead zone drops out of (18).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sector {
    /// As published: N and M unknown.
    Unknown,
    /// N = 0 and M as large as needed: the command stays within its limits inside the certified set.
    Unsaturated,
}

/// The unknowns of a measurement error. n states.
#[derive(Debug, Clone)]
pub struct MeasurementUnknowns {
    /// Wph, n x n, symmetric: what is left of the trigger weight on the error.
    pub error_weight: Affine,
    /// s / taubar^2: what the error adds to xi.
    pub supply: Affine,
    /// lambda of each ball of states.
    pub shares: Vec<Affine>,
}

impl MeasurementUnknowns {
    /// The unknowns for a task; none for a perfect measurement, or as long as there is no point of linearisation.
    pub fn for_task(unknowns: &mut Unknowns, task: &Task, suffix: &str) -> Option<Self> {
        let error = task.imperfections.measurement.as_ref()?;
        error.point.as_ref()?;
        let names = (1..=error.count()).map(|ball| format!("lambda{ball}{suffix}"));
        Some(MeasurementUnknowns {
            error_weight: unknowns.symmetric(&format!("Wph{suffix}"), task.system.states()),
            supply: unknowns.scalar(&format!("s{suffix}")),
            shares: names.map(|name| unknowns.scalar(&name)).collect(),
        })
    }
}

/// D, diagonal: the unknowns of the actuators' gain error, one for each uncertain entry; none where the gain is known.
pub fn gain_error_unknowns(unknowns: &mut Unknowns, task: &Task, suffix: &str) -> Option<Affine> {
    let error = task.imperfections.gain_error.as_ref()?;
    let count = error.entries.len();
    (count > 0).then(|| unknowns.diagonal(&format!("D{suffix}"), count))
}

/// The gain of one rule, beyond the first.
#[derive(Debug, Clone)]
pub struct RuleUnknowns {
    /// Fh_j, m x n.
    pub gain: Affine,
    /// Nh_j, m x n; `None` without sector unknowns.
    pub anti_windup: Option<Affine>,
}

/// P_j and R for one end of the sampling interval. Their rows: B'v (m), the dead zone in its unit (m;
/// none without sector unknowns), x(t_k) (n).
#[derive(Debug, Clone)]
pub struct MismatchUnknowns {
    /// P_j of every gain.
    pub bounds: Vec<Affine>,
    /// R.
    pub common: Affine,
}

impl MismatchUnknowns {
    /// The unknowns for both ends of the interval; none where no mismatch is assumed or it is 0.
    fn for_task(unknowns: &mut Unknowns, task: &Task, sector: bool) -> Vec<Self> {
        if !task.gains.matched().is_some_and(|kappa| kappa > 0.0) {
            return Vec::new();
        }
        let (n, m) = (task.system.states(), task.system.inputs());
        let side = n + if sector { 2 * m } else { m };
        let one = |interval: SamplingEnd| {
            let r = interval.index();
            let names = (1..=task.gains.count).map(|rule| format!("P{r},{rule}"));
            MismatchUnknowns {
                bounds: names.map(|name| unknowns.symmetric(&name, side)).collect(),
                common: unknowns.symmetric(&format!("R{r}"), side),
            }
        };
        SamplingEnd::BOTH.map(one).into_iter().collect()
    }

    /// `kappa sum_j P_j`.
    pub fn total(&self, task: &Task) -> Affine {
        let side = self.common.nrows();
        let kappa = task.gains.matched().unwrap_or(0.0);
        let sum = |sum: Affine, bound: &Affine| sum + bound.clone();
        kappa * self.bounds.iter().fold(Affine::zeros(side, side), sum)
    }
}

/// The unknowns of Theorem 2. Shapes: n states, m inputs.
#[derive(Debug, Clone)]
pub struct DesignUnknowns {
    /// Uh, n x n, symmetric: the quadratic part of the Lyapunov functional.
    pub lyapunov: Affine,
    /// Yh, n x n, symmetric: the weight of the integral term.
    pub integral_weight: Affine,
    /// Wh, n x n, symmetric: the trigger weight (Upsilon); 0 where it is no part of (18).
    pub trigger_weight: Affine,
    /// Qh, n x n: the inverse multiplier.
    pub multiplier: Affine,
    /// L1h, n x n: free matrix on x.
    pub free_state: Affine,
    /// L2h, n x n: free matrix on x(t_k^l).
    pub free_sample: Affine,
    /// Fh, m x n: the gain (of the first rule).
    pub gain: Affine,
    /// The unknowns of the sector condition (anti-windup gain of the first rule); `None` when the
    /// design never saturates in its set.
    pub sector: Option<SectorUnknowns>,
    /// The gains of the other rules; empty for a constant gain.
    pub further: Vec<RuleUnknowns>,
    /// The slack of the mismatch bound, for each end of the sampling interval; empty where none is
    /// assumed or where it is 0.
    pub mismatch: Vec<MismatchUnknowns>,
    /// xi: the weight of the disturbance.
    pub disturbance_weight: Affine,
    /// The weights of [`Task::further_signals`], in their order.
    pub further_weights: Vec<Affine>,
    /// The unknowns of a measurement error; `None` for a perfect measurement.
    pub measurement: Option<MeasurementUnknowns>,
    /// D of the actuators' gain error; `None` where the gain is known.
    pub gain_error: Option<Affine>,
    /// gamma: the bound on the L-infinity gain, in SI units whatever those of the task.
    pub gain_bound: Affine,
}

impl DesignUnknowns {
    /// Creates the unknowns for a task.
    pub fn new(unknowns: &mut Unknowns, task: &Task, sector: Sector) -> Self {
        let (states, inputs) = (task.system.states(), task.system.inputs());
        let lyapunov = unknowns.symmetric("Uh", states);
        let integral_weight = unknowns.symmetric("Yh", states);
        let trigger_weight = match task.held_is_sample {
            true => Affine::zeros(states, states),
            false => unknowns.symmetric("Wh", states),
        };
        let multiplier = unknowns.general("Qh", states, states);
        let free_state = unknowns.general("L1h", states, states);
        let free_sample = unknowns.general("L2h", states, states);
        let gain = |unknowns: &mut Unknowns, rule: usize| match &task.gains.given {
            Some(given) => &given[rule] * &multiplier.transposed(),
            None => unknowns.general(&numbered("Fh", rule), inputs, states),
        };
        let anti_windup = |unknowns: &mut Unknowns, rule: usize| {
            (1.0 / DEAD_ZONE_UNIT) * unknowns.general(&numbered("Nh", rule), inputs, states)
        };
        let first = gain(unknowns, 0);
        let sector = match sector {
            Sector::Unsaturated => None,
            Sector::Unknown => Some(SectorUnknowns {
                anti_windup: anti_windup(unknowns, 0),
                weight: DEAD_ZONE_UNIT.powi(-2) * unknowns.diagonal("S", inputs),
                row_unit: DEAD_ZONE_UNIT,
            }),
        };
        let further = (1..task.gains.count).map(|rule| RuleUnknowns {
            gain: gain(unknowns, rule),
            anti_windup: sector.is_some().then(|| anti_windup(unknowns, rule)),
        });
        let further = further.collect();
        let mismatch = MismatchUnknowns::for_task(unknowns, task, sector.is_some());
        let disturbance_weight = unknowns.scalar("xi");
        let further_weights = task.further_signals.iter();
        let further_weights =
            further_weights.map(|signal| unknowns.scalar(&format!("xi {}", signal.name)));
        let further_weights = further_weights.collect();
        DesignUnknowns {
            measurement: MeasurementUnknowns::for_task(unknowns, task, ""),
            gain_error: gain_error_unknowns(unknowns, task, ""),
            further_weights,
            lyapunov,
            integral_weight,
            trigger_weight,
            free_state,
            free_sample,
            gain: first,
            sector,
            further,
            mismatch,
            disturbance_weight,
            gain_bound: task.gain_unit() * unknowns.scalar("gamma"),
            multiplier,
        }
    }

    /// Unit of the dead-zone row.
    pub fn dead_zone_unit(&self) -> f64 {
        let sector = self.sector.as_ref();
        sector.map_or(DEAD_ZONE_UNIT, |sector| sector.row_unit)
    }

    /// The weight of the trigger error in (18): Wh, or what a measurement error leaves of it.
    pub fn error_weight(&self) -> &Affine {
        let own = self.measurement.as_ref();
        own.map_or(&self.trigger_weight, |own| &own.error_weight)
    }

    /// Number of gains.
    pub fn gain_count(&self) -> usize {
        1 + self.further.len()
    }

    /// The same unknowns with the gains of one rule in the place of the first.
    pub fn with_rule(&self, rule: usize) -> Self {
        let mut out = self.clone();
        if let Some(chosen) = rule.checked_sub(1).and_then(|k| self.further.get(k)) {
            out.gain = chosen.gain.clone();
            if let (Some(sector), Some(anti_windup)) = (&mut out.sector, &chosen.anti_windup) {
                sector.anti_windup = anti_windup.clone();
            }
        }
        out
    }

    /// The same unknowns with zero in the place of the gains.
    pub fn without_gain(&self) -> Self {
        let mut out = self.clone();
        out.gain = Affine::zeros(self.gain.nrows(), self.gain.ncols());
        if let Some(sector) = &mut out.sector {
            sector.anti_windup = out.gain.clone();
        }
        out
    }
}

/// `Fh`, `Fh2`, `Fh3`, ...
fn numbered(name: &str, rule: usize) -> String {
    match rule {
        0 => name.to_string(),
        _ => format!("{name}{}", rule + 1),
    }
}
