//! Random closed loops at one instant, with the exact derivative of their functional, and (18) with
//! single blocks replaced.
#![allow(dead_code)]

use nalgebra::{DMatrix, DVector};
use synth::conditions::xu2020::{decrease, SamplingEnd, Sector, DEAD_ZONE_UNIT};
use synth::conditions::Task;

use crate::closed_loop::{quadratic, schur_complement, Instant, Quantities};
use crate::exact::Stream;
use crate::random::{self, uniform, vector, Point, Sizes};

/// The rows of (18), in order.
pub const STATE: usize = 0;
pub const RATE: usize = 1;
pub const SAMPLE: usize = 2;
pub const ERROR: usize = 3;
pub const DEAD_ZONE: usize = 4;

/// (18) for r = 1 and r = 2, both on the rows x, x', x(t_k^l), e, dead zone, tau.
#[derive(Clone)]
pub struct Decrease {
    pub start: DMatrix<f64>,
    pub end: DMatrix<f64>,
    pub states: usize,
    pub inputs: usize,
}

impl Decrease {
    /// As the crate states it.
    pub fn corrected(task: &Task, vertex: &DMatrix<f64>, point: &Point) -> Self {
        let at = |interval| decrease(task, vertex, interval, &point.design).value(&point.values);
        Decrease {
            start: at(SamplingEnd::Start),
            end: schur_complement(&at(SamplingEnd::End), task.system.states()),
            states: task.system.states(),
            inputs: task.system.inputs(),
        }
    }

    pub fn range(&self, row: usize) -> (usize, usize) {
        let n = self.states;
        (row * n, if row == DEAD_ZONE { self.inputs } else { n })
    }

    /// The same with one block above the diagonal replaced, and its mirror image.
    pub fn with_block(&self, row: usize, column: usize, block: &DMatrix<f64>) -> Self {
        let ((r, height), (c, width)) = (self.range(row), self.range(column));
        let mut out = self.clone();
        for matrix in [&mut out.start, &mut out.end] {
            matrix.view_mut((r, c), (height, width)).copy_from(block);
            matrix
                .view_mut((c, r), (width, height))
                .copy_from(&block.transpose());
        }
        out
    }

    pub fn block(&self, row: usize, column: usize) -> DMatrix<f64> {
        self.start
            .view(
                (self.range(row).0, self.range(column).0),
                (self.range(row).1, self.range(column).1),
            )
            .into_owned()
    }

    /// Xi_12 as printed: no U, but -L1 + L2'.
    pub fn with_printed_rate_block(
        &self,
        task: &Task,
        vertex: &DMatrix<f64>,
        point: &Point,
    ) -> Self {
        let [e1, e2, _] = task.specification.multiplier_weights;
        let qh = point.design.multiplier.value(&point.values);
        let l1h = point.design.free_state.value(&point.values);
        let l2h = point.design.free_sample.value(&point.values);
        let printed = -e1 * qh.transpose() + e2 * qh * vertex.transpose() - l1h + l2h.transpose();
        self.with_block(STATE, RATE, &printed)
    }

    /// Without Xi_45, as printed: the sector bound taken with N x(t_k^l).
    pub fn with_printed_sector(&self) -> Self {
        self.with_block(ERROR, DEAD_ZONE, &DMatrix::zeros(self.states, self.inputs))
    }

    /// The bound (28) a given part of the way from r = 1 to r = 2.
    pub fn bound(&self, rows: &DVector<f64>, fraction: f64) -> f64 {
        (1.0 - fraction) * quadratic(&self.start, rows) + fraction * quadratic(&self.end, rows)
    }
}

/// One random closed loop: plant, memberships frozen at one instant, unknowns, limits.
pub struct Case {
    pub task: Task,
    pub plant: DMatrix<f64>,
    pub point: Point,
    pub of: Quantities,
}

impl Case {
    pub fn random(stream: &mut Stream) -> Self {
        let sizes = Sizes::any(stream);
        let task = random::model(stream, sizes, false).task();
        let mut weights = vector(stream, sizes.vertices, 1.0).map(f64::abs);
        weights /= weights.sum();
        let (n, m) = (sizes.states, sizes.inputs);
        let vertices = task.system.vertices.iter().zip(weights.iter());
        let plant = vertices.fold(DMatrix::zeros(n, n), |sum, (a, weight)| sum + a * *weight);
        let mut point = Point::random(stream, &task, Sector::Unknown);
        // N near F leaves room for saturation inside |(F - N) x| <= ubar.
        let gain = point.design.gain.value(&point.values);
        let near = 0.7 * &gain + uniform(stream, m, n, 0.1);
        point.set("Nh", &(DEAD_ZONE_UNIT * near));
        let of = Quantities::of(&point.design, &point.values);
        Case {
            task,
            plant,
            point,
            of,
        }
    }

