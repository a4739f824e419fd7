//! From the summit of a search to a design that is proved.

use nalgebra::{DMatrix, DVector};

use super::denial::{decision, denied};
use super::inner::{Aim, Inner, SearchPoint, REGION_MARGIN};
use super::plan::Plan;
use super::shortfall::sensitivities;
use super::start;
use crate::certify::reach::{along, angle_of_vector_part_deg, Along};
use crate::certify::Verdict;
use crate::conditions::xu2020::Coverage;
use crate::conditions::Task;
use crate::design::{add_claims, recover, rows, ProblemUnits, SearchRecord, VariedFile};
use crate::model::{Model, ModelFile, Plant};
use crate::optimality::Optimality;
use crate::programs::{
    Assembled, DesignRequest, Form, Goal, Outcome, Session, Shortfall, SynthesisError, Synthesized,
};
use crate::scaling::Scaling;
use sdp::solve::Status;

/// How the design is tried, one way after the other until one is proved.
#[derive(Debug, Clone, Copy)]
struct AttemptSettings {
    /// ConditionSubset of the scale found that is given away for room.
    shrinking: f64,
    /// Unit of the state, relative to the search's.
    unit: f64,
    /// Least margin in scaled units. A large set has entries of very different sizes in one condition, and the
    /// model's own margin may be lost in them.
    margin: f64,
}

const fn way(shrinking: f64, unit: f64, margin: f64) -> AttemptSettings {
    AttemptSettings {
        shrinking,
        unit,
        margin,
    }
}

const REGION_WAYS: [AttemptSettings; 1] = [way(1e-2, 1.0, 0.1 * REGION_MARGIN)];

/// Points of the way to a region's summit that are tried, as parts of it: a summit may lie where the solver's digits
/// do not suffice.
const POINTS: [f64; 5] = [1.0, 0.6, 0.4, 0.2, 0.0];

const GAIN_WAYS: [AttemptSettings; 3] =
    [way(0.0, 1.0, 0.0), way(0.0, 0.25, 0.0), way(0.0, 4.0, 0.0)];

/// The bound g of the exported design, relative to the smallest: the price of a margin. A region is not after the
/// gain and can pay more.
const PEAK_ROOM: f64 = 1e-3;
const PEAK_ROOM_OF_A_REGION: f64 = 2e-2;

/// How far gamma lies above max(g, xi).
const GAMMA_ROOM: f64 = 1e-6;

/// Relative room of the part of a state that a design must contain.
const CLAIM_ROOM: f64 = 1e-6;

/// Significant digits of the numbers that the search chose.
const DIGITS: i32 = 5;

/// What one attempt is made with.
struct Making<'a> {
    model: &'a Model,
    task: &'a Task,
    scaling: &'a Scaling,
    units: ProblemUnits,
    point: &'a SearchPoint,
}

/// What the design is made for.
pub struct Finish<'a> {
    pub model: &'a Model,
    pub model_text: &'a str,
    pub form: Form,
    pub plan: &'a Plan,
    pub inner: &'a Inner<'a>,
}

