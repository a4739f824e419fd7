//! Watches a certificate's claims along a run.
//!
//! For a proved design, Xu and Huang 2020, (30) with (31) gives
//! `x'Ux <= e^(-phi t) V(0) + (1 - e^(-phi t)) r / phi` from every start with x'Ux <= rho0. For an ideal loop
//! r = xi taubar^2 and rho0 = 1; measurement errors and the trigger's floor add to r. Where messages may be late or lost,
//! nothing is applied before the first arrival, at which V <= 1, and the bound begins there.

use nalgebra::{SMatrix, SVector};

/// Relative room for the rounding of the bound and of the quadratic form.
pub const ROUNDING: f64 = 1e-9;

/// Below this, e^(-phi t) does not change the bound any more; numbers too small to be normal make
/// arithmetic slow.
const NEGLIGIBLE_DECAY: f64 = 1e-200;

/// Numbers of a certificate, for `N` states (padded with zeros).
#[derive(Clone, Debug, PartialEq)]
pub struct Claims<const N: usize> {
    /// U.
    pub lyapunov: SMatrix<f64, N, N>,
    /// phi, 1/s.
    pub decay_rate: f64,
    /// r / phi: the level that the bound tends to.
    pub ultimate_level: f64,
    /// rho0: the certified starts are those with x'Ux <= rho0.
    pub start_level: f64,
    /// Whether messages may be late or lost, so that V is known to be at most 1 when the first arrives, and no more.
    pub networked: bool,
    /// Bound on the norm of the disturbance.
    pub disturbance_bound: f64,
    /// Rows h with |h x| <= b.
    pub bounds: Vec<(SVector<f64, N>, f64)>,
    /// Bounds on the magnitude of each component; infinite for none.
    pub component_bounds: SVector<f64, N>,
    /// Bound on the norm of the state's last three of six components (the attitude's vector part), for
    /// a spacecraft.
    pub vector_part_bound: Option<f64>,
    /// C, padded; `None` for the identity.
    pub output: Option<SMatrix<f64, N, N>>,
}

impl<const N: usize> Claims<N> {
    /// x'Ux.
    #[inline(always)]
    pub fn level(&self, state: &SVector<f64, N>) -> f64 {
        let state = &state.data.0[0];
        let mut product = [0.0; N];
        for (column, &weight) in self.lyapunov.data.0.iter().zip(state) {
            for (sum, entry) in product.iter_mut().zip(column) {
                *sum += entry * weight;
            }
        }
        product.iter().zip(state).map(|(a, b)| a * b).sum()
    }

    /// k2: the level of the set that the state never leaves, and on which the conditions hold.
    pub fn invariant_level(&self) -> f64 {
        self.ultimate_level.max(1.0)
    }

    #[inline(always)]
    fn in_region(&self, state: &SVector<f64, N>) -> bool {
        let mut inside = true;
        for (value, bound) in state.iter().zip(&self.component_bounds) {
            inside &= value.abs() <= *bound;
        }
        let vector_part = match self.vector_part_bound {
            Some(bound) if N == 6 => {
                state[3] * state[3] + state[4] * state[4] + state[5] * state[5] <= bound * bound
            }
            _ => true,
        };
        inside
            && vector_part
            && self
                .bounds
                .iter()
                .all(|(row, bound)| row.dot(state).abs() <= *bound)
    }
}

/// What a run did with a certificate's claims.
#[derive(Clone, Debug, PartialEq)]
pub struct LyapunovMonitor<const N: usize> {
    claims: Claims<N>,
    ultimate: f64,
    excess: f64,
    decay: f64,
    waiting: bool,
    last_step_s: f64,
    last_factor: f64,
    /// x'Ux at the start.
    pub start_level: f64,
    /// x'Ux now.
    pub level: f64,
    /// Largest x'Ux over its bound.
    pub largest_ratio: f64,
    /// When that was, s.
    pub largest_ratio_s: f64,
    /// Steps at which the bound was broken.
    pub bound_broken: u64,
    /// First time above k2, s.
    pub left_set_s: Option<f64>,
    /// First time outside of the region of the model, s.
    pub left_region_s: Option<f64>,
    /// Steps at which the state was above k2 or outside of the region.
    pub outside: u64,
    /// Largest |y|^2.
    pub output_squared: f64,
    /// Largest |tau|^2.
    pub disturbance_squared: f64,
}

