//! From the optimum of a search to a proved design.

use nalgebra::DVector;

use super::evaluator::{Aim, Evaluator, SearchPoint, REGION_MARGIN};
use super::plan::Plan;
use super::sensitivities::sensitivities;
use crate::certify::reach::{along, angle_of_vector_part_deg, Along};
use crate::certify::theorem1::certified_start;
use crate::claim::Claim;
use crate::conditions::xu2020::Containment;
use crate::conditions::Task;
use crate::design::{matrix, rows, DesignFile, ProblemUnits, SearchRecord, VariedFile};
use crate::model::{Model, ModelFile, Plant};
use crate::optimality::Optimality;
use crate::programs::{
    complete, scaled, Decision, DesignRequest, Goal, LimitingFactors, Outcome, Parameter, Session,
    SynthesisError, Synthesized,
};
use crate::synthesis::attempts::Smallest;
use crate::synthesis::gain::GainSynthesis;

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

/// The search whose result becomes a design.
pub struct Finish<'a> {
    pub model: &'a Model,
    pub model_text: &'a str,
    pub plan: &'a Plan,
    pub evaluator: &'a Evaluator<'a>,
}

impl Finish<'_> {
    /// Makes the design at the last iterate, or at an earlier one where it is not proved. The outcome is `Undecided`
    /// where the proved design misses a requirement.
    pub fn outcome(
        &self,
        iterates: &[SearchPoint],
        session: &mut Session,
    ) -> Result<Outcome, SynthesisError> {
        let Some(optimum) = iterates.last() else {
            let reason = LimitingFactors::unknown("the search found no point".to_string());
            let decision = Decision::of_search(reason, Vec::new(), &session.runs);
            return Ok(Outcome::Undecided(decision));
        };
        let (attempts, parts) = match self.evaluator.aim {
            Aim::Reach { .. } => (&REGION_ATTEMPTS[..], &POINTS[..]),
            Aim::Gain => (&GAIN_ATTEMPTS[..], &POINTS[..1]),
        };
        let index = |part: &f64| (part * (iterates.len() - 1) as f64).round() as usize;
        let mut indices: Vec<usize> = parts.iter().map(index).collect();
        indices.dedup();
        let mut unproved = None;
        for index in indices {
            let point = self.rounded(iterates.get(index).unwrap_or(optimum))?;
            if let Some(outcome) = self.at(&point, attempts, session, &mut unproved)? {
                return Ok(self.compared(outcome, optimum));
            }
        }
        if let Some(design) = unproved {
            return Ok(Outcome::Solved(design.with_runs(&session.runs)));
        }
        let reason = "the search found a point, but no solver could make a design of it";
        let limiting_factors = LimitingFactors {
            limits: sensitivities(self.evaluator, optimum)?,
            ..LimitingFactors::unknown(reason.to_string())
        };
        let blocking = optimum.blocking.clone();
        let decision = Decision::of_search(limiting_factors, blocking, &session.runs);
        Ok(Outcome::SolverFailed(decision))
    }

    /// The outcome with the relative gap to the best objective of the search.
    fn compared(&self, mut outcome: Outcome, optimum: &SearchPoint) -> Outcome {
        if let Outcome::Solved(design) = &mut outcome {
            let best = self.evaluator.aim.value(optimum.objective);
            design.optimality = match self.evaluator.aim {
                Aim::Reach { .. } => {
                    let scale = self.extent(design).0;
                    scale.and_then(|scale| Optimality::of_largest(scale, best))
                }
                Aim::Gain => {
                    let gain = design.file.certificate.guaranteed_gain;
                    Optimality::of_smallest(gain, best)
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
        session: &mut Session,
        unproved: &mut Option<Box<Synthesized>>,
    ) -> Result<Option<Outcome>, SynthesisError> {
        let mut missing = None;
        for &settings in attempts {
            let Some(design) = self.attempt(point, settings, session)? else {
                continue;
            };
            if !design.is_proved() {
                *unproved = Some(design);
                continue;
            }
            if self.missed(&design).is_none() {
                return Ok(Some(Outcome::Solved(design.with_runs(&session.runs))));
            }
            // Other settings may meet what these miss, but a larger back-off covers no more.
            let uncovered = self.extent(&design).0.is_some_and(|scale| scale < 1.0);
            missing = match uncovered {
                true => Some(design),
                false => missing.or(Some(design)),
            };
            if uncovered {
                break;
            }
        }
        if missing.is_none() && matches!(self.evaluator.aim, Aim::Gain) {
            if let Some(design) = self.in_other_units(point, session)? {
                if self.missed(&design).is_none() {
                    return Ok(Some(Outcome::Solved(design.with_runs(&session.runs))));
                }
                missing = Some(design);
            }
        }
        let outcome = missing.map(|design| self.short(point, &design, session));
        outcome.transpose()
    }

    /// A proved design at a point from attempts as for a single design, in one system of units after the other.
    fn in_other_units(
        &self,
        point: &SearchPoint,
        session: &mut Session,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let Some(model) = self.model_at(point, 0.0) else {
            return Ok(None);
        };
        let mut task = self.task_at(point, GAIN_ATTEMPTS[0], &model);
        task.gain_per_weight = model.task().gain_per_weight;
        let request = DesignRequest::of_model(&model, self.model_text, &task, session.form);
        let found = GainSynthesis::new(request, None, session).in_all_settings()?;
        Ok(found.best.map(|mut design| {
            design.file.provenance.search = Some(self.record(point, &design.file.model));
            design
        }))
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
        let near = space.inside(&coordinates);
        let solved = self.evaluator.solve(&near, &point.linearisation)?;
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
            let scale = point.objective.exp() * (1.0 - shrinking);
            if scale <= 1.0 {
                let part = scale * (1.0 - CLAIM_ALLOWANCE);
                let states = file.specs.must_contain.iter_mut().flatten();
                states.for_each(|entry| *entry *= part);
            }
        }
        Model::new(file).ok()
    }

    /// A design at the smallest g, or well inside a little above it.
    fn attempt(
        &self,
        point: &SearchPoint,
        settings: AttemptSettings,
        session: &mut Session,
    ) -> Result<Option<Box<Synthesized>>, SynthesisError> {
        let Some(model) = self.model_at(point, settings.shrinking) else {
            return Ok(None);
        };
        let wide = matches!(self.evaluator.aim, Aim::Reach { .. });
        let task = self.task_at(point, settings, &model);
        let own = &self.evaluator.scaling.state * settings.unit;
        let units = ProblemUnits {
            state_fraction: 1.0,
            containment_weight: 0.5,
            state_units: own.iter().copied().collect(),
        };
        let request = DesignRequest::of_model(&model, self.model_text, &task, session.form);
        // The design of a solver's point, checked.
        let mut design = |goal: Goal, peak: Option<f64>| {
            let solved = session.solve(scaled(&task, &units), goal)?;
            let least = match Smallest::of(&solved.assembled.problem, &solved.solution) {
                Smallest::Bound { bound, .. } => Some(bound),
                _ => None,
            };
            let Some(peak) = peak.or(least) else {
                return Ok((None, None));
            };
            let Some(mut certificate) = solved.recover(&model) else {
                return Ok((least, None));
            };
            let above = peak.max(certificate.disturbance_weight);
            certificate.gain_bound = above * (1.0 + GAMMA_ALLOWANCE);
            let certificate = complete(&model, certificate, session)?;
            let design = certificate.and_then(|certificate| {
                let mut design = request.design(&certificate, None, &units)?;
                design.file.provenance.search = Some(self.record(point, &model.file));
                Some(design)
            });
            Ok::<_, SynthesisError>((least, design))
        };
        let (Some(least), first) = design(Goal::SmallestPeak, None)? else {
            return Ok(None);
        };
        // The smallest g leaves the model's margin in every condition, which may suffice.
        let first = first.filter(|design| design.is_proved());
        if wide && first.is_some() {
            return Ok(first);
        }
        let bound = self.evaluator.peak_bound(&task).unwrap_or(f64::INFINITY)
            / (1.0 + GAMMA_ALLOWANCE).powi(2);
        let back_off = match wide {
            true => PEAK_BACK_OFF_OF_A_REGION,
            false => PEAK_BACK_OFF,
        };
        // Just above the bound the requirements decide.
        let peak = (least * (1.0 + back_off)).min(bound.max(least * (1.0 + PEAK_BACK_OFF)));
        let (_, second) = design(Goal::LargestMarginAtPeak { peak }, Some(peak))?;
        Ok(match second {
            Some(second) if second.is_proved() => Some(second),
            second => first.or(second),
        })
    }

    /// The task of a model made at a point, with the sets that it must contain.
    fn task_at(&self, point: &SearchPoint, settings: AttemptSettings, model: &Model) -> Task {
        let mut contained = self.plan.contained.clone();
        if let Aim::Reach { scaled, .. } = self.evaluator.aim {
            let scale = point.objective.exp() * (1.0 - settings.shrinking);
            contained.extend(scaled.iter().map(|set| set * scale));
        }
        let mut task = model.task();
        task.specification.must_contain.clear();
        task.gain_per_weight = 1.0;
        task.specification.margin = task.specification.margin.max(settings.margin);
        task.containment = Some(Containment {
            linearisation: point.linearisation.clone(),
            contained,
            scaled: Vec::new(),
        });
        task
    }

    fn record(&self, point: &SearchPoint, file: &ModelFile) -> SearchRecord {
        let varied = self.plan.space.ranges.iter().filter(|range| {
            // The form of the gyroscopic torque stands in the model, whole.
            !matches!(
                range.parameter,
                Parameter::FormMean | Parameter::FormDeviation
            )
        });
        let varied = varied.filter_map(|range| {
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
            linearisation: rows(&point.linearisation),
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
            let gamma = Claim::AtMost(part.gamma);
            return Some(format!(
                "the smallest gamma proved is {gamma}; gamma_max is {limit}"
            ));
        }
        let gain = part.guaranteed_gain;
        if let Some(limit) = limits.guaranteed_gain_max.filter(|limit| gain > *limit) {
            let gain = Claim::AtMost(gain);
            return Some(format!(
                "the smallest guaranteed gain proved is {gain}; guaranteed_gain_max is {limit}"
            ));
        }
        let ball = part.certified_vector_part.map(angle_of_vector_part_deg);
        let short = limits.certified_angle_min_deg.zip(ball);
        short.filter(|(limit, angle)| angle < limit).map(|(limit, angle)| {
            let angle = Claim::AtLeast(angle);
            format!("every attitude at rest is proved up to {angle} deg; certified_angle_min_deg is {limit}")
        })
    }

    /// The smallest scale over the requested states, and the smallest angle (deg).
    fn extent(&self, design: &Synthesized) -> (Option<f64>, Option<f64>) {
        let reached = reached(self.model, &design.file);
        let scale = reached.iter().map(|along| along.scale).reduce(f64::min);
        let angles = reached.iter().filter_map(|along| along.angle_deg);
        (scale, angles.reduce(f64::min))
    }

    /// The outcome for a proved design that misses a requirement.
    fn short(
        &self,
        point: &SearchPoint,
        design: &Synthesized,
        session: &Session,
    ) -> Result<Outcome, SynthesisError> {
        let (scale, angle_deg) = self.extent(design);
        let limiting_factors = LimitingFactors {
            reason: self.missed(design).unwrap_or_default(),
            scale,
            angle_deg,
            limits: sensitivities(self.evaluator, point)?,
        };
        let blocking = point.blocking.clone();
        let decision = Decision::of_search(limiting_factors, blocking, &session.runs);
        Ok(Outcome::Undecided(decision))
    }
}

/// How far x'Ux <= 1 goes along every state that a model must contain: proved, rounded down.
pub fn reached(model: &Model, design: &DesignFile) -> Vec<Along> {
    // A certificate that cannot be read starts from nowhere.
    let certificate = Model::new(design.model.clone())
        .and_then(|own| Ok(certified_start(&own, &design.certificate(&own)?)));
    let start = certificate.unwrap_or(0.0);
    let matrix = matrix(&design.certificate.lyapunov);
    let spacecraft = matches!(model.plant, Plant::Spacecraft(_));
    let states = model.file.specs.must_contain.iter();
    let states = states.filter(|state| state.len() == matrix.nrows());
    states
        .map(|state| {
            along(
                &matrix,
                start,
                &DVector::from_column_slice(state),
                spacecraft,
            )
        })
        .collect()
}

fn uncovered(scale: f64, angle_deg: Option<f64>) -> String {
    let angle = angle_deg.map(Claim::AtLeast);
    let angle = angle.map_or(String::new(), |angle| format!(" ({angle} deg)"));
    format!(
        "the start is not covered: a design is proved for {:.4} % of it{angle}, and the search found no more",
        Claim::AtLeast(100.0 * scale)
    )
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