impl Finish<'_> {
    /// Makes the design at the last of the points, or at an earlier one where it is not proved, and says
    /// whether it is what was asked for.
    pub fn outcome(
        &self,
        trail: &[SearchPoint],
        runs: &mut Session,
    ) -> Result<Outcome, SynthesisError> {
        let Some(summit) = trail.last() else {
            return Ok(denied("the search found no point".to_string(), runs));
        };
        let (ways, parts) = match self.inner.aim {
            Aim::Reach { .. } => (&REGION_WAYS[..], &POINTS[..]),
            Aim::Gain => (&GAIN_WAYS[..], &POINTS[..1]),
        };
        let mut unproved = None;
        let mut tried = usize::MAX;
        for part in parts {
            let index = (part * (trail.len() - 1) as f64).round() as usize;
            if index == tried {
                continue;
            }
            tried = index;
            let point = self.rounded(trail.get(index).unwrap_or(summit))?;
            if let Some(outcome) = self.at(&point, ways, runs, &mut unproved)? {
                return Ok(self.compared(outcome, summit));
            }
        }
        Ok(match unproved {
            Some(design) => Outcome::Solved(closed(design, runs)),
            None => {
                let reason = "the search found a point, but no solver could make a design of it";
                let shortfall = Shortfall {
                    reason: reason.to_string(),
                    scale: None,
                    angle_deg: None,
                    limits: sensitivities(self.inner, summit)?,
                };
                Outcome::SolverFailed(decision(shortfall, summit.value.blocking.clone(), runs))
            }
        })
    }

    /// The outcome with its objective beside the best one that the search saw.
    fn compared(&self, mut outcome: Outcome, summit: &SearchPoint) -> Outcome {
        if let Outcome::Solved(design) = &mut outcome {
            let height = summit.value.height;
            design.optimality = match self.inner.aim {
                Aim::Reach { .. } => {
                    let scale = self.extent(design).0;
                    scale.and_then(|scale| Optimality::of_largest(scale, height.exp()))
                }
                Aim::Gain => {
                    let gain = design.file.certificate.guaranteed_gain;
                    Optimality::of_smallest(gain, (-height).exp())
                }
            };
        }
        outcome
    }

    /// A proved design at a point, if one of the ways leads to it.
    fn at(
        &self,
        point: &SearchPoint,
        ways: &[AttemptSettings],
        runs: &mut Session,
        unproved: &mut Option<Box<Synthesized>>,
    ) -> Result<Option<Outcome>, SynthesisError> {
        let mut missing = None;
        for &way in ways {
            let Some(design) = self.attempt(point, way, runs)? else {
                continue;
            };
            let uncovered = self.extent(&design).0.is_some_and(|scale| scale < 1.0);
            match design.report.verdict {
                Verdict::Proved if self.missed(&design).is_none() => {
                    return Ok(Some(Outcome::Solved(closed(design, runs))));
                }
                // Giving more away cannot help.
                Verdict::Proved if uncovered => return self.short(point, design, runs).map(Some),
                // Another way may keep what this one misses.
                Verdict::Proved => missing = missing.or(Some(design)),
                Verdict::NotProved => *unproved = Some(design),
            }
        }
        match missing {
            Some(design) => self.short(point, design, runs).map(Some),
            None => Ok(None),
        }
    }

    /// The point with its numbers in few digits.
    fn rounded(&self, point: &SearchPoint) -> Result<SearchPoint, SynthesisError> {
        let space = &self.plan.space;
        let file = space.at(&point.coordinates);
        let ranges = space.ranges.iter().zip(&point.coordinates);
        let coordinates: Vec<f64> = ranges
            .map(|(range, &at)| {
                let value = range.parameter.of(&file).map(short);
                value.map_or(at, |value| range.parameter.coordinate(value))
            })
            .collect();
        let near = SearchPoint {
            coordinates: space.inside(&coordinates),
            value: point.value.clone(),
        };
        let solved = start::again(self.inner, &near)?;
        Ok(solved.unwrap_or_else(|| point.clone()))
    }

    /// The model at a point, with what it contains.
    fn model_at(&self, point: &SearchPoint, shrinking: f64) -> Option<Model> {
        let mut file = self.plan.space.at(&point.coordinates);
        for range in &self.plan.space.ranges {
            if let Some(value) = range.parameter.of(&file) {
                let [low, high] = range.limits;
                range
                    .parameter
                    .set(&mut file, short(value).clamp(low, high));
            }
        }
        if let Aim::Reach { .. } = self.inner.aim {
            // Short of the states themselves the design is for a part of each.
            let scale = point.value.height.exp() * (1.0 - shrinking);
            if scale <= 1.0 {
                let part = scale * (1.0 - CLAIM_ROOM);
                let states = file.specs.must_contain.iter_mut().flatten();
                states.for_each(|entry| *entry *= part);
            }
        }
        Model::new(file).ok()
    }

    fn attempt(
        &self,
        point: &SearchPoint,
        way: AttemptSettings,
        runs: &mut Session,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let Some(model) = self.model_at(point, way.shrinking) else {
            return Ok(None);
        };
        let mut covered = self.plan.covered.clone();
        let mut room = PEAK_ROOM;
        if let Aim::Reach { grown, .. } = self.inner.aim {
            let scale = point.value.height.exp() * (1.0 - way.shrinking);
            covered.extend(grown.iter().map(|set| set * scale));
            room = PEAK_ROOM_OF_A_REGION;
        }
        let mut task = model.task();
        task.specification.must_contain.clear();
        task.specification.margin = task.specification.margin.max(way.margin);
        task.coverage = Some(Coverage {
            linearisation: point.value.linearisation.clone(),
            covered,
            grown: Vec::new(),
        });
        let smallest = Scaling::automatic(&task.system, 1.0).state.min();
        let units = ProblemUnits {
            state_fraction: self.plan.unit * way.unit / smallest,
            containment_weight: 0.5,
        };
        let scaling = Scaling::automatic(&task.system, units.state_fraction);
        let scaled = scaling.apply(&task);
        let (assembled, smallest) = runs.solve(&scaled, Goal::SmallestPeak)?;
        let usable = |status| matches!(status, Status::Solved | Status::Inaccurate);
        let least = smallest.objective;
        if !(usable(smallest.status) && least.is_finite() && least > 0.0) {
            return Ok(None);
        }
        let making = Making {
            model: &model,
            task: &task,
            scaling: &scaling,
            units,
            point,
        };
        // The smallest g keeps the model's margin in every condition, which may do.
        let first = self.design(&making, &assembled, &smallest.values, least)?;
        let wide = matches!(self.inner.aim, Aim::Reach { .. });
        #[allow(clippy::borrowed_box)] // What the options below hold.
        let proved = |design: &Box<Synthesized>| design.report.verdict == Verdict::Proved;
        if wide && first.as_ref().is_some_and(proved) {
            return Ok(first);
        }
        let bound =
            self.inner.peak_bound(&task).unwrap_or(f64::INFINITY) / (1.0 + GAMMA_ROOM).powi(2);
        // Just above the bound it is left to the judgement.
        let peak = (least * (1.0 + room)).min(bound.max(least * (1.0 + PEAK_ROOM)));
        let (assembled, inside) = runs.solve(&scaled, Goal::LargestRoom { peak })?;
        let second = self.design(&making, &assembled, &inside.values, peak)?;
        Ok(match second {
            Some(second) if proved(&second) => Some(second),
            second => first.filter(proved).or(second),
        })
    }

    /// The design of a solver's point, checked.
    fn design(
        &self,
        making: &Making<'_>,
        assembled: &Assembled,
        values: &[f64],
        peak: f64,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let model = making.model;
        let Ok(mut certificate) = recover(model, &assembled.design, values, making.scaling) else {
            return Ok(None);
        };
        let above = peak.max(certificate.disturbance_weight);
        certificate.gain_bound = above * (1.0 + GAMMA_ROOM);
        if add_claims(model, &mut certificate).is_err() {
            return Ok(None);
        }
        let subject = DesignRequest::of_model(model, self.model_text, making.task, self.form);
        let mut design = match subject.design(&certificate, making.units) {
            Ok(design) => design,
            // Numbers that no design file may hold: a failed attempt.
            Err(SynthesisError::Invalid(_)) => return Ok(None),
            Err(other) => return Err(other),
        };
        design.file.provenance.search = Some(self.record(making.point, &model.file));
        Ok(Some(design))
    }

    fn record(&self, point: &SearchPoint, file: &ModelFile) -> SearchRecord {
        let varied = self.plan.space.ranges.iter().filter_map(|range| {
            let [lowest, highest] = range.limits;
            range.parameter.of(file).map(|value| VariedFile {
                field: range.parameter.field(),
                lowest,
                highest,
                value,
            })
        });
        SearchRecord {
            objective: match self.inner.aim {
                Aim::Reach { .. } => "region",
                Aim::Gain => "gain",
            }
            .to_string(),
            evaluations: self.inner.watch.count(),
            varied: varied.collect(),
            linearisation: rows(&point.value.linearisation),
        }
    }

    /// What a proved design misses of what was asked for, in words.
    fn missed(&self, design: &Synthesized) -> Option<String> {
        let limits = &self.plan.limits;
        let part = &design.file.certificate;
        let (scale, angle_deg) = self.extent(design);
        if let Some(scale) = scale.filter(|scale| *scale < 1.0) {
            return Some(uncovered(scale, angle_deg));
        }
        if let Some(limit) = limits.gamma_max.filter(|limit| part.gamma > *limit) {
            let gamma = part.gamma;
            return Some(format!(
                "the smallest gamma proved is {gamma:.5}; gamma_max is {limit}"
            ));
        }
        let gain = part.guaranteed_gain;
        if let Some(limit) = limits.guaranteed_gain_max.filter(|limit| gain > *limit) {
            return Some(format!(
                "the smallest guaranteed gain proved is {gain:.5}; guaranteed_gain_max is {limit}"
            ));
        }
        let ball = part.certified_vector_part.map(angle_of_vector_part_deg);
        let short = limits.certified_angle_min_deg.zip(ball);
        short.filter(|(limit, angle)| angle < limit).map(|(limit, angle)| {
            format!("every attitude at rest is proved up to {angle:.3} deg; certified_angle_min_deg is {limit}")
        })
    }

    /// The smallest scale over the states asked for, and the smallest angle.
    fn extent(&self, design: &Synthesized) -> (Option<f64>, Option<f64>) {
        let reached = reached(self.model, &design.file.certificate.lyapunov);
        let scale = reached.iter().map(|along| along.scale).reduce(f64::min);
        let angles = reached.iter().filter_map(|along| along.angle_deg);
        (scale, angles.reduce(f64::min))
    }

    /// How far one gets, with a proof, where that is not what was asked for.
    fn short(
        &self,
        point: &SearchPoint,
        design: Box<Synthesized>,
        runs: &Session,
    ) -> Result<Outcome, SynthesisError> {
        let (scale, angle_deg) = self.extent(&design);
        let shortfall = Shortfall {
            reason: self.missed(&design).unwrap_or_default(),
            scale,
            angle_deg,
            limits: sensitivities(self.inner, point)?,
        };
        let blocking = point.value.blocking.clone();
        Ok(Outcome::Undecided(decision(shortfall, blocking, runs)))
    }
}

