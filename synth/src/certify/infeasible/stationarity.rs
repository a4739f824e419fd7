//! The matrices of the dual multipliers and their sum, over any [`Scalar`]: what the stationarity in the unknowns
//! determines is computed, so that the sum does not depend on them.

use nalgebra::DMatrix;

use super::moments::EndMoments;
use super::multipliers::{DualMultipliers, GainDuals, Moments};
use crate::certify::plant::DescriptorPlant;
use crate::certify::signals::{bounded, reached_level};
use crate::certify::theorem1::{gain_suffix, Statement};
use crate::model::Model;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// `sum_k <G_k(y), Z_k>` as a function of the unknowns y: the constant and, where it does not vanish
/// by construction, half the coefficient matrix of Qh.
#[derive(Debug, Clone)]
pub struct Stationarity<S> {
    /// The part that does not depend on the unknowns.
    pub constant: S,
    /// The sum holds `2 <residual, Qh>` beside the constant; `None` when that vanishes exactly.
    pub residual: Option<Matrix<S>>,
}

/// Which level k2 a statement is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// k2 = 1 and xi up to the smaller of xi_max and phi / taubar^2. This covers every design: one with
    /// xi taubar^2 > phi, so k2 > 1, is another with k2 = 1 after the division of U, Y, W, Q, L, M and xi by its
    /// k2, because (18) is homogeneous in them and (19), the region and x0'Ux0 <= 1 hold for U / k2.
    One,
    /// k2 = max(1, xi_max taubar^2 / phi), which belongs to xi_max alone.
    AtLargestWeight,
}

impl Level {
    /// k2 and the largest xi.
    fn with<S: Scalar>(self, model: &Model, phi: &S) -> (S, S) {
        let signals = bounded(model);
        if model.file.specs.xi_max.is_infinite() {
            let of_one = reached_level(&signals, |_| S::one(), phi);
            return (S::one(), S::one() / of_one);
        }
        let xi_max = S::from_f64(model.file.specs.xi_max);
        let reached = reached_level(&signals, |_| xi_max.clone(), phi);
        let level = reached.max(S::one());
        match self {
            // xi_max / k2 is the smaller of xi_max and phi / taubar^2.
            Level::One => (S::one(), xi_max / level),
            Level::AtLargestWeight => (level, xi_max),
        }
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
    /// k2.
    level: S,
    xi_max: S,
    rho: S,
}

impl<S: Scalar> Numbers<S> {
    fn new(model: &Model, weights: &DualMultipliers, level: Level) -> Self {
        let specs = &model.file.specs;
        let plant = DescriptorPlant::<S>::explicit(&model.plant.relaxed());
        let phi = S::from_f64(specs.phi_per_s);
        let hbar = S::from_f64(specs.hbar_s);
        let (level, xi_max) = level.with(model, &phi);
        // 1 / e^(-a) with the divisor rounded up.
        let growth = S::one() / (-(phi.clone() * hbar.clone())).exp_upper();
        Numbers {
            factor: hbar.clone() * growth,
            nu: S::from_f64(specs.nu),
            eps: specs.eps.map(S::from_f64),
            level,
            rho: S::from_f64(weights.containment_weight),
            plant,
            phi,
            hbar,
            xi_max,
        }
    }
}

/// The conditions of one gain.
struct GainMoments<'a, S> {
    weights: &'a GainDuals,
    /// Both ends of the sampling interval.
    ends: [EndMoments<S>; 2],
    /// F_j where it is given.
    gain: Option<Matrix<S>>,
    /// E[x s'] and E[x(t_k^l) s'].
    integral: [Matrix<S>; 2],
    /// Ends the conditions' names.
    suffix: String,
}

