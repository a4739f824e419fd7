//! Theorem 1 of Xu & Huang (analysis form, corrected), stated for the numbers of a design file.
//!
//! Every condition is a symmetric matrix that must be positive definite. The matrices are assembled
//! over a [`Scalar`], so the check (intervals) and the tests' oracle (exact rationals) read the same
//! statement.

pub use super::certificate::{Certificate, MismatchSlack, RuleGains};

use nalgebra::DMatrix;

use super::plant::DescriptorPlant;
use crate::conditions::xu2020::gain_suffix;
use crate::fuzzy::inertia_bounds;
use crate::model::{Mismatch, Model, Plant};
use verified::matrix::{Matrix, SymmetricBlockMatrix};
use verified::scalar::Scalar;

/// A named symmetric matrix that must be positive definite.
#[derive(Debug, Clone)]
pub struct Statement<S> {
    /// Name of the condition.
    pub name: String,
    /// The matrix.
    pub matrix: Matrix<S>,
}

/// Everything the conditions need, over one scalar type.
struct Assembly<'a, S> {
    certificate: &'a Certificate,
    /// The plant; of an uncertain inertia the nominal one, for all that does not depend on it.
    plant: DescriptorPlant<S>,
    /// The plants at the vertices of the inertia's set: (18) is affine in (J, A), and (J, A) lies in their
    /// convex hull, so it holds for every inertia and every state of the box when it holds at all of them.
    plants: Vec<DescriptorPlant<S>>,
    phi: S,
    hbar: S,
    /// Not below e^(phi hbar).
    growth: S,
    nu: S,
    /// max(1, xi taubar^2 / phi).
    level: S,
    /// Q_k = eps_k Q.
    multipliers: [Matrix<S>; 3],
    lyapunov: Matrix<S>,
    /// F_j and N_j of every gain.
    gains: Vec<(Matrix<S>, Matrix<S>)>,
    /// kappa, where rule j of the plant goes with gain j.
    matched: Option<S>,
    /// kappa is above 0: without slack nothing is proved.
    slack_needed: bool,
}

/// All conditions of Theorem 1 for a model and a certificate, one after the other; `check` is
/// called with each. They are not collected, because there may be thousands.
pub fn for_each_condition<S: Scalar>(
    model: &Model,
    certificate: &Certificate,
    mut check: impl FnMut(Statement<S>),
) {
    let assembly = Assembly::new(model, certificate);
    let mut emit = |name: String, matrix: Matrix<S>| check(Statement { name, matrix });
    inertia_positive(model, &mut emit);
    assembly.positivity(&mut emit);
    assembly.mismatch(&mut emit);
    assembly.decrease(&mut emit);
    assembly.anti_windup(&mut emit);
    assembly.peak_gain(&mut emit);
    assembly.region(&mut emit);
    assembly.must_contain(model, &mut emit);
    weight_limit(model, certificate, &mut emit);
    assembly.certified_attitudes(model, &mut emit);
}

/// xi above the model's xi_max is no design for the model; a condition of its own only where it fails.
fn weight_limit<S: Scalar>(
    model: &Model,
    certificate: &Certificate,
    emit: &mut impl FnMut(String, Matrix<S>),
) {
    let within = certificate.disturbance_weight <= model.file.specs.xi_max;
    if !within {
        let name = "disturbance weight within xi_max".to_string();
        emit(name, Matrix::identity(1, -S::one()));
    }
}

/// Every inertia of the set is positive definite.
fn inertia_positive<S: Scalar>(model: &Model, emit: &mut impl FnMut(String, Matrix<S>)) {
    if let Plant::Spacecraft(craft) = &model.plant {
        for (index, bound) in inertia_bounds(craft).into_iter().enumerate() {
            emit(format!("inertia positive {}", index + 1), bound);
        }
    }
}

