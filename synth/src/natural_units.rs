//! Units in which every spacecraft looks alike: a time of half a turn at full torque, the largest moment, and the torque
//! that goes with them. All are powers of two, so that a design is restated in SI units without rounding.
//!
//! With x = D x~, D = diag(1/Ts I, I), t = Ts t~, J = m J~ and torques E = m / Ts^2:
//! U = D^-1 U~ D^-1, Y likewise; Upsilon, L1, L2 and Wp the same over Ts; Q = D^-1 Q~ diag(Ts/m I, I) in descriptor form; F = E
//! F~ D^-1, N likewise; M and T over E^2 Ts; xi over Ts E^2; phi over Ts; eps_2 times Ts.

use crate::conditions::units::power_of_two;
use crate::design::{CertificateFile, DesignFile, FirstTorqueFile, SearchRecord};
use crate::model::{
    ExactPlant, Imperfections, MeasurementBounds, ModelFile, MomentumBound, PlantFile,
    ReferenceMotion, Specs, TriggerFloor,
};

type Rows = Vec<Vec<f64>>;

/// Units of time and inertia; powers of two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NaturalUnits {
    /// Ts (s).
    pub time: f64,
    /// m [kg m^2].
    pub inertia: f64,
}

/// Time of a turn by an angle (rad) at full torque about the weakest axis (s), for an inertia [kg m^2] and the torque limit of
/// each axis [N m].
pub fn turn_time(inertia: &[[f64; 3]; 3], torque_limit: &[f64; 3], angle: f64) -> f64 {
    let ratios = (0..3).map(|axis| inertia[axis][axis] / torque_limit[axis]);
    (angle * ratios.fold(0.0, f64::max)).sqrt()
}

/// Rows 1 to 3 of a state belong to rates, the others to the attitude.
fn is_rate(index: usize) -> bool {
    index < 3
}

impl NaturalUnits {
    /// The powers of two nearest to a time (s) and a moment of inertia [kg m^2].
    pub fn near(time: f64, inertia: f64) -> Self {
        NaturalUnits {
            time: power_of_two(time),
            inertia: power_of_two(inertia),
        }
    }

    /// Those of a spacecraft with this inertia [kg m^2] that takes so long for a turn (s): half of the time, and the largest
    /// moment.
    pub fn of_turn(time: f64, inertia: &[[f64; 3]; 3]) -> Self {
        let moments = (0..3).map(|axis| inertia[axis][axis]);
        NaturalUnits::near(0.5 * time, moments.fold(0.0, f64::max))
    }

    /// E [N m].
    pub fn torque(self) -> f64 {
        self.inertia / (self.time * self.time)
    }

    /// The factor of a weight of squared torques in the functional's derivative: 1 / (Ts E^2).
    fn supply(self) -> f64 {
        1.0 / (self.time * self.torque() * self.torque())
    }

    /// The units in which numbers in these are SI numbers.
    fn inverse(self) -> Self {
        NaturalUnits {
            time: 1.0 / self.time,
            inertia: 1.0 / self.inertia,
        }
    }

    /// A model in SI units, restated in these.
    pub fn from_si(self, model: &ModelFile) -> ModelFile {
        self.inverse().to_si(model)
    }

    /// A model in these units, restated in SI units.
    pub fn to_si(self, model: &ModelFile) -> ModelFile {
        let mut out = model.clone();
        if let PlantFile::Exact(exact) = &mut out.plant {
            self.spacecraft(exact);
        }
        self.specs(&mut out.specs);
        self.imperfections(&mut out.imperfections);
        out
    }

