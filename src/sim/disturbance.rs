//! Disturbances in time: a bias, sines, a table, pulses.

use nalgebra::SVector;

/// One frequency of a disturbance: `sine sin(w t) + cosine cos(w t)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic<const D: usize> {
    /// Angular frequency w, rad/s.
    pub frequency_rad_s: f64,
    /// Amplitude of the sine, in units of the disturbance.
    pub sine: SVector<f64, D>,
    /// Amplitude of the cosine, in units of the disturbance.
    pub cosine: SVector<f64, D>,
}

/// A table with straight lines between its rows and constant ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisturbanceTable<const D: usize> {
    /// Times, s, increasing.
    pub times_s: Vec<f64>,
    /// Values at those times.
    pub values: Vec<SVector<f64, D>>,
}

impl<const D: usize> DisturbanceTable<D> {
    fn at(&self, time_s: f64) -> SVector<f64, D> {
        let after = self.times_s.partition_point(|&time| time <= time_s);
        match (after.checked_sub(1), self.values.get(after)) {
            (None, first) => first.copied().unwrap_or_else(SVector::zeros),
            (Some(before), None) => self.values[before],
            (Some(before), Some(next)) => {
                let (t0, t1) = (self.times_s[before], self.times_s[after]);
                let fraction = (time_s - t0) / (t1 - t0);
                self.values[before] * (1.0 - fraction) + next * fraction
            }
        }
    }
}

/// What acts in a window of time only: `constant + wave sin(w t + phase) exp(-decay t)`, with t the
/// time of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pulse<const D: usize> {
    /// Start of the window, s.
    pub from_s: f64,
    /// End of the window, s.
    pub until_s: f64,
    /// Constant part, in units of the disturbance.
    pub constant: SVector<f64, D>,
    /// Amplitude of the wave at time zero, in units of the disturbance.
    pub wave: SVector<f64, D>,
    /// Its angular frequency w, rad/s.
    pub frequency_rad_s: f64,
    /// Its phase, rad.
    pub phase_rad: f64,
    /// Its decay, 1/s.
    pub decay_per_s: f64,
}

impl<const D: usize> Pulse<D> {
    /// The value at `time_s`, when the window is open at `window_s`.
    fn at(&self, time_s: f64, window_s: f64) -> SVector<f64, D> {
        if !(self.from_s..self.until_s).contains(&window_s) {
            return SVector::zeros();
        }
        let turn = libm::sin(self.frequency_rad_s * time_s + self.phase_rad);
        self.constant + self.wave * (turn * libm::exp(-self.decay_per_s * time_s))
    }
}

/// A disturbance of `D` components: the sum of its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Disturbance<const D: usize> {
    /// Constant part.
    pub bias: SVector<f64, D>,
    /// Periodic parts.
    pub harmonics: Vec<Harmonic<D>>,
    /// Tabulated part.
    pub table: Option<DisturbanceTable<D>>,
    /// Parts that act in a window only.
    pub pulses: Vec<Pulse<D>>,
    /// Norm of a part that the closed loop adds at every event, in the direction in which x'Ux of the design grows fastest.
    pub worst: f64,
}

impl<const D: usize> Disturbance<D> {
    /// No disturbance.
    pub fn none() -> Self {
        Self {
            bias: SVector::zeros(),
            harmonics: Vec::new(),
            table: None,
            pulses: Vec::new(),
            worst: 0.0,
        }
    }

    /// The value at `time_s` seconds.
    pub fn at(&self, time_s: f64) -> SVector<f64, D> {
        let mut value = self.bias;
        for harmonic in &self.harmonics {
            let (sine, cosine) = libm::sincos(harmonic.frequency_rad_s * time_s);
            value += harmonic.sine * sine + harmonic.cosine * cosine;
        }
        if let Some(table) = &self.table {
            value += table.at(time_s);
        }
        value + self.pulses_at(time_s, time_s)
    }

    /// The pulses whose window is open at `window_s`, at `time_s`.
    fn pulses_at(&self, time_s: f64, window_s: f64) -> SVector<f64, D> {
        let values = self.pulses.iter().map(|pulse| pulse.at(time_s, window_s));
        values.fold(SVector::zeros(), |sum, value| sum + value)
    }

    /// Times at which the value or its slope jumps.
    pub fn discontinuities_s(&self) -> Vec<f64> {
        let table = self.table.iter().flat_map(|table| table.times_s.clone());
        let pulses = self.pulses.iter();
        table
            .chain(pulses.flat_map(|pulse| [pulse.from_s, pulse.until_s]))
            .collect()
    }
}

/// Steps after which the phases are computed afresh instead of turned on, which keeps the rounding
/// error of turning below 1e-13.
const STEPS_BETWEEN_RESETS: u32 = 256;

/// Largest angle for which the Taylor polynomials of [`small_sincos`] are exact to rounding.
const SMALL_ANGLE: f64 = 0.05;

