//! Theorem 1 of Xu & Huang (analysis form, corrected), stated for the numbers of a design file.
//!
//! Every condition is a symmetric matrix that must be positive definite. The matrices are assembled
//! over a [`Scalar`], so the check (intervals) and the tests' oracle (exact rationals) read the same
//! statement.

pub use super::certificate::{Certificate, MismatchSlack, RuleGains};

use nalgebra::DMatrix;

use super::plant::DescriptorPlant;
use super::signals::{bounded, reached_level, BoundedSignal, ProofSignal, SignalForm};
use crate::fuzzy::inertia_bounds;
use crate::model::{Mismatch, Model, Plant};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

use ProofSignal::{DeadZone, Error, Integral, Rate, Sample, State};

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
    /// The signals of bounded norm.
    bounded: Vec<BoundedSignal<S>>,
    /// k2.
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
    assembly.weight_limit(model, &mut emit);
    assembly.certified_attitudes(model, &mut emit);
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
        let bounded = bounded(model);
        let weight = |signal: &BoundedSignal<S>| S::from_f64((signal.weight)(certificate));
        let multiplier = exactly(&certificate.multiplier);
        Assembly {
            growth: (phi.clone() * hbar.clone()).exp_upper(),
            nu: S::from_f64(specs.nu),
            level: reached_level(&bounded, weight, &phi).max(S::one()),
            bounded,
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

    /// (18), negated. Rows: x, x', x(t_k^l), e, dead zone, the bounded signals and, for r = 2, the integral.
    ///
    /// It is affine in (zeta(t), zeta(t_k)). Where these are independent, every vertex with every gain
    /// decides. Where |zeta(t_k) - zeta(t)| <= kappa, every rule with its own gain decides once the most
    /// that the difference can add is added ([`Assembly::mismatch`]).
    fn decrease(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let count = self.gains.len();
        for interval in [1, 2] {
            for (rule, gains) in self.gains.iter().enumerate() {
                let common = self.decrease_without_plant(interval, gains);
                let mut index = 0;
                for plant in &self.plants {
                    // 2 v'Q (A x - E x')
                    let mut common = common.clone();
                    self.multiplied(&mut common, Rate, &plant.descriptor.negated());
                    for (own_rule, vertex) in plant.vertices.iter().enumerate() {
                        index += 1;
                        let name = format!("decrease r={interval} vertex {index}");
                        let name = match self.matched {
                            Some(_) if rule != own_rule => continue,
                            Some(_) => name,
                            None => name + &gain_suffix(count, rule),
                        };
                        let mut whole = common.clone();
                        self.multiplied(&mut whole, State, vertex);
                        emit(name, whole.negated());
                    }
                }
            }
        }
    }

    /// Adds `2 v'Q coefficient signal` with Q'v = Q1'x + Q2'x' + Q3'x(t_k^l).
    fn multiplied(&self, form: &mut SignalForm<S>, signal: ProofSignal, coefficient: &Matrix<S>) {
        for (row, multiplier) in [State, Rate, Sample].into_iter().zip(&self.multipliers) {
            let block = multiplier.times(coefficient);
            match row == signal {
                true => form.add(row, signal, &block.symmetrised()),
                false => form.add(row, signal, &block),
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
        let zeros = |rows, columns| Matrix::zeros(rows, columns);
        let sector = match zone {
            0 => &zeros(0, n),
            _ => anti_windup,
        };
        Matrix::symmetric(&[
            &[&zeros(m, m), &zeros(m, zone), gain],
            &[&zeros(zone, zone), sector],
            &[&zeros(n, n)],
        ])
    }

    /// kappa sum_j P_j on the rows of (18).
    fn mismatch_term(&self, interval: usize, form: &SignalForm<S>) -> Option<Matrix<S>> {
        let (kappa, slack) = self.slack(interval)?;
        let (n, m) = (self.plant.states(), self.plant.input.ncols());
        let side = self.certificate.mismatch_side();
        let zone = side - m - n;
        let mut seen = Matrix::zeros(side, form.side());
        let mut see = |row: usize, signal: ProofSignal, block: &Matrix<S>| {
            for r in 0..block.nrows() {
                for c in 0..block.ncols() {
                    seen.set(row + r, form.place(signal) + c, block.at(r, c).clone());
                }
            }
        };
        for (signal, multiplier) in [State, Rate, Sample].into_iter().zip(&self.multipliers) {
            let command = self.plant.input.transposed();
            see(0, signal, &command.times(&multiplier.transposed()));
        }
        let sector = DMatrix::from_diagonal(&self.certificate.sector_weight.rows(0, zone));
        see(m, DeadZone, &Matrix::exactly(&sector));
        see(m + zone, Sample, &Matrix::identity(n, S::one()));
        see(m + zone, Error, &Matrix::identity(n, -S::one()));
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

    /// The bounded signals with their weights.
    fn weighted(&self) -> impl Iterator<Item = (&BoundedSignal<S>, f64)> {
        let signals = self.bounded.iter();
        signals.map(|signal| (signal, (signal.weight)(self.certificate)))
    }

    /// The signals of (18) with their sizes.
    fn rows(&self, interval: usize) -> Vec<(ProofSignal, usize)> {
        let (n, m) = (self.plant.states(), self.plant.input.ncols());
        let states = [State, Rate, Sample, Error].map(|signal| (signal, n));
        let bounded = self.bounded.iter().enumerate();
        let bounded =
            bounded.map(|(k, signal)| (ProofSignal::Bounded(k), signal.coefficient.ncols()));
        let integral = (interval == 2).then_some((Integral, n));
        let out = states.into_iter().chain([(DeadZone, m)]).chain(bounded);
        out.chain(integral).collect()
    }

    /// (18) without 2 v'Q (A x - E x'), with what the mismatch may add.
    fn decrease_without_plant(
        &self,
        interval: usize,
        (gain, anti_windup): &(Matrix<S>, Matrix<S>),
    ) -> SignalForm<S> {
        let exactly = |matrix: &DMatrix<f64>| Matrix::<S>::exactly(matrix);
        let input = &self.plant.input;
        let mut out = SignalForm::zeros(&self.rows(interval));
        // 2 v'Q (B F (x(t_k^l) - e) - B p + the bounded signals)
        let feedback = input.times(gain);
        self.multiplied(&mut out, Sample, &feedback);
        self.multiplied(&mut out, Error, &feedback.negated());
        self.multiplied(&mut out, DeadZone, &input.negated());
        for (k, (signal, weight)) in self.weighted().enumerate() {
            let own = ProofSignal::Bounded(k);
            let square = Matrix::identity(signal.coefficient.ncols(), -S::from_f64(weight));
            self.multiplied(&mut out, own, &signal.coefficient);
            out.add(own, own, &square);
        }
        // phi x'Ux + 2 x'Ux'
        out.add(State, State, &self.lyapunov.scaled(&self.phi));
        out.add(State, Rate, &self.lyapunov);
        // 2 (x'L1 + x(t_k^l)'L2) (x - x(t_k^l))
        let l1 = exactly(&self.certificate.free_state);
        let l2 = exactly(&self.certificate.free_sample);
        out.add(State, State, &l1.symmetrised());
        out.add(State, Sample, &l1.negated());
        out.add(Sample, State, &l2);
        out.add(Sample, Sample, &l2.symmetrised().negated());
        // The trigger: nu w'Ww - e'We with w = x(t_k^l) - e
        let weight = self.trigger_weight();
        let nu_weight = weight.scaled(&self.nu);
        out.add(Sample, Sample, &nu_weight);
        out.add(Sample, Error, &nu_weight.negated());
        out.add(Error, Error, &nu_weight.minus(&weight));
        // The sector condition: 2 p'M (N w - p)
        let sector = exactly(&DMatrix::from_diagonal(&self.certificate.sector_weight));
        let anti_windup = anti_windup.transposed().times(&sector);
        out.add(Sample, DeadZone, &anti_windup);
        out.add(Error, DeadZone, &anti_windup.negated());
        out.add(DeadZone, DeadZone, &sector.plus(&sector).negated());
        let integral = exactly(&self.certificate.integral_weight);
        if interval == 1 {
            out.add(Rate, Rate, &integral.scaled(&self.hbar));
        } else {
            // [Xi, k L; k L', -k Y] with k = hbar e^(phi hbar) has the Schur complement
            // Xi + k L Y^-1 L'.
            let factor = self.hbar.clone() * self.growth.clone();
            out.add(State, Integral, &l1.scaled(&factor));
            out.add(Sample, Integral, &l2.scaled(&factor));
            out.add(Integral, Integral, &integral.scaled(&factor).negated());
        }
        if let Some(added) = self.mismatch_term(interval, &out) {
            out.add_whole(&added);
        }
        out
    }

    /// (19) with k2 for every gain and input.
    fn anti_windup(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        for (rule, (gain, anti_windup)) in self.gains.iter().enumerate() {
            let difference = gain.minus(anti_windup);
            for (input, limit) in self.plant.input_limit.iter().enumerate() {
                let factor = limit.clone() * limit.clone() / self.level.clone();
                let bound = self.inside(factor, &difference.row(input), S::one());
                let name = format!("anti-windup input {}", input + 1);
                emit(name + &gain_suffix(self.gains.len(), rule), bound);
            }
        }
    }

    /// (20): C'C <= gamma phi U and gamma above every weight; and the claimed guaranteed gain G: C'C <= G^2/xi phi U
    /// with the largest weight xi.
    fn peak_gain(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let gamma = S::from_f64(self.certificate.gain_bound);
        let claim = S::from_f64(self.certificate.guaranteed_gain);
        emit("peak gain".into(), self.gain_block(gamma.clone()));
        for (signal, weight) in self.weighted() {
            let above = gamma.clone() - S::from_f64(weight);
            let name = format!("gain bound above {} weight", signal.name);
            emit(name, Matrix::identity(1, above));
        }
        // Comes last: dividing by a weight needs it to be positive, which (18) has shown.
        let weights = self.weighted().map(|(_, weight)| weight);
        let largest = S::from_f64(weights.fold(f64::NEG_INFINITY, f64::max));
        let implied = claim.clone() * claim / largest;
        emit("guaranteed gain".into(), self.gain_block(implied));
    }

    /// A weight above the model's xi_max is no design for the model; a condition of its own only where it fails.
    fn weight_limit(&self, model: &Model, emit: &mut impl FnMut(String, Matrix<S>)) {
        for (signal, weight) in self.weighted() {
            let within = weight <= model.file.specs.xi_max;
            if !within {
                let name = format!("{} weight within xi_max", signal.name);
                emit(name, Matrix::identity(1, -S::one()));
            }
        }
    }

    /// `C'C <= bound phi U`.
    fn gain_block(&self, bound: S) -> Matrix<S> {
        self.inside(self.phi.clone(), &self.plant.output, bound)
    }

    /// `[ factor U, rows' ; *, unit I ]`: |rows x|^2 <= factor unit x'Ux.
    fn inside(&self, factor: S, rows: &Matrix<S>, unit: S) -> Matrix<S> {
        let corner = Matrix::identity(rows.nrows(), unit);
        let upper = [&self.lyapunov.scaled(&factor), &rows.transposed()];
        Matrix::symmetric(&[&upper, &[&corner]])
    }

    /// The set x'Ux <= k2 lies in the region of the model.
    fn region(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        for bound in &self.plant.region {
            let factor = bound.bound_squared.clone() / self.level.clone();
            let inside = self.inside(factor, &bound.rows, S::one());
            emit(format!("box {}", bound.name), inside);
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

/// ` gain 3` where there are several gains.
pub(super) fn gain_suffix(count: usize, rule: usize) -> String {
    match count {
        1 => String::new(),
        _ => format!(" gain {}", rule + 1),
    }
}