impl<'a, S: Scalar> Assembly<'a, S> {
    fn new(model: &Model, certificate: &'a Certificate) -> Self {
        let specs = &model.file.specs;
        let plant = DescriptorPlant::<S>::new(&model.plant);
        let exactly = |matrix: &DMatrix<f64>| Matrix::exactly(matrix);
        let phi = S::from_f64(specs.phi_per_s);
        let hbar = S::from_f64(specs.hbar_s);
        let xi = S::from_f64(certificate.disturbance_weight);
        let bound = plant.disturbance_bound.clone();
        let reached = xi * bound.clone() * bound / phi.clone();
        let multiplier = exactly(&certificate.multiplier);
        Assembly {
            growth: (phi.clone() * hbar.clone()).exp_upper(),
            nu: S::from_f64(specs.nu),
            level: reached.max(S::one()),
            multipliers: specs
                .eps
                .map(|weight| multiplier.scaled(&S::from_f64(weight))),
            lyapunov: exactly(&certificate.lyapunov),
            gains: certificate
                .gains()
                .zip(certificate.anti_windups())
                .map(|(gain, anti_windup)| (exactly(gain), exactly(anti_windup)))
                .collect(),
            slack_needed: certificate.is_matched(model)
                && !matches!(model.file.mismatch, Mismatch::Kappa(kappa) if kappa == 0.0),
            matched: match model.file.mismatch {
                Mismatch::Kappa(kappa) if certificate.is_matched(model) => Some(S::from_f64(kappa)),
                _ => None,
            },
            certificate,
            plants: DescriptorPlant::each_inertia(&model.plant),
            plant,
            phi,
            hbar,
        }
    }

    fn positivity(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let certificate = self.certificate;
        emit("lyapunov positive".into(), self.lyapunov.clone());
        let integral = Matrix::exactly(&certificate.integral_weight);
        emit("integral weight positive".into(), integral);
        let trigger = Matrix::exactly(&certificate.trigger_weight);
        emit("trigger weight positive".into(), trigger);
        if certificate.trigger_multiple != 1.0 {
            let multiple = S::from_f64(certificate.trigger_multiple);
            emit(
                "trigger multiple positive".into(),
                Matrix::identity(1, multiple),
            );
        }
        for (input, &weight) in certificate.sector_weight.iter().enumerate() {
            let name = format!("sector weight input {}", input + 1);
            emit(name, Matrix::identity(1, S::from_f64(weight)));
        }
    }

    /// (18), negated. Rows: x, x', x(t_k^l), e, dead zone, tau and, for r = 2, the integral.
    ///
    /// It is affine in (zeta(t), zeta(t_k)). Where these are independent, every vertex with every gain
    /// decides. Where |zeta(t_k) - zeta(t)| <= kappa, every rule with its own gain decides once the most
    /// that the difference can add is added ([`Assembly::mismatch`]).
    fn decrease(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let count = self.gains.len();
        for interval in [1, 2] {
            let added = self.mismatch_term(interval);
            for (rule, gains) in self.gains.iter().enumerate() {
                let mut common = self.decrease_without_plant(interval, gains);
                if let Some(added) = &added {
                    common = common.plus(added);
                }
                let mut index = 0;
                for plant in &self.plants {
                    let common = self.with_descriptor(&common, plant);
                    for (own_rule, vertex) in plant.vertices.iter().enumerate() {
                        index += 1;
                        let name = format!("decrease r={interval} vertex {index}");
                        let name = match self.matched {
                            Some(_) if rule != own_rule => continue,
                            Some(_) => name,
                            None => name + &gain_suffix(count, rule),
                        };
                        emit(name, self.with_vertex(&common, vertex).negated());
                    }
                }
            }
        }
    }

    /// The slack for one end of the interval, where kappa is above 0 and the slack fits.
    fn slack(&self, interval: usize) -> Option<(&S, &MismatchSlack)> {
        let (kappa, slack) = (
            self.matched.as_ref()?,
            self.certificate.mismatch.get(interval - 1)?,
        );
        let side = self.certificate.mismatch_side();
        let fits = |matrix: &DMatrix<f64>| matrix.shape() == (side, side);
        let complete = slack.bounds.len() == self.gains.len();
        let fitting = slack.bounds.iter().all(fits) && fits(&slack.common);
        (complete && fitting).then_some((kappa, slack))
    }