/// How far x'Ux <= 1 goes along every state that a model must contain: proved, rounded down.
pub fn reached(model: &Model, lyapunov: &[Vec<f64>]) -> Vec<Along> {
    let n = lyapunov.len();
    let matrix = DMatrix::from_fn(n, n, |r, c| lyapunov[r].get(c).copied().unwrap_or(f64::NAN));
    let spacecraft = matches!(model.plant, Plant::Spacecraft(_));
    let states = model.file.specs.must_contain.iter();
    let states = states.filter(|state| state.len() == n);
    states
        .map(|state| along(&matrix, &DVector::from_column_slice(state), spacecraft))
        .collect()
}

fn uncovered(scale: f64, angle_deg: Option<f64>) -> String {
    let angle = angle_deg.map_or(String::new(), |angle| format!(" ({angle:.3} deg)"));
    format!(
        "the start is not covered: a design is proved for {:.2} % of it{angle}, and the search found no more",
        100.0 * scale
    )
}

fn closed(mut design: Box<Synthesized>, runs: &Session) -> Box<Synthesized> {
    design.solve_seconds = runs.seconds();
    design.file.provenance.solver_runs = runs.runs.clone();
    design
}

/// A number with few digits.
fn short(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return value;
    }
    let exponent = value.log10().floor() as i32;
    let digits = usize::try_from(DIGITS - 1 - exponent).unwrap_or(0).min(300);
    format!("{value:.digits$}").parse().unwrap_or(value)
}
