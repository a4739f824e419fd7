//! The weights' matrices and their sum, over any [`Scalar`].

use nalgebra::DMatrix;

use super::{HeldMoments, Moments, Weights};
use crate::certify::interval::Interval;
use crate::certify::matrix::{Matrix, SymmetricBlocks};
use crate::certify::plant::DescriptorPlant;
use crate::certify::rounding::add_up;
use crate::certify::scalar::Scalar;
use crate::certify::theorem1::Statement;
use crate::model::Model;

/// `sum_k <G_k(y), Z_k>` as a function of the unknowns y: the constant and, where it does not vanish
/// by construction, half the coefficient matrix of Qh.
#[derive(Debug, Clone)]
pub struct Balance<S> {
    /// The part that does not depend on the unknowns.
    pub constant: S,
    /// The sum holds `2 <residual, Qh>` beside the constant; `None` when that vanishes exactly.
    pub residual: Option<Matrix<S>>,
}

impl Matrix<Interval> {
    /// Upper bound of the sum of the magnitudes of all entries.
    pub(super) fn magnitude_sum(&self) -> f64 {
        let entries = (0..self.nrows()).flat_map(|r| (0..self.ncols()).map(move |c| (r, c)));
        entries.fold(0.0, |sum, (r, c)| add_up(sum, self.at(r, c).magnitude()))
    }
}

/// The requirements as numbers.
struct Numbers<S> {
    plant: DescriptorPlant<S>,
    phi: S,
    hbar: S,
    nu: S,
    eps: [S; 3],
    /// Not above hbar e^(phi hbar): (18) with the true factor implies (18) with a smaller one.
    factor: S,
    /// max(1, xi_max taubar^2 / phi).
    level: S,
    xi_max: S,
    rho: S,
}

impl<S: Scalar> Numbers<S> {
    fn new(model: &Model, weights: &Weights) -> Self {
        let specs = &model.file.specs;
        let plant = DescriptorPlant::<S>::explicit(&model.plant);
        let phi = S::from_f64(specs.phi_per_s);
        let hbar = S::from_f64(specs.hbar_s);
        let xi_max = S::from_f64(specs.xi_max);
        let bound = plant.disturbance_bound.clone();
        let reached = xi_max.clone() * bound.clone() * bound / phi.clone();
        // 1 / e^(-a) with the divisor rounded up.
        let growth = S::one() / (-(phi.clone() * hbar.clone())).exp_upper();
        Numbers {
            factor: hbar.clone() * growth,
            nu: S::from_f64(specs.nu),
            eps: specs.eps.map(S::from_f64),
            level: reached.max(S::one()),
            rho: S::from_f64(weights.containment_weight),
            plant,
            phi,
            hbar,
            xi_max,
        }
    }
}

/// All moments of (18) that occur in it, at one end of the interval: `xv` is E[x v'] and so on.
/// k is the sample x(t_k^l), w the held state.
struct End<S> {
    xx: Matrix<S>,
    xv: Matrix<S>,
    vv: Matrix<S>,
    xk: Matrix<S>,
    vk: Matrix<S>,
    kk: Matrix<S>,
    vt: Matrix<S>,
    tt: Matrix<S>,
    held: Option<[Matrix<S>; 3]>,
    /// sum over the vertices of E_i[x v'] A_i.
    driven: Matrix<S>,
}

impl<S: Scalar> End<S> {
    /// `vk` is taken from the moments, or from `determined` where they leave it out.
    fn new(
        numbers: &Numbers<S>,
        moments: &Moments,
        determined: impl FnOnce(&Self) -> Option<Matrix<S>>,
    ) -> Self {
        let n = numbers.plant.states();
        let mut sum = Matrix::zeros(2 * n, 2 * n);
        let mut driven = Matrix::zeros(n, n);
        for weight in &moments.vertices {
            let matrix = Matrix::exactly(&weight.moments);
            sum = sum.plus(&matrix);
            let xv = matrix.block(0, n, n, n);
            driven = driven.plus(&xv.times(&numbers.plant.vertices[weight.vertex]));
        }
        let exactly = |matrix: &DMatrix<f64>| Matrix::<S>::exactly(matrix);
        let mut out = End {
            xx: sum.block(0, 0, n, n),
            xv: sum.block(0, n, n, n),
            vv: sum.block(n, n, n, n),
            xk: exactly(&moments.state_sample),
            vk: Matrix::zeros(n, n),
            kk: exactly(&moments.sample),
            vt: exactly(&moments.multiplied_disturbance),
            tt: exactly(&moments.disturbance),
            held: moments.held.as_ref().map(|held| {
                let HeldMoments {
                    multiplied_held,
                    sample_held,
                    held,
                } = held;
                [multiplied_held, sample_held, held].map(exactly)
            }),
            driven,
        };
        let given = moments.multiplied_sample.as_ref().map(exactly);
        if let Some(vk) = given.or_else(|| determined(&out)) {
            out.vk = vk;
        }
        out
    }