/// States every matrix that must be positive definite, one after the other, and returns the sum.
///
/// # Panics
/// When an index or a shape does not fit the model; files are checked before.
pub fn for_each_statement<S: Scalar>(
    model: &Model,
    weights: &DualMultipliers,
    level: Level,
    mut check: impl FnMut(Statement<S>),
) -> Stationarity<S> {
    let mut emit = |name: String, matrix: Matrix<S>| check(Statement { name, matrix });
    let numbers = Numbers::<S>::new(model, weights, level);
    let mut parts = parts(&numbers, weights);
    let determined = first_end(weights).is_some_and(|end| end.multiplied_sample.is_none());
    let residual = multiplier_share(&numbers, weights, &parts);
    if determined {
        determine_sample(&numbers, &residual, &mut parts);
    }
    determine_integral(&numbers, &mut parts);
    for part in &parts {
        part.emit(&numbers, &mut emit);
    }
    positivity(&numbers, weights, &parts, &mut emit);
    for (bound, weight) in numbers.plant.region.iter().zip(&weights.region) {
        let [state, cross, unit] =
            [&weight.state, &weight.cross, &weight.unit].map(Matrix::exactly);
        let matrix = Matrix::symmetric(&[&[&state, &cross], &[&unit]]);
        emit(format!("box {}", bound.name), matrix);
    }
    for (index, weight) in weights.must_contain.iter().enumerate() {
        let name = format!("must contain state {}", index + 1);
        emit(name, Matrix::exactly(weight));
    }
    Stationarity {
        constant: constant(model, &numbers, weights, &parts),
        residual: (!determined).then_some(residual),
    }
}

/// r = 2 of the first gain.
fn first_end(weights: &DualMultipliers) -> Option<&Moments> {
    weights.gains.first().map(|part| &part.end)
}

fn parts<'a, S: Scalar>(
    numbers: &Numbers<S>,
    weights: &'a DualMultipliers,
) -> Vec<GainMoments<'a, S>> {
    let n = numbers.plant.states();
    let part = |part: &'a GainDuals| {
        let ends = [&part.start, &part.end];
        let cross = |of: &Option<DMatrix<f64>>| match of {
            Some(cross) => Matrix::exactly(cross),
            None => Matrix::zeros(n, n),
        };
        GainMoments {
            weights: part,
            ends: ends.map(|moments| EndMoments::new(&numbers.plant.vertices, moments)),
            gain: weights.given.get(part.gain - 1).map(Matrix::exactly),
            integral: [cross(&part.state_integral), cross(&part.sample_integral)],
            suffix: gain_suffix(weights.given.len().max(1), part.gain - 1),
        }
    };
    weights.gains.iter().map(part).collect()
}

fn total<S: Scalar>(
    parts: &[GainMoments<S>],
    zero: Matrix<S>,
    of: impl Fn(&EndMoments<S>) -> Matrix<S>,
) -> Matrix<S> {
    let ends = parts.iter().flat_map(|part| &part.ends);
    ends.fold(zero, |sum, end| sum.plus(&of(end)))
}

/// Half the coefficient of Qh: sum (E[x' v'] - sum_i E_i[x v'] A_i - (E[w v'] B + E[w p']) F_j) + outer, the
/// sum over the gains and both ends. The term of F_j is there for given gains only; a free gain has its own
/// stationarity.
fn multiplier_share<S: Scalar>(
    numbers: &Numbers<S>,
    weights: &DualMultipliers,
    parts: &[GainMoments<S>],
) -> Matrix<S> {
    let outer = outer_multiplier_share(numbers, weights);
    let sum = total(parts, outer, |end| {
        end.rate_multiplied(&numbers.eps).minus(&end.driven)
    });
    parts.iter().fold(sum, |sum, part| match &part.gain {
        Some(gain) => part.ends.iter().fold(sum, |sum, end| {
            sum.minus(&end.command(&numbers.plant.input).times(gain))
        }),
        None => sum,
    })
}

/// E[v x(t_k^l)'] of r = 2 of the first gain such that the coefficient of Qh vanishes, which without it is
/// `known`: its own part there is -eps3/eps2 E[x(t_k^l) v'].
fn determine_sample<S: Scalar>(
    numbers: &Numbers<S>,
    known: &Matrix<S>,
    parts: &mut [GainMoments<S>],
) {
    let [_, e2, e3] = &numbers.eps;
    if let Some(first) = parts.first_mut() {
        let scale = e2.clone() / e3.clone();
        first.ends[1].vk = known.scaled(&scale).transposed();
    }
}