    /// The same for a spacecraft and its box.
    fn spacecraft(self, exact: &mut ExactPlant) {
        scale(&mut exact.inertia_kg_m2, |_, _| self.inertia);
        if let Some(set) = &mut exact.inertia_uncertainty {
            set.off_diagonal_kg_m2 *= self.inertia;
        }
        if let Some(form) = &mut exact.gyroscopic_form_kg_m2 {
            scale(form, |_, _| self.inertia);
        }
        let torque = self.torque();
        exact.torque_limit_nm = exact.torque_limit_nm.map(|limit| limit * torque);
        exact.disturbance_bound_nm *= torque;
        exact.rate_rad_s = exact.rate_rad_s.map(|rate| rate / self.time);
        if let Some(weights) = &mut exact.output_weights {
            weights.rate_s *= self.time;
        }
    }

    /// The same for requirements and design parameters.
    fn specs(self, specs: &mut Specs) {
        let time = self.time;
        specs.phi_per_s /= time;
        specs.hbar_s *= time;
        specs.hmin_s = specs.hmin_s.map(|shortest| shortest * time);
        specs.eps[1] *= time;
        specs.xi_max *= self.supply();
        if let Some(TriggerFloor::Given(floor)) = &mut specs.trigger_floor {
            *floor /= time;
        }
        self.states(&mut specs.must_contain);
        if let Some(outer) = &mut specs.outer {
            outer.phi_per_s /= time;
            outer.rate_rad_s = outer.rate_rad_s.map(|rate| rate / time);
            outer.xi_max *= self.supply();
            self.states(&mut outer.must_contain);
        }
        if let Some(search) = &mut specs.search {
            if let Some(gain) = &mut search.guaranteed_gain_max {
                *gain /= self.torque();
            }
            let scale = |range: &mut Option<[f64; 2]>, factor: f64| {
                *range = range.map(|ends| ends.map(|end| end * factor));
            };
            scale(&mut search.phi_per_s, 1.0 / time);
            scale(&mut search.rate_rad_s, 1.0 / time);
            scale(&mut search.xi_max, self.supply());
        }
    }

    /// The same for states, one each row.
    fn states(self, states: &mut Rows) {
        scale(states, |_, state| 1.0 / self.state(state));
    }

    /// The same for bounds on what the loop does otherwise than an ideal one.
    fn imperfections(self, bounds: &mut Imperfections) {
        let time = self.time;
        if let Some(MeasurementBounds {
            rate_rad_s: Some(rate),
            ..
        }) = &mut bounds.measurement
        {
            *rate /= time;
        }
        bounds.delay_s *= time;
        let momentum = self.inertia / time;
        match &mut bounds.wheel_momentum_nms {
            None => {}
            Some(MomentumBound::Norm(norm)) => *norm *= momentum,
            Some(MomentumBound::PerAxis(axes)) => {
                axes.iter_mut().for_each(|axis| *axis *= momentum);
            }
        }
        if let Some(ReferenceMotion {
            rate_rad_s,
            acceleration_rad_s2,
        }) = &mut bounds.reference
        {
            *rate_rad_s /= time;
            *acceleration_rad_s2 /= time * time;
        }
        bounds.torque_quantum_nm *= self.torque();
    }

    /// A design in these units, restated in SI units; gains, angles and bounds that depend on units are as they were and
    /// must be claimed anew.
    pub fn design_to_si(self, design: &DesignFile) -> DesignFile {
        let mut out = design.clone();
        out.model = self.to_si(&design.model);
        for gain in &mut out.controller.gains {
            self.gain(gain);
        }
        self.weight(&mut out.controller.trigger_weight, 1.0 / self.time);
        out.controller.trigger_floor /= self.time;
        self.certificate(&mut out.certificate);
        if let Some(outer) = &mut out.outer {
            self.certificate(&mut outer.certificate);
        }
        if let Some(search) = &mut out.provenance.search {
            self.search(search);
        }
        let units = &mut out.provenance.problem.state_units;
        let runs = out.provenance.solver_runs.iter_mut();
        for units in runs.map(|run| &mut run.state_units).chain([units]) {
            let units = units.iter_mut().enumerate();
            units.for_each(|(state, unit)| *unit /= self.state(state));
        }
        out
    }