    /// P_j > N_j - R and P_j > R - N_j with N_j the form of gain j. As sum_j delta_j = 0 for delta =
    /// zeta(t_k) - zeta(t), the gains add sum_j delta_j (N_j - R) <= kappa sum_j P_j.
    fn mismatch(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        for interval in [1, 2] {
            let Some((_, slack)) = self.slack(interval) else {
                if self.slack_needed {
                    let name = format!("mismatch r={interval} slack present");
                    emit(name, Matrix::identity(1, -S::one()));
                }
                continue;
            };
            let common = Matrix::exactly(&slack.common);
            for (rule, (gains, bound)) in self.gains.iter().zip(&slack.bounds).enumerate() {
                let difference = self.gain_form(gains).minus(&common);
                let bound = Matrix::exactly(bound);
                let name = |side| format!("mismatch r={interval} gain {} {side}", rule + 1);
                emit(name("above"), bound.minus(&difference));
                emit(name("below"), bound.plus(&difference));
            }
        }
    }

    /// The form 2 (B'Q'v)' F_j x(t_k) + 2 (M p)' N_j x(t_k) as a matrix on the rows of
    /// [`MismatchSlack`].
    fn gain_form(&self, (gain, anti_windup): &(Matrix<S>, Matrix<S>)) -> Matrix<S> {
        let (m, n) = (gain.nrows(), gain.ncols());
        let zone = self.certificate.mismatch_side() - m - n;
        let mut out = SymmetricBlockMatrix::new(&[m, zone, n]);
        out.set(0, 2, gain);
        if zone > 0 {
            out.set(1, 2, anti_windup);
        }
        out.finish()
    }

    /// kappa sum_j P_j on the rows of (18).
    fn mismatch_term(&self, interval: usize) -> Option<Matrix<S>> {
        let (kappa, slack) = self.slack(interval)?;
        let plant = &self.plant;
        let (n, m, d) = (
            plant.states(),
            plant.input.ncols(),
            plant.disturbance.ncols(),
        );
        let side = self.certificate.mismatch_side();
        let zone = side - m - n;
        let total = 4 * n + m + d + if interval == 2 { n } else { 0 };
        let mut seen = Matrix::zeros(side, total);
        for (block, multiplier) in self.multipliers.iter().enumerate() {
            let command = plant.input.transposed().times(&multiplier.transposed());
            for r in 0..m {
                for c in 0..n {
                    seen.set(r, block * n + c, command.at(r, c).clone());
                }
            }
        }
        for k in 0..zone {
            let weight = S::from_f64(self.certificate.sector_weight[k]);
            seen.set(m + k, 4 * n + k, weight);
        }
        for k in 0..n {
            seen.set(m + zone + k, 2 * n + k, S::one());
            seen.set(m + zone + k, 3 * n + k, -S::one());
        }
        let bounds = slack.bounds.iter();
        let sum = bounds.fold(Matrix::zeros(side, side), |sum, bound| {
            sum.plus(&Matrix::exactly(bound))
        });
        Some(seen.transposed().times(&sum.scaled(kappa)).times(&seen))
    }

    /// The multiple of Upsilon in (18).
    fn trigger_weight(&self) -> Matrix<S> {
        let weight = Matrix::exactly(&self.certificate.trigger_weight);
        match self.certificate.trigger_multiple {
            1.0 => weight,
            multiple => weight.scaled(&S::from_f64(multiple)),
        }
    }