/// The moments of the integral's coordinate s of the first gain, such that the coefficients of L1h and
/// L2h vanish: sum E[x (x - x_k)'] + k sum E_2[x s'] = 0 and the same with x_k in the place of x.
fn determine_integral<S: Scalar>(numbers: &Numbers<S>, parts: &mut [GainMoments<S>]) {
    let n = numbers.plant.states();
    let zero = || Matrix::zeros(n, n);
    let inverse = -(S::one() / numbers.factor.clone());
    let path = [
        total(parts, zero(), |end| end.xx.minus(&end.xk)),
        total(parts, zero(), |end| end.xk.transposed().minus(&end.kk)),
    ];
    for (index, path) in path.iter().enumerate() {
        let others = parts.iter().skip(1);
        let known = others.fold(zero(), |sum, part| sum.plus(&part.integral[index]));
        if let Some(first) = parts.first_mut() {
            first.integral[index] = path.scaled(&inverse).minus(&known);
        }
    }
}

/// The part of the coefficient of Qh that comes from the region and the states to be contained.
fn outer_multiplier_share<S: Scalar>(numbers: &Numbers<S>, weights: &DualMultipliers) -> Matrix<S> {
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

impl<S: Scalar> GainMoments<'_, S> {
    /// Every matrix of this gain.
    fn emit(&self, numbers: &Numbers<S>, emit: &mut impl FnMut(String, Matrix<S>)) {
        let suffix = &self.suffix;
        for (r, moments) in [(1, &self.weights.start), (2, &self.weights.end)] {
            for weight in &moments.vertices {
                let name = format!("decrease r={r} vertex {}{suffix}", weight.vertex);
                emit(name, Matrix::exactly(&weight.moments));
            }
        }
        for (index, end) in self.ends.iter().enumerate() {
            end.emit(&format!("r={}{suffix}", index + 1), emit);
        }
        let (end, [xs, ks]) = (&self.ends[1], &self.integral);
        let ss = Matrix::exactly(&self.weights.integral);
        let integral = Matrix::symmetric(&[&[&end.xx, &end.xk, xs], &[&end.kk, ks], &[&ss]]);
        emit(format!("decrease r=2{suffix} integral"), integral);
        let cross = self.input_cross(numbers);
        for (input, weight) in self.weights.inputs.iter().enumerate() {
            let unit = Matrix::identity(1, S::from_f64(weight.unit));
            let (state, row) = (
                Matrix::exactly(&weight.state),
                cross.row(input).transposed(),
            );
            let matrix = Matrix::symmetric(&[&[&state, &row], &[&unit]]);
            emit(format!("anti-windup input {}{suffix}", input + 1), matrix);
        }
    }

    /// The cross parts of (19), one row for each input. For a free gain they make the coefficient of Fh
    /// vanish: sum_r B' E[v w']. For a given one that of Nh_j: -sum_r E[p w'].
    fn input_cross(&self, numbers: &Numbers<S>) -> Matrix<S> {
        let zero = Matrix::zeros(numbers.plant.input.ncols(), numbers.plant.states());
        let input = numbers.plant.input.transposed();
        self.ends
            .iter()
            .fold(zero, |sum, end| match &end.dead_zone {
                Some([_, wp, _]) => sum.minus(&wp.transposed()),
                None => sum.plus(&input.times(end.vw())),
            })
    }
}

