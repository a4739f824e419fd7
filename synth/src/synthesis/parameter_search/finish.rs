//! From the optimum of a search to a proved design.

use nalgebra::{DMatrix, DVector};

use super::evaluator::{Aim, Evaluator, SearchPoint, REGION_MARGIN};
use super::plan::Plan;
use super::sensitivities::sensitivities;
use super::start;
use super::undecided::{no_design, undecided_decision};
use crate::certify::reach::{along, angle_of_vector_part_deg, Along};
use crate::certify::Verdict;
use crate::conditions::xu2020::Containment;
use crate::conditions::Task;
use crate::design::{add_claims, recover, rows, ProblemUnits, SearchRecord, VariedFile};
use crate::model::{Model, ModelFile, Plant};
use crate::optimality::Optimality;
use crate::programs::{
    Assembled, DesignRequest, Form, Goal, LimitingFactors, Outcome, Session, SynthesisError,
    Synthesized,
};
use crate::scaling::Scaling;
use sdp::solve::Status;

/// Settings of one attempt at a design; they are tried in order until a design is proved.
#[derive(Debug, Clone, Copy)]
struct AttemptSettings {
    /// Fraction of the scale found that is given up as back-off.
    shrinking: f64,
    /// Unit of the state, relative to the search's.
    unit: f64,
    /// Least margin in scaled units. A large set has entries of very different sizes in one condition, and the
    /// model's own margin may be lost in them.
    margin: f64,
}

const fn settings(shrinking: f64, unit: f64, margin: f64) -> AttemptSettings {
    AttemptSettings {
        shrinking,
        unit,
        margin,
    }
}

const REGION_ATTEMPTS: [AttemptSettings; 1] = [settings(1e-2, 1.0, 0.1 * REGION_MARGIN)];

/// Iterates of a region's search that are tried, as fractions of their number: the program may be too ill-conditioned
/// at the optimum.
const POINTS: [f64; 5] = [1.0, 0.6, 0.4, 0.2, 0.0];

const GAIN_ATTEMPTS: [AttemptSettings; 3] = [
    settings(0.0, 1.0, 0.0),
    settings(0.0, 0.25, 0.0),
    settings(0.0, 4.0, 0.0),
];

/// Back-off of the bound g of the exported design above the smallest, relative: it leaves a margin for the proof. Where
/// the region is the objective, the gain matters less and more is given up.
const PEAK_BACK_OFF: f64 = 1e-3;
const PEAK_BACK_OFF_OF_A_REGION: f64 = 2e-2;

/// How far gamma lies above max(g, xi).
const GAMMA_ALLOWANCE: f64 = 1e-6;

/// Relative allowance of the fraction of a state that a design must contain.
const CLAIM_ALLOWANCE: f64 = 1e-6;

/// Significant digits of the numbers that the search chose.
const DIGITS: i32 = 5;

/// The data of one attempt.
struct AttemptContext<'a> {
    model: &'a Model,
    task: &'a Task,
    scaling: &'a Scaling,
    units: ProblemUnits,
    point: &'a SearchPoint,
}

/// The search whose result becomes a design.
pub struct Finish<'a> {
    pub model: &'a Model,
    pub model_text: &'a str,
    pub form: Form,
    pub plan: &'a Plan,
    pub evaluator: &'a Evaluator<'a>,
}

