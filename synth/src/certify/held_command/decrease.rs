//! V' <= -phi V + xi |tau|^2 + m (1 + 1/c) ga^2 at every vertex and both ends of the sampling interval.

use super::Assembly;
use crate::certify::plant::DescriptorPlant;
use crate::certify::signals::ProofSignal::{
    Bounded, DeadZone, Error, Integral, Rate, Sample, State,
};
use crate::certify::signals::{Instant, IntegralTerm, ProofSignal, SignalForm};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// The disturbance among the signals.
const DISTURBANCE: ProofSignal = Bounded(0);

impl<S: Scalar> Assembly<'_, S> {
    pub(super) fn decrease(&self, emit: &mut dyn FnMut(String, Matrix<S>)) {
        for (body, plant) in self.plants.iter().enumerate() {
            for (vertex, frozen) in plant.vertices.iter().enumerate() {
                let number = body * plant.vertices.len() + vertex + 1;
                // The vertices of a plant run through the same corners of the box for every inertia.
                let annihilator = &self.annihilators[vertex];
                for instant in [Instant::Start, Instant::End] {
                    let form = self.form(plant, frozen, annihilator, instant);
                    let name = format!("{} vertex {number}", instant.label());
                    emit(name, form.negated());
                }
            }
        }
    }

    /// The rows x, x', x(t_k), e, p, tau and, for r = 2, that of the integral.
    fn signals(&self, plant: &DescriptorPlant<S>, instant: Instant) -> Vec<(ProofSignal, usize)> {
        let (n, m) = (plant.states(), plant.input.ncols());
        let zone = self.saturates().then_some((DeadZone, m));
        let integral = (instant == Instant::End).then_some((Integral, n));
        let mut out = vec![(State, n), (Rate, n), (Sample, n), (Error, m)];
        out.extend(zone);
        out.push((DISTURBANCE, plant.disturbance.ncols()));
        out.extend(integral);
        out
    }

    fn form(
        &self,
        plant: &DescriptorPlant<S>,
        frozen: &Matrix<S>,
        annihilator: &Matrix<S>,
        instant: Instant,
    ) -> SignalForm<S> {
        let own = self.certificate;
        let mut out = SignalForm::zeros(&self.signals(plant, instant));
        // phi x'Ux + 2 x'Ux'
        out.add(State, State, &self.lyapunov.scaled(&self.phi));
        out.add(State, Rate, &self.lyapunov);
        self.add_equation(&mut out, plant, frozen);
        // 2 (x'R1 + x''R2) omega^x omega = 0
        let first = Matrix::exactly(&own.annihilator_state).times(annihilator);
        let second = Matrix::exactly(&own.annihilator_rate).times(annihilator);
        out.add(State, State, &first.symmetrised());
        out.add(Rate, State, &second);
        self.add_command(&mut out);
        let disturbance = S::from_f64(own.disturbance_weight);
        let side = plant.disturbance.ncols();
        out.add(
            DISTURBANCE,
            DISTURBANCE,
            &Matrix::identity(side, -disturbance),
        );
        out.add_integral(&self.integral(), instant);
        out
    }

    /// 2 (x'Q1 + x''Q2) (A x + B (F x(t_k) + e - p) + B_w tau - E x').
    fn add_equation(
        &self,
        out: &mut SignalForm<S>,
        plant: &DescriptorPlant<S>,
        frozen: &Matrix<S>,
    ) {
        let own = self.certificate;
        let multipliers = [
            (State, Matrix::exactly(&own.state_multiplier)),
            (Rate, Matrix::exactly(&own.rate_multiplier)),
        ];
        for (row, multiplier) in multipliers {
            let input = multiplier.times(&plant.input);
            let moved = multiplier.times(&plant.descriptor).negated();
            let frozen = multiplier.times(frozen);
            match row {
                State => {
                    out.add(State, State, &frozen.symmetrised());
                    out.add(State, Rate, &moved);
                }
                _ => {
                    out.add(Rate, State, &frozen);
                    out.add(Rate, Rate, &moved.symmetrised());
                }
            }
            out.add(row, Sample, &input.times(&self.gain));
            out.add(row, Error, &input);
            if self.saturates() {
                out.add(row, DeadZone, &input.negated());
            }
            out.add(row, DISTURBANCE, &multiplier.times(&plant.disturbance));
        }
    }

    /// The trigger, m (1 + c) al^2 |F x(t_k)|^2 - m |e|^2, and the dead zone,
    /// -2 p'M (p - (1 - theta) (F x(t_k) + e)).
    fn add_command(&self, out: &mut SignalForm<S>) {
        let own = self.certificate;
        let weight = S::from_f64(own.command_weight);
        let inputs = self.gain.nrows();
        let share = weight.clone() * (S::one() + S::from_f64(own.command_split));
        let share = share * self.relative.clone() * self.relative.clone();
        let square = self.gain.transposed().times(&self.gain);
        out.add(Sample, Sample, &square.scaled(&share));
        out.add(Error, Error, &Matrix::identity(inputs, -weight));
        if !self.saturates() {
            return;
        }
        let sector = Matrix::from_fn(inputs, inputs, |r, c| match r == c {
            true => S::from_f64(own.sector_weight[r]),
            false => S::zero(),
        });
        let beyond = sector.scaled(&(S::one() - self.theta.clone()));
        out.add(Sample, DeadZone, &self.gain.transposed().times(&beyond));
        out.add(Error, DeadZone, &beyond);
        out.add(DeadZone, DeadZone, &sector.plus(&sector).negated());
    }

    fn integral(&self) -> IntegralTerm<S> {
        let own = self.certificate;
        IntegralTerm {
            weight: Matrix::exactly(&own.integral_weight),
            free_state: Matrix::exactly(&own.free_state),
            free_sample: Matrix::exactly(&own.free_sample),
            oldest: self.hbar.clone(),
            growth: self.growth.clone(),
        }
    }
}