impl<const N: usize> LyapunovMonitor<N> {
    /// Monitor before the start.
    pub fn new(claims: Claims<N>) -> Self {
        Self {
            ultimate: claims.ultimate_level,
            waiting: claims.networked,
            claims,
            excess: 0.0,
            decay: 1.0,
            last_step_s: 0.0,
            last_factor: 1.0,
            start_level: 0.0,
            level: 0.0,
            largest_ratio: 0.0,
            largest_ratio_s: 0.0,
            bound_broken: 0,
            left_set_s: None,
            left_region_s: None,
            outside: 0,
            output_squared: 0.0,
            disturbance_squared: 0.0,
        }
    }

    /// The claims.
    pub fn claims(&self) -> &Claims<N> {
        &self.claims
    }

    /// The bound on x'Ux now.
    #[inline]
    pub fn bound(&self) -> f64 {
        self.ultimate + self.excess * self.decay
    }

    /// The initial state.
    pub fn start(&mut self, state: &SVector<f64, N>, disturbance_squared: f64) {
        self.level = self.claims.level(state);
        self.start_level = self.level;
        let first = if self.claims.networked {
            1.0
        } else {
            self.level
        };
        self.excess = first - self.ultimate;
        self.check(0.0, state, disturbance_squared);
    }

    /// A command from a sample acts at `time_s` and from then on. At the start V is x'Ux.
    #[inline]
    pub fn in_force(&mut self, time_s: f64) {
        if self.waiting && time_s == 0.0 {
            self.excess = self.level - self.ultimate;
        }
        self.waiting = false;
    }

    /// The state at the end of a step.
    #[inline(always)]
    pub fn step(
        &mut self,
        time_s: f64,
        step_s: f64,
        state: &SVector<f64, N>,
        disturbance_squared: f64,
    ) {
        if step_s != self.last_step_s {
            self.last_step_s = step_s;
            self.last_factor = decay_factor(self.claims.decay_rate * step_s);
        }
        if !self.waiting {
            self.decay *= self.last_factor;
        }
        if self.decay < NEGLIGIBLE_DECAY {
            self.decay = 0.0;
        }
        self.level = self.claims.level(state);
        let bound = self.bound();
        if exceeds(self.level, bound * (1.0 + ROUNDING)) {
            self.bound_broken += 1;
        }
        if self.level > self.largest_ratio * bound {
            self.largest_ratio = self.level / bound;
            self.largest_ratio_s = time_s;
        }
        self.check(time_s, state, disturbance_squared);
    }

    #[inline(always)]
    fn check(&mut self, time_s: f64, state: &SVector<f64, N>, disturbance_squared: f64) {
        let above = exceeds(self.level, self.claims.invariant_level() * (1.0 + ROUNDING));
        let beyond = !self.claims.in_region(state);
        if above || beyond {
            self.outside += 1;
            if above {
                self.left_set_s.get_or_insert(time_s);
            }
            if beyond {
                self.left_region_s.get_or_insert(time_s);
            }
        }
        let output = match &self.claims.output {
            None => state.norm_squared(),
            Some(output) => (output * state).norm_squared(),
        };
        self.output_squared = self.output_squared.max(output);
        self.disturbance_squared = self.disturbance_squared.max(disturbance_squared);
    }
}

/// Above the limit, or not a number.
#[inline(always)]
pub(crate) fn exceeds(value: f64, limit: f64) -> bool {
    value > limit || value.is_nan()
}

/// e^(-x) for x >= 0; for small x by its Taylor polynomial, whose first term left out is below 1e-17.
#[inline]
fn decay_factor(exponent: f64) -> f64 {
    const SMALL: f64 = 0.01;
    if exponent > SMALL {
        return libm::exp(-exponent);
    }
    let x = exponent;
    1.0 - x * (1.0 - x * (E2 - x * (E3 - x * (E4 - x * (E5 - x * E6)))))
}

