//! The iterations: an infeasible-start primal-dual interior-point method with the HKM direction (Helmberg, Rendl,
//! Vanderbei, Wolkowicz 1996; Kojima, Shindoh, Hara 1997; Monteiro 1997) and Mehrotra's predictor and corrector.

use super::dense::dot;
use super::exit::{Measures, SolveTask, SolverExit, Termination, Timings, FEASIBLE};
use super::iterate::{longest_step, Factors, StepWork};
use super::layout::Iterate;
use super::ray;
use super::schur::{SchurPlan, SchurWork};
use super::system::System;
use super::threads::threads_now;
use super::warm::Iterates;

/// Most iterations.
pub const ITERATIONS: u32 = 200;

/// Iterations without progress after which the best point is returned.
const PATIENCE: u32 = 12;

/// The same once the best point has reduced accuracy; none at all when the linear system needs a shift by then.
const LITTLE_PATIENCE: u32 = 2;

/// Most solves for one direction, each for what the one before left of the residual.
const REFINEMENTS: usize = 4;

/// Residual of `<A_i, Z + dZ> = c_i`, relative, at which a direction is good enough.
const REFINED: f64 = 1e-8;

/// Steps shorter than this, twice in a row, are a stall.
const SHORTEST_STEP: f64 = 1e-5;

struct Iteration<'a> {
    task: &'a SolveTask<'a>,
    plan: SchurPlan,
    system: System,
    schur: SchurWork,
    factors: Factors,
    /// Threads used now.
    threads: usize,
    /// For S and for Z.
    steps: [StepWork; 2],
    product: Vec<f64>,
    /// `constant + A(y) - S`, zero once `feasible`.
    residual: Vec<f64>,
    feasible: bool,
    /// `<A_i, Z>` of the point.
    products: Vec<f64>,
    constant_norm: f64,
    cost_norm: f64,
    timings: Timings,
}

/// Iterates from `start`; iterates that another solve may start from are kept in `iterates`.
pub fn solve(task: &SolveTask<'_>, start: Iterate, iterates: Option<&mut Iterates>) -> SolverExit {
    let layout = task.layout;
    if layout.cost.is_empty() {
        // Nothing is unknown, and what is known holds.
        return SolverExit {
            termination: Termination::Solved,
            point: start,
            measures: Measures::default(),
            feasible: true,
            iterations: 0,
            timings: Timings::default(),
        };
    }
    let mut run = Iteration {
        task,
        plan: SchurPlan::new(layout),
        system: System::default(),
        schur: SchurWork::default(),
        factors: Factors::new(layout),
        steps: Default::default(),
        threads: threads_now(task.threads),
        product: vec![0.0; layout.length],
        residual: vec![0.0; layout.length],
        feasible: false,
        products: vec![0.0; layout.cost.len()],
        constant_norm: layout.constant_norm(),
        cost_norm: dot(&layout.cost, &layout.cost).sqrt(),
        timings: Timings::default(),
    };
    let begin = std::time::Instant::now();
    // Inside of the pool a half is taken over without waking a thread; a thread that is late finds nothing to do.
    let mut outcome = match run.threads {
        0 | 1 => run.iterate(start, iterates),
        _ => rayon::scope(|_| run.iterate(start, iterates)),
    };
    let Timings { schur, linear, .. } = run.timings;
    outcome.timings = Timings {
        rest: begin.elapsed().as_secs_f64() - schur - linear,
        ..run.timings
    };
    outcome
}

