//! From the large set to the small one, at a sample: there V = x'Ux for both certificates, because the integral terms vanish.
//! Where messages may be late or lost they never do, but that of the small set is below that of the large one over rho' where
//! Y_large - rho' Y_small > 0 and the small set's functional decays faster.
//!
//! The large set's bound takes V to every level rho' above r / phi. From then on the small set's certificate holds, where
//! `E(U_large, rho')` lies in `E(U_small, 1)` and the state that is held then, sent earlier and perhaps from outside of the
//! small set, asks for a command that the small set's certificate allows: |(F - N)_s w| <= ubar_s.
//!
//! Whatever w is held after the decision at that sample, `(x - w)' Wp (x - w) <= nu w'W w + c`, with c the trigger's floor and
//! what a measurement error adds; Wp = W where the measurement is perfect. For a, b > 0 with
//!
//! ```text
//! [ a U_large + b Wp, -b Wp, 0 ; *, b (Wp - nu W), (F - N)_s' ; *, *, 1 ] > 0    and    ubar_s^2 > a rho' + b c
//! ```
//!
//! |(F - N)_s w|^2 < a x'U_large x + b ((x - w)' Wp (x - w) - nu w'W w) <= a rho' + b c < ubar_s^2.

use super::{gain_suffix, Assembly};
use crate::certify::certificate::{Certificate, HandOver, HeldWeights};
use crate::model::Model;
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// Every condition of the hand-over from the large set to the small one; `emit` gets each with its name.
pub fn for_each_hand_over_condition<S: Scalar>(
    (large_model, large): (&Model, &Certificate),
    (small_model, small): (&Model, &Certificate),
    hand_over: &HandOver,
    emit: &mut dyn FnMut(String, Matrix<S>),
) {
    let mut emit = |name: &str, matrix| emit(format!("hand-over {name}"), matrix);
    let networked = small_model.file.imperfections.is_networked();
    let integrals = [large, small].map(|own| Matrix::<S>::exactly(&own.integral_weight));
    let large = Assembly::<S>::new(large_model, large);
    let small = Assembly::<S>::new(small_model, small);
    let level = S::from_f64(hand_over.level);
    if networked {
        // The integral term of the small set's functional is below that of the large set's.
        emit(
            "decay faster",
            single(small.phi.clone() - large.phi.clone()),
        );
        let contained = integrals[0].minus(&integrals[1].scaled(&level));
        emit("integral contained", contained);
    }
    emit(
        "level reached",
        single(level.clone() - large.supply.from_rest.clone()),
    );
    let contained = large.lyapunov.minus(&small.lyapunov.scaled(&level));
    emit("set contained", contained);
    small.held_state_allowed(&large.lyapunov, &level, &hand_over.held, &mut emit);
}

impl<S: Scalar> Assembly<'_, S> {
    /// |(F - N)_s w| < ubar_s for whatever may be held where x'Ux <= level for the `large` set's U. No weights for a row:
    /// not proved.
    fn held_state_allowed(
        &self,
        large: &Matrix<S>,
        level: &S,
        weights: &[HeldWeights],
        emit: &mut impl FnMut(&str, Matrix<S>),
    ) {
        let trigger = self.trigger_weight();
        let error = match &self.certificate.measurement {
            Some(measurement) => Matrix::exactly(&measurement.error_weight),
            None => trigger.clone(),
        };
        let held = error.minus(&trigger.scaled(&self.nu));
        let mut weights = weights.iter();
        for (rule, (gain, anti_windup)) in self.gains.iter().enumerate() {
            let difference = gain.minus(anti_windup);
            for (input, limit) in self.plant.input_limit.iter().enumerate() {
                let name = format!("held state input {}", input + 1);
                let name = name + &gain_suffix(self.gains.len(), rule);
                let Some(own) = weights.next() else {
                    emit(&name, single(-S::one()));
                    continue;
                };
                let [a, b] = [own.state, own.trigger].map(S::from_f64);
                let row = difference.row(input).transposed();
                let coupled = error.scaled(&b).negated();
                let state = large.scaled(&a).plus(&error.scaled(&b));
                let nothing = Matrix::from_fn(row.nrows(), 1, |_, _| S::zero());
                let block = Matrix::symmetric(&[
                    &[&state, &coupled, &nothing],
                    &[&held.scaled(&b), &row],
                    &[&single(S::one())],
                ]);
                emit(&name, block);
                emit(&format!("{name} state weight positive"), single(a.clone()));
                emit(
                    &format!("{name} trigger weight positive"),
                    single(b.clone()),
                );
                let used = a * level.clone() + b * self.supply.decision.clone();
                let room = limit.clone() * limit.clone() - used;
                emit(&format!("{name} within limit"), single(room));
            }
        }
    }
}

fn single<S: Scalar>(value: S) -> Matrix<S> {
    Matrix::identity(1, value)
}