/// The dual multipliers of Uh > 0, Yh > 0, Wh > 0 and, for given gains, S > 0, which make the coefficients of these
/// unknowns vanish.
fn positivity<S: Scalar>(
    numbers: &Numbers<S>,
    weights: &DualMultipliers,
    parts: &[GainMoments<S>],
    emit: &mut impl FnMut(String, Matrix<S>),
) {
    let n = numbers.plant.states();
    let zero = || Matrix::<S>::zeros(n, n);
    let mut lyapunov = total(parts, zero(), |end| {
        let rate = end.state_rate(&numbers.eps).symmetrised();
        end.xx.scaled(&numbers.phi).plus(&rate)
    });
    for part in parts {
        for (limit, weight) in numbers.plant.input_limit.iter().zip(&part.weights.inputs) {
            let share = limit.clone() * limit.clone() / numbers.level.clone();
            lyapunov = lyapunov.minus(&Matrix::exactly(&weight.state).scaled(&share));
        }
    }
    for (bound, weight) in numbers.plant.region.iter().zip(&weights.region) {
        let share = bound.bound_squared.clone() / numbers.level.clone();
        lyapunov = lyapunov.minus(&Matrix::exactly(&weight.state).scaled(&share));
    }
    let rho_squared = numbers.rho.clone() * numbers.rho.clone();
    for weight in &weights.must_contain {
        lyapunov = lyapunov.plus(&Matrix::exactly(weight).scaled(&rho_squared));
    }
    emit("lyapunov positive".to_string(), lyapunov);
    let integral = parts.iter().fold(zero(), |sum, part| {
        let [start, _] = &part.ends;
        let rates = start.rate_rate(&numbers.eps).scaled(&numbers.hbar);
        let integral = Matrix::exactly(&part.weights.integral).scaled(&numbers.factor);
        sum.plus(&rates.minus(&integral))
    });
    emit("integral weight positive".to_string(), integral);
    let ends = parts.iter().flat_map(|part| &part.ends);
    let triggers = ends.filter_map(|end| end.trigger(&numbers.nu));
    // With w = x(t_k^l) at one end its term is nu E[w w'], which is positive semidefinite.
    if let Some(trigger) = triggers.reduce(|sum, trigger| sum.plus(&trigger)) {
        emit("trigger weight positive".to_string(), trigger);
    }
    sector_positivity(numbers, parts, emit);
}

/// -2 sum (B' E[v p'] + E[p p'])_ss for every input s.
fn sector_positivity<S: Scalar>(
    numbers: &Numbers<S>,
    parts: &[GainMoments<S>],
    emit: &mut impl FnMut(String, Matrix<S>),
) {
    let ends = parts.iter().flat_map(|part| &part.ends);
    let zones = ends.filter_map(|end| end.dead_zone.as_ref());
    let input = numbers.plant.input.transposed();
    let sum = zones.map(|[vp, _, pp]| input.times(vp).plus(pp));
    let Some(sum) = sum.reduce(|sum, zone| sum.plus(&zone)) else {
        return;
    };
    for k in 0..sum.nrows() {
        let weight = -(sum.at(k, k).clone() + sum.at(k, k).clone());
        let name = format!("sector weight input {}", k + 1);
        emit(name, Matrix::identity(1, weight));
    }
}

/// `sum_k <F0_k, Z_k>`. The multiplier of xi <= xi_max is the sum of the traces of E[tau tau'].
fn constant<S: Scalar>(
    model: &Model,
    numbers: &Numbers<S>,
    weights: &DualMultipliers,
    parts: &[GainMoments<S>],
) -> S {
    let mut sum = S::zero();
    for part in parts {
        for weight in &part.weights.inputs {
            sum = sum + S::from_f64(weight.unit);
        }
        for end in &part.ends {
            let work = numbers.plant.disturbance.transposed().times(&end.vt);
            sum = sum - (work.trace() + work.trace());
            sum = sum + numbers.xi_max.clone() * end.tt.trace();
        }
    }
    for weight in &weights.region {
        sum = sum + Matrix::<S>::exactly(&weight.unit).trace();
    }
    let states = &model.file.specs.must_contain;
    for (state, weight) in states.iter().zip(&weights.must_contain) {
        let state = Matrix::from_fn(state.len(), 1, |r, _| S::from_f64(state[r]));
        let value = state.transposed().times(&Matrix::exactly(weight));
        sum = sum - value.times(&state).at(0, 0).clone();
    }
    sum
}
