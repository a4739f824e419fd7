//! Condition (18): the functional decreases between samples.

use nalgebra::DMatrix;

use super::{gain_suffix, Assembly};
use crate::certify::signals::{Instant, IntegralTerm, ProofSignal, SignalForm};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

use ProofSignal::{DeadZone, Error, GainError, Integral, Rate, Sample, State};

impl<S: Scalar> Assembly<'_, S> {
    /// (18), negated. Rows: x, x', x(t_k^l), e, dead zone, the bounded signals and, for r = 2, the integral.
    ///
    /// It is affine in (zeta(t), zeta(t_k)). Where these are independent, every vertex with every gain
    /// decides. Where |zeta(t_k) - zeta(t)| <= kappa, every rule with its own gain decides once the most
    /// that the difference can add is added ([`Assembly::mismatch`]).
    pub(super) fn decrease(&self, emit: &mut impl FnMut(String, Matrix<S>)) {
        let count = self.gains.len();
        let instants: &[Instant] = match self.imperfections.is_networked() {
            true => &[Instant::Any],
            false => &[Instant::Start, Instant::End],
        };
        for &instant in instants {
            for (rule, gains) in self.gains.iter().enumerate() {
                let common = self.decrease_without_plant(instant, gains);
                let mut index = 0;
                for plant in &self.plants {
                    // 2 v'Q (A x - E x')
                    let mut common = common.clone();
                    self.multiplied(&mut common, Rate, &plant.descriptor.negated());
                    for (own_rule, vertex) in plant.vertices.iter().enumerate() {
                        index += 1;
                        let name = format!("{} vertex {index}", instant.label());
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
    pub(super) fn multiplied(
        &self,
        form: &mut SignalForm<S>,
        signal: ProofSignal,
        coefficient: &Matrix<S>,
    ) {
        for (row, multiplier) in [State, Rate, Sample].into_iter().zip(&self.multipliers) {
            let block = multiplier.times(coefficient);
            match row == signal {
                true => form.add(row, signal, &block.symmetrised()),
                false => form.add(row, signal, &block),
            }
        }
    }

    /// The signals of (18) with their sizes.
    fn rows(&self, instant: Instant) -> Vec<(ProofSignal, usize)> {
        let (n, m) = (self.plant.states(), self.plant.input.ncols());
        let states = [State, Rate, Sample, Error].map(|signal| (signal, n));
        let bounded = self.bounded.iter().enumerate();
        let bounded =
            bounded.map(|(k, signal)| (ProofSignal::Bounded(k), signal.coefficient.ncols()));
        let integral = (instant != Instant::Start).then_some((Integral, n));
        let gain_error = self.gain_error.as_ref().map_or(0, |error| error.rows());
        let zone = [(DeadZone, m), (GainError, gain_error)];
        let out = states.into_iter().chain(zone).chain(bounded);
        out.chain(integral).collect()
    }

    /// (18) without 2 v'Q (A x - E x'), with what the mismatch may add.
    fn decrease_without_plant(
        &self,
        instant: Instant,
        (gain, anti_windup): &(Matrix<S>, Matrix<S>),
    ) -> SignalForm<S> {
        let exactly = |matrix: &DMatrix<f64>| Matrix::<S>::exactly(matrix);
        let mut out = SignalForm::zeros(&self.rows(instant));
        // 2 v'Q (B G (F (x(t_k^l) - e) - p) + the bounded signals), G the centre of the actuators' gains
        let input = match &self.gain_error {
            None => &self.plant.input,
            Some(error) => &self.plant.input.times(&error.centre),
        };
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
        out.add_integral(&self.integral(), instant);
        // The trigger: nu w'Ww - e'We with w = x(t_k^l) - e
        let weight = self.trigger_weight();
        let nu_weight = weight.scaled(&self.nu);
        out.add(Sample, Sample, &nu_weight);
        out.add(Sample, Error, &nu_weight.negated());
        let error_weight = match &self.certificate.measurement {
            // (A): with a measurement error the trigger's weight counts for less.
            Some(measurement) => &exactly(&measurement.error_weight),
            None => &weight,
        };
        out.add(Error, Error, &nu_weight.minus(error_weight));
        // The sector condition: 2 p'M (N w - p)
        let sector = exactly(&DMatrix::from_diagonal(&self.certificate.sector_weight));
        let anti_windup = anti_windup.transposed().times(&sector);
        out.add(Sample, DeadZone, &anti_windup);
        out.add(Error, DeadZone, &anti_windup.negated());
        out.add(DeadZone, DeadZone, &sector.plus(&sector).negated());
        self.add_gain_error(&mut out, gain);
        if let Some(added) = self.mismatch_term(instant.index(), &out) {
            out.add_whole(&added);
        }
        out
    }

    fn integral(&self) -> IntegralTerm<S> {
        IntegralTerm {
            weight: Matrix::exactly(&self.certificate.integral_weight),
            free_state: Matrix::exactly(&self.certificate.free_state),
            free_sample: Matrix::exactly(&self.certificate.free_sample),
            oldest: self.oldest.clone(),
            growth: self.growth.clone(),
        }
    }
}