    /// The same for what a search varied, and its point Uh^-1 Qh = D^-1 P~ D.
    fn search(self, record: &mut SearchRecord) {
        for varied in &mut record.varied {
            let factor = match varied.field.as_str() {
                "specs.phi_per_s" => 1.0 / self.time,
                "specs.xi_max" => self.supply(),
                field if field.starts_with("plant.exact.rate_rad_s") => 1.0 / self.time,
                _ => 1.0,
            };
            for number in [&mut varied.lowest, &mut varied.highest, &mut varied.value] {
                *number *= factor;
            }
        }
        scale(&mut record.linearisation, |r, c| {
            self.state(r) / self.state(c)
        });
    }

    fn certificate(self, part: &mut CertificateFile) {
        let (time, power) = (self.time, self.supply());
        self.weight(&mut part.lyapunov, 1.0);
        self.weight(&mut part.integral_weight, 1.0);
        self.weight(&mut part.free_state, 1.0 / time);
        self.weight(&mut part.free_sample, 1.0 / time);
        self.multiplier(&mut part.multiplier);
        for gain in &mut part.anti_windup {
            self.gain(gain);
        }
        part.sector_weight.iter_mut().for_each(|m| *m *= power);
        part.gain_error_weight.iter_mut().for_each(|t| *t *= power);
        part.xi *= power;
        if let Some(measurement) = &mut part.measurement {
            self.weight(&mut measurement.error_weight, 1.0 / time);
            let weights = measurement.sample_weight.iter_mut().enumerate();
            weights.for_each(|(state, weight)| *weight *= self.state(state).powi(2) / time);
        }
        if let Some(first) = &mut part.first_torque {
            self.first_torque(first);
        }
    }

    fn first_torque(self, first: &mut FirstTorqueFile) {
        first.growth_per_s /= self.time;
        self.multiplier(&mut first.state);
        // That of the state's derivative: x' = D / Ts dx~/dt~.
        self.multiplier(&mut first.rate);
        scale(&mut first.rate, |_, _| self.time);
        for row in &mut first.disturbance {
            let entries = row.iter_mut().enumerate();
            entries.for_each(|(column, entry)| *entry *= self.equation(column) / self.torque());
        }
    }

    /// The entry of D^-1 of a state.
    fn state(self, index: usize) -> f64 {
        match is_rate(index) {
            true => self.time,
            false => 1.0,
        }
    }

    /// The factor of an equation in descriptor form, times the unit of time.
    fn equation(self, index: usize) -> f64 {
        match is_rate(index) {
            true => self.time / self.inertia,
            false => 1.0,
        }
    }

    /// D^-1 X D^-1 times a factor; n x n.
    fn weight(self, rows: &mut Rows, factor: f64) {
        scale(rows, |r, c| self.state(r) * self.state(c) * factor);
    }

    /// D^-1 Q diag(Ts/m I, I); n x n.
    fn multiplier(self, rows: &mut Rows) {
        scale(rows, |r, c| self.state(r) * self.equation(c));
    }

    /// E F D^-1; m x n.
    fn gain(self, rows: &mut Rows) {
        scale(rows, |_, c| self.torque() * self.state(c));
    }
}

fn scale<Row: AsMut<[f64]>>(rows: &mut [Row], factor: impl Fn(usize, usize) -> f64) {
    for (r, row) in rows.iter_mut().enumerate() {
        for (c, entry) in row.as_mut().iter_mut().enumerate() {
            *entry *= factor(r, c);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;

    #[test]
    fn a_model_restated_and_back_is_the_same_to_the_last_bit() {
        let text = include_str!("../../models/xu2020-both.json");
        let mut file = Model::from_json(text).expect("a model").file;
        file.imperfections.delay_s = 0.02;
        file.imperfections.wheel_momentum_nms = Some(MomentumBound::Norm(5.0));
        let units = NaturalUnits::near(7.3, 350.0);
        assert_eq!(units.time.log2().fract(), 0.0);
        assert_eq!(units.to_si(&units.from_si(&file)), file);
        assert_ne!(units.from_si(&file), file);
    }
}