    /// E[v w'].
    fn vw(&self) -> &Matrix<S> {
        self.held.as_ref().map_or(&self.vk, |[vw, _, _]| vw)
    }

    /// E[x x''] with eps2 x' = v - eps1 x - eps3 x(t_k^l) (x' is the rate, '' its transpose).
    fn state_rate(&self, eps: &[S; 3]) -> Matrix<S> {
        let [e1, e2, e3] = eps;
        let rest = self.xx.scaled(e1).plus(&self.xk.scaled(e3));
        self.xv.minus(&rest).scaled(&(S::one() / e2.clone()))
    }

    /// E[x' v'] without the part of x(t_k^l).
    fn rate_multiplied_without_sample(&self, eps: &[S; 3]) -> Matrix<S> {
        let [e1, e2, _] = eps;
        let rest = self.vv.minus(&self.xv.scaled(e1));
        rest.scaled(&(S::one() / e2.clone()))
    }

    /// E[x' v'] (x' the rate).
    fn rate_multiplied(&self, eps: &[S; 3]) -> Matrix<S> {
        let [_, e2, e3] = eps;
        let sampled = self.vk.transposed().scaled(&(e3.clone() / e2.clone()));
        self.rate_multiplied_without_sample(eps).minus(&sampled)
    }

    /// E[x' x''] of the rate.
    fn rate_rate(&self, eps: &[S; 3]) -> Matrix<S> {
        let [e1, e2, e3] = eps;
        let square = |a: &S, b: &S| a.clone() * b.clone();
        let sum = self
            .vv
            .minus(&self.xv.symmetrised().scaled(e1))
            .minus(&self.vk.symmetrised().scaled(e3))
            .plus(&self.xx.scaled(&square(e1, e1)))
            .plus(&self.xk.symmetrised().scaled(&square(e1, e3)))
            .plus(&self.kk.scaled(&square(e3, e3)));
        sum.scaled(&(S::one() / square(e2, e2)))
    }

    /// nu E[w w'] - E[e e'] with e = x(t_k^l) - w.
    fn trigger(&self, nu: &S) -> Option<Matrix<S>> {
        let [_, kw, ww] = self.held.as_ref()?;
        let error = self.kk.minus(&kw.symmetrised()).plus(ww);
        Some(ww.scaled(nu).minus(&error))
    }

    fn tell(&self, r: usize, tell: &mut impl FnMut(String, Matrix<S>)) {
        let (n, d) = (self.xx.nrows(), self.tt.nrows());
        let mut root = SymmetricBlocks::new(&[n, n, n]);
        root.set(0, 0, &self.xx);
        root.set(0, 1, &self.xv);
        root.set(0, 2, &self.xk);
        root.set(1, 1, &self.vv);
        root.set(1, 2, &self.vk);
        root.set(2, 2, &self.kk);
        tell(format!("decrease r={r} root"), root.finish());
        let mut disturbance = SymmetricBlocks::new(&[n, d]);
        disturbance.set(0, 0, &self.vv);
        disturbance.set(0, 1, &self.vt);
        disturbance.set(1, 1, &self.tt);
        tell(format!("decrease r={r} disturbance"), disturbance.finish());
        if let Some([vw, kw, ww]) = &self.held {
            let mut held = SymmetricBlocks::new(&[n, n, n]);
            held.set(0, 0, &self.vv);
            held.set(0, 1, &self.vk);
            held.set(0, 2, vw);
            held.set(1, 1, &self.kk);
            held.set(1, 2, kw);
            held.set(2, 2, ww);
            tell(format!("decrease r={r} held state"), held.finish());
        }
    }
}