#[derive(Clone, Copy, Debug)]
struct Phase {
    sine: f64,
    cosine: f64,
    half_step_sine: f64,
    half_step_cosine: f64,
}

/// Evaluates a disturbance at the times a Runge-Kutta step needs, by turning the phase of each sine
/// from one half step to the next.
#[derive(Clone, Debug)]
pub struct DisturbanceCursor<'a, const D: usize> {
    disturbance: &'a Disturbance<D>,
    phases: Vec<Phase>,
    step_s: f64,
    until_reset: u32,
    /// Without the pulses.
    smooth: SVector<f64, D>,
    now: SVector<f64, D>,
}

impl<'a, const D: usize> DisturbanceCursor<'a, D> {
    /// DisturbanceCursor standing at `time_s` seconds.
    pub fn new(disturbance: &'a Disturbance<D>, time_s: f64) -> Self {
        let still = Phase {
            sine: 0.0,
            cosine: 1.0,
            half_step_sine: 0.0,
            half_step_cosine: 1.0,
        };
        let mut cursor = Self {
            disturbance,
            phases: vec![still; disturbance.harmonics.len()],
            step_s: 0.0,
            until_reset: 0,
            smooth: SVector::zeros(),
            now: SVector::zeros(),
        };
        cursor.move_to(time_s);
        cursor
    }

    /// The value where the cursor is.
    #[inline]
    pub fn now(&self) -> &SVector<f64, D> {
        &self.now
    }

    /// Moves to `time_s` without walking.
    pub fn move_to(&mut self, time_s: f64) {
        for (phase, harmonic) in self.phases.iter_mut().zip(&self.disturbance.harmonics) {
            (phase.sine, phase.cosine) = libm::sincos(harmonic.frequency_rad_s * time_s);
        }
        self.until_reset = STEPS_BETWEEN_RESETS;
        self.smooth = self.value(time_s);
        self.now = self.smooth + self.disturbance.pulses_at(time_s, time_s);
    }

    /// Walks `step_s` seconds on from `time_s`, where it stands, and returns the values at the start,
    /// the middle and the end of the step. A pulse acts throughout a step or not at all: as its window
    /// says of the middle.
    #[inline(always)]
    pub fn step(&mut self, time_s: f64, step_s: f64) -> [SVector<f64, D>; 3] {
        let disturbance = self.disturbance;
        let steady = self.phases.is_empty() && disturbance.table.is_none();
        if steady && disturbance.pulses.is_empty() {
            return [self.now; 3];
        }
        if step_s != self.step_s {
            self.set_step(step_s);
        }
        let start = self.smooth;
        self.turn();
        let middle = self.value(time_s + 0.5 * step_s);
        self.until_reset -= 1;
        if self.until_reset == 0 {
            self.move_to(time_s + step_s);
        } else {
            self.turn();
            self.smooth = self.value(time_s + step_s);
        }
        let values = [start, middle, self.smooth];
        if disturbance.pulses.is_empty() {
            self.now = self.smooth;
            return values;
        }
        self.with_pulses(time_s, step_s, values)
    }

    #[inline(never)]
    fn with_pulses(
        &mut self,
        time_s: f64,
        step_s: f64,
        mut values: [SVector<f64, D>; 3],
    ) -> [SVector<f64, D>; 3] {
        let (disturbance, end) = (self.disturbance, time_s + step_s);
        let middle = time_s + 0.5 * step_s;
        for (value, time) in values.iter_mut().zip([time_s, middle, end]) {
            *value += disturbance.pulses_at(time, middle);
        }
        self.now = self.smooth + disturbance.pulses_at(end, end);
        values
    }

    #[inline]
    fn set_step(&mut self, step_s: f64) {
        self.step_s = step_s;
        for (phase, harmonic) in self.phases.iter_mut().zip(&self.disturbance.harmonics) {
            let angle = 0.5 * harmonic.frequency_rad_s * step_s;
            (phase.half_step_sine, phase.half_step_cosine) = small_sincos(angle);
        }
    }

    #[inline(always)]
    fn turn(&mut self) {
        for phase in &mut self.phases {
            let (s, c) = (phase.sine, phase.cosine);
            phase.sine = s * phase.half_step_cosine + c * phase.half_step_sine;
            phase.cosine = c * phase.half_step_cosine - s * phase.half_step_sine;
        }
    }

    #[inline(always)]
    fn value(&self, time_s: f64) -> SVector<f64, D> {
        let mut value = self.disturbance.bias;
        for (phase, harmonic) in self.phases.iter().zip(&self.disturbance.harmonics) {
            value += harmonic.sine * phase.sine + harmonic.cosine * phase.cosine;
        }
        if let Some(table) = &self.disturbance.table {
            value += table.at(time_s);
        }
        value
    }
}