    pub fn decrease(&self) -> Decrease {
        Decrease::corrected(&self.task, &self.plant, &self.point)
    }

    /// An instant of the closed loop: the trigger has just been checked, the held state lies in the
    /// set where the sector bound holds, x' solves the plant's equation. `None` when the drawn
    /// state is outside that set.
    pub fn instant(&self, stream: &mut Stream, state_offset: f64) -> Option<Instant> {
        let n = self.task.system.states();
        let specs = &self.task.specification;
        let limit = &self.task.system.input_limit;
        let held = vector(stream, n, 8.0);
        let direction = vector(stream, n, 1.0);
        let share = specs.trigger_threshold * 0.5 * (1.0 + stream.signed_unit());
        let weight = &self.of.trigger_weight;
        let length = share * quadratic(weight, &held) / quadratic(weight, &direction);
        let error = direction * length.sqrt();
        let command = &self.of.gain * &held;
        let inside = (&self.of.gain - &self.of.anti_windup) * &held;
        if inside
            .iter()
            .zip(limit.iter())
            .any(|(value, limit)| value.abs() > *limit)
        {
            return None;
        }
        let dead_zone = command.zip_map(limit, |u, limit| u - u.clamp(-limit, limit));
        let sample = &held + &error;
        let state = &sample + vector(stream, n, state_offset);
        let disturbance = vector(stream, self.task.system.disturbance.ncols(), 1.0);
        let rate = &self.plant * &state
            + &self.task.system.input * (command - &dead_zone)
            + &self.task.system.disturbance * &disturbance;
        Some(Instant {
            state,
            rate,
            sample,
            error,
            dead_zone,
            disturbance,
        })
    }

    /// V' + phi V - xi |tau|^2 from (21), `elapsed` after a sample in an interval of length
    /// `interval`, along the path x(alpha) since the sample that the instant's x(t_k^l), x and x' and
    /// a given first rate determine.
    pub fn derivative(
        &self,
        at: &Instant,
        first_rate: &DVector<f64>,
        elapsed: f64,
        interval: f64,
    ) -> f64 {
        let of = &self.of;
        let phi = self.task.specification.decay_rate;
        let integral = weighted_energy(&of.integral_weight, at, first_rate, elapsed, phi);
        2.0 * at.state.dot(&(&of.lyapunov * &at.rate))
            + phi * quadratic(&of.lyapunov, &at.state)
            + (interval - elapsed) * quadratic(&of.integral_weight, &at.rate)
            - integral
            - of.disturbance_weight * at.disturbance.norm_squared()
    }
}

/// The integral of e^(-phi (t - alpha)) x'(alpha)' Y x'(alpha) over the path, a cubic, by Simpson's
/// rule.
fn weighted_energy(
    weight: &DMatrix<f64>,
    at: &Instant,
    first_rate: &DVector<f64>,
    elapsed: f64,
    phi: f64,
) -> f64 {
    if elapsed == 0.0 {
        return 0.0;
    }
    let mean = (&at.state - &at.sample) / elapsed;
    let integrand = |s: f64| {
        // Derivative of the Hermite cubic at the fraction s of the path.
        let rate = &mean * (6.0 * s * (1.0 - s))
            + first_rate * ((1.0 - s) * (1.0 - 3.0 * s))
            + &at.rate * (s * (3.0 * s - 2.0));
        (-phi * elapsed * (1.0 - s)).exp() * quadratic(weight, &rate)
    };
    let steps = 64;
    let node = |index: usize| index as f64 / steps as f64;
    let sum: f64 = (0..=steps)
        .map(|index| {
            let factor = match index {
                0 => 1.0,
                last if last == steps => 1.0,
                odd if odd % 2 == 1 => 4.0,
                _ => 2.0,
            };
            factor * integrand(node(index))
        })
        .sum();
    sum * elapsed / (3.0 * steps as f64)
}