// Taylor coefficients 1 / k!; multiplying is much faster than dividing.
const E2: f64 = 1.0 / 2.0;
const E3: f64 = 1.0 / 6.0;
const E4: f64 = 1.0 / 24.0;
const E5: f64 = 1.0 / 120.0;
const E6: f64 = 1.0 / 720.0;

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix2, Vector2};

    fn claims() -> Claims<2> {
        Claims {
            lyapunov: Matrix2::new(4.0, 1.0, 1.0, 2.0),
            decay_rate: 0.5,
            ultimate_level: 0.2,
            start_level: 1.0,
            networked: false,
            disturbance_bound: 1.0,
            bounds: vec![(Vector2::new(1.0, 0.0), 0.4)],
            component_bounds: Vector2::repeat(f64::INFINITY),
            vector_part_bound: None,
            output: None,
        }
    }

    #[test]
    fn a_state_on_the_bound_is_allowed_and_one_beyond_it_is_counted() {
        let mut monitor = LyapunovMonitor::new(claims());
        let start = Vector2::new(0.0, 0.7);
        monitor.start(&start, 0.0);
        // 0.98 e^(-t/2) + 0.2 (1 - e^(-t/2)) at t = 1.
        let bound = 0.2 + (0.98 - 0.2) * (-0.5_f64).exp();
        let on = Vector2::new(0.0, (bound / 2.0).sqrt());
        monitor.step(1.0, 1.0, &on, 0.0);
        assert!((monitor.bound() - bound).abs() < 1e-15);
        assert!((monitor.largest_ratio - 1.0).abs() < 1e-14);
        assert_eq!(monitor.bound_broken, 0);
        let mut beyond = monitor.clone();
        beyond.step(1.001, 0.001, &(on * 1.001), 0.0);
        assert_eq!(beyond.bound_broken, 1);
        monitor.step(1.001, 0.001, &Vector2::new(f64::NAN, 0.0), 0.0);
        assert_eq!(monitor.bound_broken, 1);
    }

    #[test]
    fn leaving_the_region_and_the_set_is_noticed_with_its_time() {
        let mut monitor = LyapunovMonitor::new(claims());
        monitor.start(&Vector2::new(0.1, 0.0), 0.0);
        monitor.step(2.0, 2.0, &Vector2::new(0.41, 0.0), 0.25);
        assert_eq!(
            (monitor.left_region_s, monitor.left_set_s),
            (Some(2.0), None)
        );
        monitor.step(3.0, 1.0, &Vector2::new(0.0, 0.8), 0.04);
        assert_eq!(monitor.left_set_s, Some(3.0));
        assert_eq!(monitor.outside, 2);
        assert!((monitor.output_squared - 0.64).abs() < 1e-15);
        assert_eq!(monitor.disturbance_squared, 0.25);
    }

    #[test]
    fn where_messages_may_be_late_the_bound_is_1_until_the_first_has_arrived() {
        let networked = Claims {
            networked: true,
            ..claims()
        };
        let start = Vector2::new(0.0, 0.5);
        let mut late = LyapunovMonitor::new(networked.clone());
        late.start(&start, 0.0);
        late.step(1.0, 1.0, &start, 0.0);
        assert_eq!(late.bound(), 1.0);
        late.in_force(1.0);
        late.step(2.0, 1.0, &start, 0.0);
        assert!((late.bound() - (0.2 + 0.8 * (-0.5_f64).exp())).abs() < 1e-15);
        let mut prompt = LyapunovMonitor::new(networked);
        prompt.start(&start, 0.0);
        prompt.in_force(0.0);
        assert_eq!(prompt.bound(), 0.5);
    }

    #[test]
    fn the_decay_factor_is_exact_to_rounding() {
        for x in [0.0, 1e-6, 5e-3, 0.01, 0.02, 1.0] {
            assert!((decay_factor(x) - (-x).exp()).abs() <= 2e-16);
        }
    }
}