impl Iteration<'_> {
    fn iterate(&mut self, mut point: Iterate, mut iterates: Option<&mut Iterates>) -> SolverExit {
        let layout = self.task.layout;
        let mut best: Option<(f64, Iterate, Measures)> = None;
        let mut since_best = 0;
        let mut since_nearer = 0;
        let mut least_complementarity = f64::INFINITY;
        let mut short_steps = 0;
        let mut stalled = "iteration limit";
        let mut iteration = 0;
        while iteration < self.task.iterations {
            self.threads = threads_now(self.task.threads);
            self.refresh_slack(&mut point);
            if !self.factors.update(layout, &point, self.threads) {
                stalled = "a matrix lost its definiteness";
                break;
            }
            let measures = self.measure(&point);
            let distance = measures.distance(self.task.relative_gap);
            if !(self.task.observer)(iteration, &measures) {
                return self.exit(Termination::Cancelled, point, measures, iteration);
            }
            if distance <= 1.0 {
                return self.exit(Termination::Solved, point, measures, iteration);
            }
            let complementarity = dot(&point.s, &point.z);
            let nearer = best
                .as_ref()
                .is_none_or(|(least, ..)| distance < 0.9 * least);
            let progress = nearer || complementarity < 0.9 * least_complementarity;
            since_best = if progress { 0 } else { since_best + 1 };
            least_complementarity = complementarity.min(least_complementarity);
            let gap = self.task.relative_gap;
            // A smaller distance is no reason to give up a point of reduced accuracy.
            let replaces = |(least, _, at): &(f64, Iterate, Measures)| match (
                measures.nearly_there(gap),
                at.nearly_there(gap),
            ) {
                (true, false) => true,
                (false, true) => false,
                _ => distance < *least,
            };
            if best.as_ref().is_none_or(replaces) {
                best = Some((distance, point.clone(), measures));
            }
            let kept = best.as_ref();
            let near = kept.is_some_and(|(.., at)| at.nearly_there(gap));
            let lost = near && kept.is_some_and(|(least, ..)| distance > 100.0 * least);
            since_nearer = if nearer { 0 } else { since_nearer + 1 };
            let patience = if self.system.shift > 0.0 {
                0
            } else {
                LITTLE_PATIENCE
            };
            if since_best > PATIENCE || lost || (near && since_nearer > patience) {
                stalled = "no progress";
                break;
            }
            if let (true, Some(iterates)) = (self.feasible, iterates.as_deref_mut()) {
                iterates.record(layout, self.task.problem, &point);
            }
            if !self.build_system(&point) {
                stalled = "the linear system lost its definiteness";
                break;
            }
            if !self.feasible && measures.dual_objective > 0.0 {
                let (system, factors) = (&self.system, &self.factors);
                if let Some(ray) = ray::dual(layout, system, factors, &point.z, self.threads) {
                    point.z = ray;
                    return self.exit(Termination::Infeasible, point, measures, iteration);
                }
            }
            if measures.objective < 0.0 && measures.dual_residual > FEASIBLE {
                if let Some(ray) = ray::primal(layout, &point.y) {
                    point.y = ray;
                    return self.exit(Termination::Unbounded, point, measures, iteration);
                }
            }
            let Some(steps) = self.advance(&mut point) else {
                stalled = "the direction is not finite";
                break;
            };
            short_steps = if steps.0.max(steps.1) < SHORTEST_STEP {
                short_steps + 1
            } else {
                0
            };
            iteration += 1;
            if short_steps >= 2 {
                stalled = "the steps became too short";
                break;
            }
        }
        self.conclude(best, point, iteration, stalled)
    }

    /// The best point so far, with the most that can be said of it.
    fn conclude(
        &mut self,
        best: Option<(f64, Iterate, Measures)>,
        last: Iterate,
        iterations: u32,
        stalled: &'static str,
    ) -> SolverExit {
        let gap = self.task.relative_gap;
        let Some((_, point, measures)) = best else {
            let measures = self.measure(&last);
            return self.exit(Termination::Stalled(stalled), last, measures, iterations);
        };
        let termination = match measures.nearly_there(gap) {
            true => Termination::Reduced(stalled),
            false => Termination::Stalled(stalled),
        };
        self.exit(termination, point, measures, iterations)
    }

    fn exit(
        &self,
        termination: Termination,
        point: Iterate,
        measures: Measures,
        iterations: u32,
    ) -> SolverExit {
        SolverExit {
            termination,
            point,
            measures,
            feasible: self.feasible,
            iterations,
            timings: Timings::default(),
        }
    }

    /// Computes the residual of the slack, or, where it is nothing but rounding, the slack itself from y.
    fn refresh_slack(&mut self, point: &mut Iterate) {
        let layout = self.task.layout;
        layout.evaluate(1.0, &point.y, self.threads, &mut self.residual);
        if self.feasible {
            point.s.copy_from_slice(&self.residual);
            self.residual.fill(0.0);
            return;
        }
        for (r, s) in self.residual.iter_mut().zip(&point.s) {
            *r -= s;
        }
        let size = dot(&self.residual, &self.residual).sqrt();
        if size <= 1e-6 * (1.0 + self.constant_norm) {
            // Close enough when the slack from y is positive definite without much change.
            let mut shifted = point.s.clone();
            for (s, r) in shifted.iter_mut().zip(&self.residual) {
                *s += 2.0 * r;
            }
            if super::iterate::positive_definite(layout, &shifted) {
                self.feasible = true;
                for (s, r) in point.s.iter_mut().zip(&mut self.residual) {
                    *s += *r;
                    *r = 0.0;
                }
            }
        }
    }

    fn measure(&mut self, point: &Iterate) -> Measures {
        let layout = self.task.layout;
        let objective = dot(&layout.cost, &point.y);
        let dual_objective = -layout.against_constant(&point.z);
        layout.adjoint(&point.z, self.threads, &mut self.products);
        let sizes = objective.abs().max(dual_objective.abs());
        let size = sizes.max(self.task.objective_unit);
        Measures {
            objective,
            dual_objective,
            relative_gap: (objective - dual_objective).abs() / size,
            slack_residual: dot(&self.residual, &self.residual).sqrt() / (1.0 + self.constant_norm),
            dual_residual: layout.dual_residual(&self.products) / (1.0 + self.cost_norm),
        }
    }

    fn build_system(&mut self, point: &Iterate) -> bool {
        let layout = self.task.layout;
        let begin = std::time::Instant::now();
        self.plan.assemble(
            layout,
            &point.z,
            &self.factors.s_inverse,
            self.threads,
            &mut self.system.matrix,
            &mut self.schur,
        );
        self.timings.schur += begin.elapsed().as_secs_f64();
        let begin = std::time::Instant::now();
        let factored = self.system.factor(layout.cost.len());
        self.timings.linear += begin.elapsed().as_secs_f64();
        factored
    }

    /// Predictor, corrector, step. `None` when a direction is not finite.
    fn advance(&mut self, point: &mut Iterate) -> Option<(f64, f64)> {
        let layout = self.task.layout;
        let order = layout.order as f64;
        let complementarity = dot(&point.s, &point.z) / order;
        // The term that the residual of the slack adds to Z.
        let mut base = vec![0.0; layout.length];
        if !self.feasible {
            let (factors, residual) = (&self.factors, &self.residual);
            factors.sandwich(layout, &point.z, residual, self.threads, &mut base);
            base.iter_mut().for_each(|entry| *entry = -*entry);
        }
        let predictor = self.direction(point, &base, 1.0)?;
        let (s_step, z_step) = self.step_lengths(point, &predictor, 1.0);
        let step = s_step.min(z_step);
        let (centring, fraction, weight) = self.caution(point, &predictor, (s_step, z_step));
        // The corrector: second-order term of the predictor.
        let mut target = vec![0.0; layout.length];
        let Iterate { s, z, .. } = &predictor;
        self.factors
            .sandwich(layout, z, s, self.threads, &mut target);
        let inverse = &self.factors.s_inverse;
        let aim = centring * complementarity;
        for k in 0..layout.length {
            target[k] = aim * inverse[k] + fraction * base[k] - weight * target[k];
        }
        let mut direction = self.direction(point, &target, fraction)?;
        let damping = 0.9 + 0.09 * step.min(1.0);
        let (mut s_step, mut z_step) = self.step_lengths(point, &direction, damping);
        if s_step.min(z_step) < 0.1 {
            // The second-order term misled: a centring step without it.
            let inverse = &self.factors.s_inverse;
            for k in 0..layout.length {
                target[k] = 0.5 * complementarity * inverse[k] + base[k];
            }
            let centred = self.direction(point, &target, 1.0)?;
            let (s_centred, z_centred) = self.step_lengths(point, &centred, damping);
            if s_centred.min(z_centred) > s_step.min(z_step) {
                (direction, s_step, z_step) = (centred, s_centred, z_centred);
            }
        }
        let along = |step: f64, from: &mut [f64], direction: &[f64]| {
            from.iter_mut()
                .zip(direction)
                .for_each(|(x, d)| *x += step * d);
        };
        along(s_step, &mut point.y, &direction.y);
        along(s_step, &mut point.s, &direction.s);
        along(z_step, &mut point.z, &direction.z);
        Some((s_step, z_step))
    }

    /// After the predictor and its steps: how much to centre, the fraction of the residuals to remove, and the weight
    /// of the second-order term.
    fn caution(&self, point: &Iterate, predictor: &Iterate, steps: (f64, f64)) -> (f64, f64, f64) {
        let (s_step, z_step) = steps;
        let step = s_step.min(z_step);
        if self.task.cautious {
            // The residuals shrink no faster than the complementarity: asking for all of them at once drives the
            // points to the boundary, where the steps stay short.
            let centring = (1.0 - step).powi(2).clamp(1e-6, 0.95);
            return (centring, 1.0 - centring, (s_step * z_step).sqrt());
        }
        let mut after = 0.0;
        for k in 0..point.s.len() {
            after +=
                (point.s[k] + s_step * predictor.s[k]) * (point.z[k] + z_step * predictor.z[k]);
        }
        let ratio = (after / dot(&point.s, &point.z)).clamp(0.0, 1.0);
        let exponent = (3.0 * step * step).max(2.0);
        (ratio.powf(exponent).clamp(1e-6, 0.95), 1.0, 1.0)
    }

    /// The direction with `dZ + sym(Z A(dy) S^-1) = target - Z` that removes a fraction of both residuals: with all
    /// of them, `<A_i, Z + dZ> = c_i`.
    fn direction(&mut self, point: &Iterate, target: &[f64], fraction: f64) -> Option<Iterate> {
        let layout = self.task.layout;
        let unknowns = layout.cost.len();
        let mut goal = self.products.clone();
        for (goal, c) in goal.iter_mut().zip(&layout.cost) {
            *goal = fraction * c + (1.0 - fraction) * *goal;
        }
        let mut rhs = vec![0.0; unknowns];
        let mut correction = vec![0.0; unknowns];
        let mut y = vec![0.0; unknowns];
        let mut s = vec![0.0; layout.length];
        // Z + dZ, which is the target before anything is subtracted.
        let mut z = target.to_vec();
        let mut before = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            layout.adjoint(&z, self.threads, &mut rhs);
            rhs.iter_mut().zip(&goal).for_each(|(r, c)| *r -= c);
            let size = dot(&rhs, &rhs).sqrt();
            if size <= REFINED * (1.0 + self.cost_norm) || size > 0.5 * before {
                break;
            }
            before = size;
            let begin = std::time::Instant::now();
            self.system.solve(&rhs, &mut correction);
            self.timings.linear += begin.elapsed().as_secs_f64();
            if !correction.iter().all(|value| value.is_finite()) {
                return None;
            }
            y.iter_mut().zip(&correction).for_each(|(y, d)| *y += d);
            layout.evaluate(0.0, &y, self.threads, &mut s);
            z.copy_from_slice(target);
            self.factors
                .sandwich(layout, &point.z, &s, self.threads, &mut self.product);
            z.iter_mut().zip(&self.product).for_each(|(z, p)| *z -= p);
        }
        z.iter_mut().zip(&point.z).for_each(|(z, old)| *z -= old);
        if !self.feasible {
            let residual = self.residual.iter();
            s.iter_mut()
                .zip(residual)
                .for_each(|(s, r)| *s += fraction * r);
        }
        Some(Iterate { y, s, z })
    }

    /// Steps for S and for Z: `damping` of the distance to the boundary, at most 1.
    fn step_lengths(&mut self, point: &Iterate, direction: &Iterate, damping: f64) -> (f64, f64) {
        let layout = self.task.layout;
        let [s_work, z_work] = &mut self.steps;
        let (factors, threads) = (&self.factors, self.threads);
        let step = |w: &[f64], root: &[f64], direction: &[f64], work: &mut StepWork| {
            let enough = 1.0 / damping;
            (damping * longest_step(layout, w, root, direction, enough, threads, work)).min(1.0)
        };
        let s = step(&point.s, &factors.s_root, &direction.s, s_work);
        let z = step(&point.z, &factors.z_root, &direction.z, z_work);
        (s, z)
    }
}