/// States every matrix that must be positive definite, one after the other, and returns the sum.
///
/// # Panics
/// When a vertex index or a shape does not fit the model; files are checked before.
pub fn for_each_statement<S: Scalar>(
    model: &Model,
    weights: &Weights,
    mut check: impl FnMut(Statement<S>),
) -> Balance<S> {
    let mut tell = |name: String, matrix: Matrix<S>| check(Statement { name, matrix });
    let numbers = Numbers::<S>::new(model, weights);
    for (r, moments) in [(1, &weights.start), (2, &weights.end)] {
        for weight in &moments.vertices {
            let name = format!("decrease r={r} vertex {}", weight.vertex + 1);
            tell(name, Matrix::exactly(&weight.moments));
        }
    }
    let outer = outer_multiplier_share(&numbers, weights);
    let start = End::new(&numbers, &weights.start, |_| None);
    let end = End::new(&numbers, &weights.end, |end| {
        determined_sample(&numbers, &outer, &start, end)
    });
    start.tell(1, &mut tell);
    end.tell(2, &mut tell);
    integral(&numbers, weights, [&start, &end], &mut tell);
    let units = inputs(&numbers, weights, [&start, &end], &mut tell);
    positivity(&numbers, weights, [&start, &end], &mut tell);
    for (index, weight) in weights.must_contain.iter().enumerate() {
        let name = format!("must contain state {}", index + 1);
        tell(name, Matrix::exactly(weight));
    }
    let residual = weights.end.multiplied_sample.as_ref().map(|_| {
        let rates = start
            .rate_multiplied(&numbers.eps)
            .plus(&end.rate_multiplied(&numbers.eps));
        rates.minus(&start.driven).minus(&end.driven).plus(&outer)
    });
    Balance {
        constant: constant(model, &numbers, weights, [&start, &end], units),
        residual,
    }
}

/// The part of the coefficient of Qh that comes from the region and the states to be contained.
fn outer_multiplier_share<S: Scalar>(numbers: &Numbers<S>, weights: &Weights) -> Matrix<S> {
    let n = numbers.plant.states();
    let mut sum = Matrix::zeros(n, n);
    for (bound, weight) in numbers.plant.region.iter().zip(&weights.region) {
        sum = sum.plus(&Matrix::exactly(&weight.cross).times(&bound.rows));
    }
    for weight in &weights.must_contain {
        sum = sum.plus(&Matrix::exactly(weight).scaled(&numbers.rho));
    }
    sum
}

/// E[v x(t_k^l)'] of r = 2 such that the coefficient of Qh vanishes:
/// sum_r (E[x' v'] - sum_i E_i[x v'] A_i) + outer = 0.
fn determined_sample<S: Scalar>(
    numbers: &Numbers<S>,
    outer: &Matrix<S>,
    start: &End<S>,
    end: &End<S>,
) -> Option<Matrix<S>> {
    let [_, e2, e3] = &numbers.eps;
    let known = start
        .rate_multiplied(&numbers.eps)
        .plus(&end.rate_multiplied_without_sample(&numbers.eps))
        .minus(&start.driven)
        .minus(&end.driven)
        .plus(outer);
    let scale = e2.clone() / e3.clone();
    Some(known.scaled(&scale).transposed())
}

/// The clique of the integral's coordinate s. Its cross moments make the coefficients of L1h and
/// L2h vanish: sum_r E[x (x - x_k)'] + k E[x s'] = 0 and the same with x_k in the place of x.
fn integral<S: Scalar>(
    numbers: &Numbers<S>,
    weights: &Weights,
    ends: [&End<S>; 2],
    tell: &mut impl FnMut(String, Matrix<S>),
) {
    let n = numbers.plant.states();
    let inverse = -(S::one() / numbers.factor.clone());
    let [start, end] = ends;
    let state = start.xx.plus(&end.xx).minus(&start.xk).minus(&end.xk);
    let sample = start.xk.plus(&end.xk).transposed();
    let sample = sample.minus(&start.kk).minus(&end.kk);
    let mut out = SymmetricBlocks::new(&[n, n, n]);
    out.set(0, 0, &end.xx);
    out.set(0, 1, &end.xk);
    out.set(0, 2, &state.scaled(&inverse));
    out.set(1, 1, &end.kk);
    out.set(1, 2, &sample.scaled(&inverse));
    out.set(2, 2, &Matrix::exactly(&weights.integral));
    tell("decrease r=2 integral".to_string(), out.finish());
}