    /// (18) without 2 (x' Q1 + x'' Q2 + x(t_k^l)' Q3) (A x - E x').
    fn decrease_without_plant(
        &self,
        interval: usize,
        (gain, anti_windup): &(Matrix<S>, Matrix<S>),
    ) -> Matrix<S> {
        let [q1, q2, q3] = &self.multipliers;
        let plant = &self.plant;
        let (n, m, d) = (
            plant.states(),
            plant.input.ncols(),
            plant.disturbance.ncols(),
        );
        let exactly = |matrix: &DMatrix<f64>| Matrix::<S>::exactly(matrix);
        let weight = self.trigger_weight();
        let integral = exactly(&self.certificate.integral_weight);
        let l1 = exactly(&self.certificate.free_state);
        let l2 = exactly(&self.certificate.free_sample);
        let sector = exactly(&DMatrix::from_diagonal(&self.certificate.sector_weight));
        let bf = plant.input.times(gain);
        let nm = anti_windup.transposed().times(&sector);
        let nu_weight = weight.scaled(&self.nu);
        let xi = S::from_f64(self.certificate.disturbance_weight);

        let mut sizes = vec![n, n, n, n, m, d];
        if interval == 2 {
            sizes.push(n);
        }
        let mut out = SymmetricBlockMatrix::new(&sizes);
        let decay = self.lyapunov.scaled(&self.phi);
        out.set(0, 0, &decay.plus(&l1.symmetrised()));
        out.set(0, 1, &self.lyapunov);
        out.set(0, 2, &q1.times(&bf).minus(&l1).plus(&l2.transposed()));
        out.set(0, 3, &q1.times(&bf).negated());
        out.set(0, 4, &q1.times(&plant.input).negated());
        out.set(0, 5, &q1.times(&plant.disturbance));
        if interval == 1 {
            out.set(1, 1, &integral.scaled(&self.hbar));
        }
        out.set(1, 2, &q2.times(&bf));
        out.set(1, 3, &q2.times(&bf).negated());
        out.set(1, 4, &q2.times(&plant.input).negated());
        out.set(1, 5, &q2.times(&plant.disturbance));
        let q3bf = q3.times(&bf);
        let path = q3bf.symmetrised().minus(&l2.symmetrised());
        out.set(2, 2, &path.plus(&nu_weight));
        out.set(2, 3, &q3bf.plus(&nu_weight).negated());
        out.set(2, 4, &nm.minus(&q3.times(&plant.input)));
        out.set(2, 5, &q3.times(&plant.disturbance));
        out.set(3, 3, &nu_weight.minus(&weight));
        out.set(3, 4, &nm.negated());
        out.set(4, 4, &sector.plus(&sector).negated());
        out.set(5, 5, &Matrix::identity(d, -xi));
        if interval == 2 {
            // [Xi, k L; k L', -k Y] with k = hbar e^(phi hbar) has the Schur complement
            // Xi + k L Y^-1 L'.
            let factor = self.hbar.clone() * self.growth.clone();
            out.set(0, 6, &l1.scaled(&factor));
            out.set(2, 6, &l2.scaled(&factor));
            out.set(6, 6, &integral.scaled(&factor).negated());
        }
        out.finish()
    }

    /// Adds `2 (x' Q1 + x'' Q2 + x(t_k^l)' Q3) A_i x`.
    fn with_vertex(&self, common: &Matrix<S>, vertex: &Matrix<S>) -> Matrix<S> {
        let n = self.plant.states();
        let [q1a, q2a, q3a] = [0, 1, 2].map(|k| self.multipliers[k].times(vertex));
        let mut out = common.clone();
        // Row block x, columns x' and x(t_k^l): A' Q2', A' Q3'.
        add_mirrored(&mut out, (0, 0), &q1a.symmetrised());
        add_mirrored(&mut out, (0, n), &q2a.transposed());
        add_mirrored(&mut out, (0, 2 * n), &q3a.transposed());
        out
    }

    /// Adds `-2 (x' Q1 + x'' Q2 + x(t_k^l)' Q3) E x'`.
    fn with_descriptor(&self, common: &Matrix<S>, plant: &DescriptorPlant<S>) -> Matrix<S> {
        let n = plant.states();
        let [q1e, q2e, q3e] = [0, 1, 2].map(|k| self.multipliers[k].times(&plant.descriptor));
        let mut out = common.clone();
        add_mirrored(&mut out, (0, n), &q1e.negated());
        add_mirrored(&mut out, (n, n), &q2e.symmetrised().negated());
        add_mirrored(&mut out, (n, 2 * n), &q3e.transposed().negated());
        out
    }