impl Finish<'_> {
    /// Makes the design at the last iterate, or at an earlier one where it is not proved. The outcome is `Undecided`
    /// where the proved design misses a requirement.
    pub fn outcome(
        &self,
        iterates: &[SearchPoint],
        runs: &mut Session,
    ) -> Result<Outcome, SynthesisError> {
        let Some(optimum) = iterates.last() else {
            return Ok(no_design("the search found no point".to_string(), runs));
        };
        let (attempts, parts) = match self.evaluator.aim {
            Aim::Reach { .. } => (&REGION_ATTEMPTS[..], &POINTS[..]),
            Aim::Gain => (&GAIN_ATTEMPTS[..], &POINTS[..1]),
        };
        let mut unproved = None;
        let mut tried = usize::MAX;
        for part in parts {
            let index = (part * (iterates.len() - 1) as f64).round() as usize;
            if index == tried {
                continue;
            }
            tried = index;
            let point = self.rounded(iterates.get(index).unwrap_or(optimum))?;
            if let Some(outcome) = self.at(&point, attempts, runs, &mut unproved)? {
                return Ok(self.compared(outcome, optimum));
            }
        }
        Ok(match unproved {
            Some(design) => Outcome::Solved(closed(design, runs)),
            None => {
                let reason = "the search found a point, but no solver could make a design of it";
                let limiting_factors = LimitingFactors {
                    reason: reason.to_string(),
                    scale: None,
                    angle_deg: None,
                    limits: sensitivities(self.evaluator, optimum)?,
                };
                Outcome::SolverFailed(undecided_decision(
                    limiting_factors,
                    optimum.value.blocking.clone(),
                    runs,
                ))
            }
        })
    }

    /// The outcome with the relative gap to the best objective of the search.
    fn compared(&self, mut outcome: Outcome, optimum: &SearchPoint) -> Outcome {
        if let Outcome::Solved(design) = &mut outcome {
            let objective = optimum.value.objective;
            design.optimality = match self.evaluator.aim {
                Aim::Reach { .. } => {
                    let scale = self.extent(design).0;
                    scale.and_then(|scale| Optimality::of_largest(scale, objective.exp()))
                }
                Aim::Gain => {
                    let gain = design.file.certificate.guaranteed_gain;
                    Optimality::of_smallest(gain, (-objective).exp())
                }
            };
        }
        outcome
    }

    /// A proved design at a point, if one of the attempts gives it.
    fn at(
        &self,
        point: &SearchPoint,
        attempts: &[AttemptSettings],
        runs: &mut Session,
        unproved: &mut Option<Box<Synthesized>>,
    ) -> Result<Option<Outcome>, SynthesisError> {
        let mut missing = None;
        for &settings in attempts {
            let Some(design) = self.attempt(point, settings, runs)? else {
                continue;
            };
            let uncovered = self.extent(&design).0.is_some_and(|scale| scale < 1.0);
            match design.report.verdict {
                Verdict::Proved if self.missed(&design).is_none() => {
                    return Ok(Some(Outcome::Solved(closed(design, runs))));
                }
                // A larger back-off cannot help.
                Verdict::Proved if uncovered => return self.short(point, design, runs).map(Some),
                // Other settings may meet what these miss.
                Verdict::Proved => missing = missing.or(Some(design)),
                Verdict::NotProved => *unproved = Some(design),
            }
        }
        match missing {
            Some(design) => self.short(point, design, runs).map(Some),
            None => Ok(None),
        }
    }

    /// The point with its parameters rounded to a few significant digits.
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
        let solved = start::again(self.evaluator, &near)?;
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
        if let Aim::Reach { .. } = self.evaluator.aim {
            // Below scale 1 the design is for a fraction of each state.
            let scale = point.value.objective.exp() * (1.0 - shrinking);
            if scale <= 1.0 {
                let part = scale * (1.0 - CLAIM_ALLOWANCE);
                let states = file.specs.must_contain.iter_mut().flatten();
                states.for_each(|entry| *entry *= part);
            }
        }
        Model::new(file).ok()
    }

    fn attempt(
        &self,
        point: &SearchPoint,
        settings: AttemptSettings,
        runs: &mut Session,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let Some(model) = self.model_at(point, settings.shrinking) else {
            return Ok(None);
        };
        let mut contained = self.plan.contained.clone();
        let mut back_off = PEAK_BACK_OFF;
        if let Aim::Reach { scaled, .. } = self.evaluator.aim {
            let scale = point.value.objective.exp() * (1.0 - settings.shrinking);
            contained.extend(scaled.iter().map(|set| set * scale));
            back_off = PEAK_BACK_OFF_OF_A_REGION;
        }
        let mut task = model.task();
        task.specification.must_contain.clear();
        task.specification.margin = task.specification.margin.max(settings.margin);
        task.containment = Some(Containment {
            linearisation: point.value.linearisation.clone(),
            contained,
            scaled: Vec::new(),
        });
        let smallest = Scaling::automatic(&task.system, 1.0).state.min();
        let units = ProblemUnits {
            state_fraction: self.plan.unit * settings.unit / smallest,
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
        let context = AttemptContext {
            model: &model,
            task: &task,
            scaling: &scaling,
            units,
            point,
        };
        // The smallest g leaves the model's margin in every condition, which may suffice.
        let first = self.design(&context, &assembled, &smallest.values, least)?;
        let wide = matches!(self.evaluator.aim, Aim::Reach { .. });
        #[allow(clippy::borrowed_box)] // The type inside the options below.
        let proved = |design: &Box<Synthesized>| design.report.verdict == Verdict::Proved;
        if wide && first.as_ref().is_some_and(proved) {
            return Ok(first);
        }
        let bound = self.evaluator.peak_bound(&task).unwrap_or(f64::INFINITY)
            / (1.0 + GAMMA_ALLOWANCE).powi(2);
        // Just above the bound the requirements decide.
        let peak = (least * (1.0 + back_off)).min(bound.max(least * (1.0 + PEAK_BACK_OFF)));
        let (assembled, inside) = runs.solve(&scaled, Goal::LargestMarginAtPeak { peak })?;
        let second = self.design(&context, &assembled, &inside.values, peak)?;
        Ok(match second {
            Some(second) if proved(&second) => Some(second),
            second => first.filter(proved).or(second),
        })
    }

    /// The design of a solver's point, checked.
    fn design(
        &self,
        context: &AttemptContext<'_>,
        assembled: &Assembled,
        values: &[f64],
        peak: f64,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let model = context.model;
        let Ok(mut certificate) = recover(model, &assembled.design, values, context.scaling) else {
            return Ok(None);
        };
        let above = peak.max(certificate.disturbance_weight);
        certificate.gain_bound = above * (1.0 + GAMMA_ALLOWANCE);
        if add_claims(model, &mut certificate).is_err() {
            return Ok(None);
        }
        let subject = DesignRequest::of_model(model, self.model_text, context.task, self.form);
        let mut design = match subject.design(&certificate, context.units) {
            Ok(design) => design,
            // Numbers that no design file may hold: a failed attempt.
            Err(SynthesisError::Invalid(_)) => return Ok(None),
            Err(other) => return Err(other),
        };
        design.file.provenance.search = Some(self.record(context.point, &model.file));
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
            objective: match self.evaluator.aim {
                Aim::Reach { .. } => "region",
                Aim::Gain => "gain",
            }
            .to_string(),
            evaluations: self.evaluator.progress.count(),
            varied: varied.collect(),
            linearisation: rows(&point.value.linearisation),
        }
    }

    /// The first requirement that a proved design misses, as a sentence.
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

    /// The smallest scale over the requested states, and the smallest angle (deg).
    fn extent(&self, design: &Synthesized) -> (Option<f64>, Option<f64>) {
        let reached = reached(self.model, &design.file.certificate.lyapunov);
        let scale = reached.iter().map(|along| along.scale).reduce(f64::min);
        let angles = reached.iter().filter_map(|along| along.angle_deg);
        (scale, angles.reduce(f64::min))
    }

    /// The outcome for a proved design that misses a requirement.
    fn short(
        &self,
        point: &SearchPoint,
        design: Box<Synthesized>,
        runs: &Session,
    ) -> Result<Outcome, SynthesisError> {
        let (scale, angle_deg) = self.extent(&design);
        let limiting_factors = LimitingFactors {
            reason: self.missed(&design).unwrap_or_default(),
            scale,
            angle_deg,
            limits: sensitivities(self.evaluator, point)?,
        };
        let blocking = point.value.blocking.clone();
        Ok(Outcome::Undecided(undecided_decision(
            limiting_factors,
            blocking,
            runs,
        )))
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

/// A number rounded to [`DIGITS`] significant digits.
fn short(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return value;
    }
    let exponent = value.log10().floor() as i32;
    let digits = usize::try_from(DIGITS - 1 - exponent).unwrap_or(0).min(300);
    format!("{value:.digits$}").parse().unwrap_or(value)
}