/// The weights of (19) and of the region; returns the sum of their unit corners' traces. The cross
/// part of (19) makes the coefficient of Fh vanish: its row s is that of sum_r B' E[v w'].
fn inputs<S: Scalar>(
    numbers: &Numbers<S>,
    weights: &Weights,
    ends: [&End<S>; 2],
    tell: &mut impl FnMut(String, Matrix<S>),
) -> S {
    let n = numbers.plant.states();
    let held = ends[0].vw().plus(ends[1].vw());
    let cross = numbers.plant.input.transposed().times(&held);
    let mut units = S::zero();
    for (input, weight) in weights.inputs.iter().enumerate() {
        let unit = S::from_f64(weight.unit);
        let mut out = SymmetricBlocks::new(&[n, 1]);
        out.set(0, 0, &Matrix::exactly(&weight.state));
        out.set(0, 1, &cross.row(input).transposed());
        out.set(1, 1, &Matrix::identity(1, unit.clone()));
        tell(format!("anti-windup input {}", input + 1), out.finish());
        units = units + unit;
    }
    for (bound, weight) in numbers.plant.region.iter().zip(&weights.region) {
        let unit = Matrix::<S>::exactly(&weight.unit);
        let mut out = SymmetricBlocks::new(&[n, unit.nrows()]);
        out.set(0, 0, &Matrix::exactly(&weight.state));
        out.set(0, 1, &Matrix::exactly(&weight.cross));
        out.set(1, 1, &unit);
        tell(format!("box {}", bound.name), out.finish());
        units = units + unit.trace();
    }
    units
}

/// The weights of Uh > 0, Yh > 0 and Wh > 0, which make the coefficients of Uh, Yh, Wh vanish.
fn positivity<S: Scalar>(
    numbers: &Numbers<S>,
    weights: &Weights,
    ends: [&End<S>; 2],
    tell: &mut impl FnMut(String, Matrix<S>),
) {
    let [start, end] = ends;
    let mut lyapunov = start.xx.plus(&end.xx).scaled(&numbers.phi);
    for end in ends {
        lyapunov = lyapunov.plus(&end.state_rate(&numbers.eps).symmetrised());
    }
    for (limit, weight) in numbers.plant.input_limit.iter().zip(&weights.inputs) {
        let share = limit.clone() * limit.clone() / numbers.level.clone();
        lyapunov = lyapunov.minus(&Matrix::exactly(&weight.state).scaled(&share));
    }
    for (bound, weight) in numbers.plant.region.iter().zip(&weights.region) {
        let share = bound.bound_squared.clone() / numbers.level.clone();
        lyapunov = lyapunov.minus(&Matrix::exactly(&weight.state).scaled(&share));
    }
    let rho_squared = numbers.rho.clone() * numbers.rho.clone();
    for weight in &weights.must_contain {
        lyapunov = lyapunov.plus(&Matrix::exactly(weight).scaled(&rho_squared));
    }
    tell("lyapunov positive".to_string(), lyapunov);
    let rates = start.rate_rate(&numbers.eps).scaled(&numbers.hbar);
    let integral = Matrix::exactly(&weights.integral).scaled(&numbers.factor);
    tell(
        "integral weight positive".to_string(),
        rates.minus(&integral),
    );
    let triggers = ends.map(|end| end.trigger(&numbers.nu));
    // With w = x(t_k^l) at one end its share is nu E[w w'], which is positive semidefinite.
    let sum = match triggers {
        [Some(start), Some(end)] => Some(start.plus(&end)),
        [one, other] => one.or(other),
    };
    if let Some(trigger) = sum {
        tell("trigger weight positive".to_string(), trigger);
    }
}

/// `sum_k <F0_k, Z_k>`. The weight of xi <= xi_max is the sum of the traces of E[tau tau'].
fn constant<S: Scalar>(
    model: &Model,
    numbers: &Numbers<S>,
    weights: &Weights,
    ends: [&End<S>; 2],
    units: S,
) -> S {
    let mut sum = units;
    for end in ends {
        let work = numbers.plant.disturbance.transposed().times(&end.vt);
        sum = sum - (work.trace() + work.trace());
        sum = sum + numbers.xi_max.clone() * end.tt.trace();
    }
    let states = &model.file.specs.must_contain;
    for (state, weight) in states.iter().zip(&weights.must_contain) {
        let state = Matrix::from_fn(state.len(), 1, |r, _| S::from_f64(state[r]));
        let value = state.transposed().times(&Matrix::exactly(weight));
        sum = sum - value.times(&state).at(0, 0).clone();
    }
    sum
}