// Taylor coefficients; multiplying is much faster than dividing.
const S3: f64 = -1.0 / 6.0;
const S5: f64 = 1.0 / 120.0;
const S7: f64 = -1.0 / 5040.0;
const S9: f64 = 1.0 / 362_880.0;
const C2: f64 = -1.0 / 2.0;
const C4: f64 = 1.0 / 24.0;
const C6: f64 = -1.0 / 720.0;
const C8: f64 = 1.0 / 40_320.0;
const C10: f64 = -1.0 / 3_628_800.0;

/// Sine and cosine; below [`SMALL_ANGLE`] by Taylor polynomials, whose first term left out is below
/// 1e-17.
#[inline(always)]
fn small_sincos(angle: f64) -> (f64, f64) {
    if angle.abs() > SMALL_ANGLE {
        return libm::sincos(angle);
    }
    let x = angle * angle;
    let sine = 1.0 + x * (S3 + x * (S5 + x * (S7 + x * S9)));
    let cosine = 1.0 + x * (C2 + x * (C4 + x * (C6 + x * (C8 + x * C10))));
    (angle * sine, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    fn wavy() -> Disturbance<2> {
        let harmonic = |frequency_rad_s, a, b| Harmonic {
            frequency_rad_s,
            sine: Vector2::new(a, b),
            cosine: Vector2::new(-b, 2.0 * a),
        };
        Disturbance {
            bias: Vector2::new(0.3, -0.1),
            harmonics: vec![harmonic(0.06, 1.0, 0.5), harmonic(7.0, 0.4, -0.2)],
            ..Disturbance::none()
        }
    }

    #[test]
    fn walking_agrees_with_direct_evaluation_after_a_hundred_thousand_uneven_steps() {
        let disturbance = wavy();
        let mut cursor = DisturbanceCursor::new(&disturbance, 0.0);
        let mut time = 0.0;
        for index in 0..100_000 {
            // Steps whose sums are exact, so that both evaluations are at the same times.
            let step = f64::from(1 + index % 7) / 1024.0;
            let values = cursor.step(time, step);
            for (value, fraction) in values.iter().zip([0.0, 0.5, 1.0]) {
                let exact = disturbance.at(time + fraction * step);
                assert!((value - exact).amax() < 1e-12, "at {time} s");
            }
            time += step;
        }
    }

    #[test]
    fn small_angles_have_exact_sines() {
        for angle in [0.0, 1e-9, -0.01, 0.03, SMALL_ANGLE, -SMALL_ANGLE, 0.2] {
            let (sine, cosine) = small_sincos(angle);
            assert!((sine - angle.sin()).abs() <= 2.0 * f64::EPSILON * angle.abs());
            assert!((cosine - angle.cos()).abs() <= f64::EPSILON);
        }
    }

    #[test]
    fn a_table_has_straight_lines_and_constant_ends() {
        let table = DisturbanceTable {
            times_s: vec![1.0, 3.0],
            values: vec![Vector2::new(0.0, 2.0), Vector2::new(4.0, 0.0)],
        };
        assert_eq!(table.at(0.0), Vector2::new(0.0, 2.0));
        assert_eq!(table.at(1.5), Vector2::new(1.0, 1.5));
        assert_eq!(table.at(9.0), Vector2::new(4.0, 0.0));
        assert_eq!(DisturbanceTable::<2>::default().at(1.0), Vector2::zeros());
    }

    #[test]
    fn a_pulse_acts_in_the_steps_of_its_window() {
        let pulse = Pulse {
            from_s: 1.0,
            until_s: 2.0,
            constant: Vector2::new(0.5, 0.0),
            wave: Vector2::new(0.0, 2.0),
            frequency_rad_s: 3.0,
            phase_rad: 0.4,
            decay_per_s: 0.25,
        };
        let disturbance = Disturbance {
            pulses: vec![pulse],
            ..Disturbance::none()
        };
        let open =
            |time: f64| Vector2::new(0.5, 2.0 * (3.0 * time + 0.4).sin() * (-0.25 * time).exp());
        assert_eq!(disturbance.discontinuities_s(), vec![1.0, 2.0]);
        assert_eq!(disturbance.at(0.99), Vector2::zeros());
        assert!((disturbance.at(1.0) - open(1.0)).amax() < 1e-15);
        assert_eq!(disturbance.at(2.0), Vector2::zeros());
        let mut cursor = DisturbanceCursor::new(&disturbance, 0.0);
        assert_eq!(cursor.step(0.0, 1.0), [Vector2::zeros(); 3]);
        assert!((cursor.now() - open(1.0)).amax() < 1e-15);
        for (value, time) in cursor.step(1.0, 1.0).iter().zip([1.0, 1.5, 2.0]) {
            assert!((value - open(time)).amax() < 1e-15, "at {time} s");
        }
        assert_eq!(*cursor.now(), Vector2::zeros());
    }
}