    /// (19) with k2 for every gain and input.
    fn anti_windup(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        for (rule, (gain, anti_windup)) in self.gains.iter().enumerate() {
            let difference = gain.minus(anti_windup);
            for (input, limit) in self.plant.input_limit.iter().enumerate() {
                let factor = limit.clone() * limit.clone() / self.level.clone();
                let mut out = SymmetricBlockMatrix::new(&[self.plant.states(), 1]);
                out.set(0, 0, &self.lyapunov.scaled(&factor));
                out.set(0, 1, &difference.row(input).transposed());
                out.set(1, 1, &Matrix::identity(1, S::one()));
                let name = format!("anti-windup input {}", input + 1);
                emit(name + &gain_suffix(self.gains.len(), rule), out.finish());
            }
        }
    }

    /// (20): C'C <= gamma phi U and gamma > xi; and the claimed guaranteed gain G: C'C <= G^2/xi phi U.
    fn peak_gain(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let xi = S::from_f64(self.certificate.disturbance_weight);
        let gamma = S::from_f64(self.certificate.gain_bound);
        let claim = S::from_f64(self.certificate.guaranteed_gain);
        emit("peak gain".into(), self.gain_block(gamma.clone()));
        let above = Matrix::identity(1, gamma - xi.clone());
        emit("gain bound above disturbance weight".into(), above);
        // Comes last of the two: dividing by xi needs xi > 0, which (18) has shown.
        let implied = claim.clone() * claim / xi;
        emit("guaranteed gain".into(), self.gain_block(implied));
    }

    fn gain_block(&self, bound: S) -> Matrix<S> {
        let output = &self.plant.output;
        let mut out = SymmetricBlockMatrix::new(&[self.plant.states(), output.nrows()]);
        out.set(0, 0, &self.lyapunov.scaled(&self.phi));
        out.set(0, 1, &output.transposed());
        out.set(1, 1, &Matrix::identity(output.nrows(), bound));
        out.finish()
    }

    /// The set x'Ux <= k2 lies in the region of the model.
    fn region(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        for bound in &self.plant.region {
            let factor = bound.bound_squared.clone() / self.level.clone();
            let rows = bound.rows.nrows();
            let mut out = SymmetricBlockMatrix::new(&[self.plant.states(), rows]);
            out.set(0, 0, &self.lyapunov.scaled(&factor));
            out.set(0, 1, &bound.rows.transposed());
            out.set(1, 1, &Matrix::identity(rows, S::one()));
            emit(format!("box {}", bound.name), out.finish());
        }
    }

    /// x0' U x0 < 1 for every state that the model requires.
    fn must_contain(&self, model: &Model, emit: &mut impl FnMut(String, Matrix<S>)) {
        for (index, state) in model.file.specs.must_contain.iter().enumerate() {
            let state = Matrix::from_fn(state.len(), 1, |r, _| S::from_f64(state[r]));
            let value = state.transposed().times(&self.lyapunov).times(&state);
            let room = S::one() - value.at(0, 0).clone();
            emit(
                format!("must contain state {}", index + 1),
                Matrix::identity(1, room),
            );
        }
    }

    /// s^2 U_qq < I: every attitude at rest with |q| <= s is in the set x'Ux <= 1.
    fn certified_attitudes(&self, model: &Model, emit: &mut impl FnMut(String, Matrix<S>)) {
        let radius = match (&model.plant, self.certificate.certified_vector_part) {
            (Plant::Spacecraft(_), Some(radius)) => S::from_f64(radius),
            _ => return,
        };
        let square = radius.clone() * radius;
        let room = Matrix::from_fn(3, 3, |r, c| {
            let unit = if r == c { S::one() } else { S::zero() };
            unit - square.clone() * self.lyapunov.at(r + 3, c + 3).clone()
        });
        emit("certified attitudes".into(), room);
    }
}

/// Adds a block at (row, column), on or above the diagonal, and its transpose at the mirrored place. A
/// block on the diagonal must be symmetric; its part above the diagonal is read.
fn add_mirrored<S: Scalar>(
    matrix: &mut Matrix<S>,
    (row, column): (usize, usize),
    block: &Matrix<S>,
) {
    for r in 0..block.nrows() {
        for c in 0..block.ncols() {
            let place = (row + r, column + c);
            if place.0 <= place.1 {
                let sum = matrix.at(place.0, place.1).clone() + block.at(r, c).clone();
                matrix.set(place.1, place.0, sum.clone());
                matrix.set(place.0, place.1, sum);
            }
        }
    }
}
