//! H-infinity state feedback of one vertex from a Riccati equation: candidates that only need the check.
//!
//! J. C. Doyle, K. Glover, P. P. Khargonekar, B. A. Francis, "State-space solutions to standard H2 and H-infinity
//! control problems", IEEE Trans. Automatic Control 34 (1989) 831-847. Weights on state and input are added, small
//! ones, so that the inequality holds with room and `D'D` may be singular: what holds with them holds without.

use nalgebra::{DMatrix, DVector};

use super::state_feedback::{Direct, StateFeedback};
use super::units::{Sizes, Units};
use super::vertex_plant::VertexPlant;
use crate::riccati::{abscissa, lyapunov, positive, spectral_radius, stabilising, symmetric};

/// The weights added, in units in which state, input and gamma are about 1; the largest that suffices is taken.
const WEIGHTS: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12];

/// Relative accuracy of the smallest gamma.
const ACCURACY: f64 = 1e-5;

/// Rounds in which the units follow the solution.
const ROUNDS: usize = 2;

/// Decades of gamma that are searched in either direction.
const DECADES: i32 = 18;

/// What drives a plant and what is seen of it: B_w (n x d), C (p x n), D (p x m), D_w (p x d).
pub(super) struct Signals {
    pub(super) disturbance: DMatrix<f64>,
    pub(super) output: DMatrix<f64>,
    pub(super) input_to_output: DMatrix<f64>,
    pub(super) disturbance_to_output: DMatrix<f64>,
}

/// A problem in the units for numbers of given sizes.
pub(super) type InSizes<'a> = &'a dyn Fn(&Sizes) -> (Units, Signals, VertexPlant);

/// A plant of one vertex, in scaled units. With a given feedback it is closed, and there is no input (n x 0).
struct Standard {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    driven: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    direct: DMatrix<f64>,
}

/// X of `V = x'Xx` with `dV/dt <= gamma^2 |w|^2 - |z|^2`, and F.
struct Regulator {
    gain: DMatrix<f64>,
    x: DMatrix<f64>,
}

impl Standard {
    fn new(requested: &Signals, plant: &VertexPlant, a: &DMatrix<f64>) -> Self {
        let mut out = Standard {
            a: a.clone(),
            b: plant.input.clone(),
            driven: requested.disturbance.clone(),
            c: requested.output.clone(),
            d: requested.input_to_output.clone(),
            direct: requested.disturbance_to_output.clone(),
        };
        if let Some(gain) = &plant.gain {
            out = out.closed(gain);
        }
        out
    }

    /// With a feedback.
    fn closed(&self, gain: &DMatrix<f64>) -> Self {
        Standard {
            a: &self.a + &self.b * gain,
            b: DMatrix::zeros(self.a.nrows(), 0),
            driven: self.driven.clone(),
            c: &self.c + &self.d * gain,
            d: DMatrix::zeros(self.c.nrows(), 0),
            direct: self.direct.clone(),
        }
    }

    /// The feedback and the function at gamma, with weights on input and state added; `None` where there are none.
    fn regulator(&self, gamma: f64, (on_input, on_state): (f64, f64)) -> Option<Regulator> {
        let (n, m) = self.b.shape();
        let (e, c, d) = (&self.direct, &self.c, &self.d);
        let room = gamma * gamma * DMatrix::identity(e.ncols(), e.ncols()) - e.transpose() * e;
        let room = room.cholesky()?.inverse();
        // The worst disturbance eliminated.
        let through = &room * e.transpose();
        let a = &self.a + &self.driven * &through * c;
        let b = &self.b + &self.driven * &through * d;
        let metric = DMatrix::identity(c.nrows(), c.nrows()) + e * &through;
        let cost = c.transpose() * &metric * c + on_state * gamma * DMatrix::identity(n, n);
        let driven = &self.driven * &room * self.driven.transpose();
        if m == 0 {
            let x = stabilising(&a, &symmetric(&-driven), &symmetric(&cost))?;
            let gain = DMatrix::zeros(0, n);
            return positive(&x).then_some(Regulator { gain, x });
        }
        let cross = d.transpose() * &metric * c;
        let effort = d.transpose() * &metric * d + on_input * gamma * DMatrix::identity(m, m);
        let effort = effort.cholesky()?;
        let (by_cross, by_input) = (effort.solve(&cross), effort.solve(&b.transpose()));
        let free = &a - &b * &by_cross;
        let s = symmetric(&(&b * &by_input - driven));
        let q = symmetric(&(cost - cross.transpose() * &by_cross));
        let x = stabilising(&free, &s, &q)?;
        let gain = -(by_input * &x + by_cross);
        positive(&x).then_some(Regulator { gain, x })
    }

    /// True where the bounded real lemma holds for a regulator, to rounding.
    fn holds(&self, gamma: f64, found: &Regulator) -> bool {
        let closed = match found.gain.nrows() {
            0 => None,
            _ => Some(self.closed(&found.gain)),
        };
        let closed = closed.as_ref().unwrap_or(self);
        let p = &found.x / gamma;
        let (n, d, z) = (p.nrows(), closed.driven.ncols(), closed.c.nrows());
        let mut matrix = DMatrix::zeros(n + d + z, n + d + z);
        let decay = &p * &closed.a;
        let decay = -(&decay + decay.transpose());
        let mut put = |row: usize, column: usize, block: &DMatrix<f64>| {
            let transposed = block.transpose();
            matrix
                .view_mut((row, column), block.shape())
                .copy_from(block);
            matrix
                .view_mut((column, row), transposed.shape())
                .copy_from(&transposed);
        };
        put(0, 0, &decay);
        put(0, n, &-(&p * &closed.driven));
        put(0, n + d, &-closed.c.transpose());
        put(n, n, &(gamma * DMatrix::identity(d, d)));
        put(n, n + d, &-closed.direct.transpose());
        put(n + d, n + d, &(gamma * DMatrix::identity(z, z)));
        positive(&p) && positive(&matrix)
    }

    /// A regulator at gamma that holds.
    fn at(&self, gamma: f64) -> Option<Regulator> {
        let pairs = WEIGHTS.iter().map(|&weight| (weight, weight));
        let mut found = pairs.filter_map(|pair| self.regulator(gamma, pair));
        found.find(|found| self.holds(gamma, found))
    }

    /// Those that hold, with large weights on the input, which keep the gains small, first.
    fn each(&self, gamma: f64) -> impl Iterator<Item = Regulator> + '_ {
        let decades = (2..=12).map(|k| 10_f64.powi(-k));
        let pairs =
            decades.flat_map(|weight| [1.0, 1e-3, 1e-6].map(|part| (weight, weight * part)));
        let found = pairs.filter_map(move |pair| self.regulator(gamma, pair));
        found.filter(move |found| self.holds(gamma, found))
    }

    /// The smallest gamma at which [`Standard::at`] finds something, to a relative accuracy, or one below the floor.
    fn smallest(&self, floor: f64, accuracy: f64) -> Option<f64> {
        let possible = |gamma: f64| self.at(gamma).is_some();
        if floor > 0.0 && possible(floor) {
            return Some(floor);
        }
        let above = (0..=2 * DECADES).map(|k| 10_f64.powf(0.5 * f64::from(k)));
        let mut high = above.into_iter().find(|&gamma| possible(gamma))?;
        let mut low = high / 4.0;
        while high > floor && high > 10_f64.powi(-DECADES) && possible(low) {
            high = low;
            low = high / 4.0;
        }
        if high <= floor {
            return Some(floor);
        }
        if high <= 10_f64.powi(-DECADES) {
            return Some(high);
        }
        while high > low * (1.0 + accuracy) {
            let middle = (high * low).sqrt();
            match possible(middle) {
                true => high = middle,
                false => low = middle,
            }
        }
        Some(high)
    }
}

/// The candidates of one plant.
pub(super) struct BoundedReal {
    standard: Standard,
    units: Units,
    given: Option<DMatrix<f64>>,
    /// In scaled units.
    floor: f64,
}

impl BoundedReal {
    /// For a plant of one vertex; `None` where no gamma has a candidate.
    pub(super) fn new(requested: InSizes, plant: &VertexPlant, floor: f64) -> Option<Self> {
        let mut sizes = Sizes::of(plant, 0.0);
        let mut out = None;
        for round in 0..=ROUNDS {
            let next = BoundedReal::in_sizes(requested, plant, &sizes, floor);
            if round < ROUNDS {
                let Some(found) = next.sizes() else {
                    break;
                };
                sizes = found;
            }
            out = Some(next);
        }
        out
    }

    fn in_sizes(requested: InSizes, plant: &VertexPlant, sizes: &Sizes, floor: f64) -> Self {
        let (units, scaled, own) = requested(sizes);
        BoundedReal {
            standard: Standard::new(&scaled, &own, &own.vertices[0]),
            given: plant.gain.clone(),
            floor: floor / units.objective,
            units,
        }
    }

    /// The sizes of the solution a little above the smallest gamma, in the file's units.
    fn sizes(&self) -> Option<Sizes> {
        let gamma = 1.1 * self.standard.smallest(self.floor, 1e-2)?;
        let found = self.standard.at(gamma)?;
        let inverse = symmetric(&(found.x.clone() / gamma).try_inverse()?);
        let usable = inverse.diagonal().iter().all(|&entry| entry > 0.0);
        let moved = &found.gain * &inverse * found.gain.transpose();
        let units = &self.units;
        let energy = units.energy;
        let input = moved.diagonal().map(|square| (square / energy).sqrt());
        let input = match input.len() {
            0 => None,
            _ => Some(input.component_mul(&units.input)),
        };
        usable.then(|| Sizes {
            state: inverse
                .diagonal()
                .zip_map(&units.state, |square, unit| (square / energy).sqrt() * unit),
            input,
            objective: Some(gamma * units.objective),
        })
    }

    fn in_file_units(&self, gamma: f64, found: &Regulator) -> StateFeedback {
        let units = &self.units;
        let gain = match &self.given {
            Some(given) => given.clone(),
            None => units.gain_in_file_units(&found.gain),
        };
        StateFeedback {
            gain,
            lyapunov: units.unweighed(&(&found.x / gamma)) * units.energy,
            guarantee: gamma * units.objective,
            auxiliary: Default::default(),
        }
    }
}

impl Direct for BoundedReal {
    fn name(&self) -> &'static str {
        "Riccati equation"
    }

    fn smallest(&self) -> Option<f64> {
        let gamma = self.standard.smallest(self.floor, ACCURACY)?;
        Some(gamma * self.units.objective)
    }

    fn candidates(&self, objective: f64) -> Box<dyn Iterator<Item = StateFeedback> + '_> {
        let gamma = objective / self.units.objective;
        let found = self.standard.each(gamma);
        Box::new(found.map(move |found| StateFeedback {
            guarantee: objective,
            ..self.in_file_units(gamma, &found)
        }))
    }
}

/// Part of the largest natural frequency by which the regulator of the reference gain must decay.
const REFERENCE_DECAY: f64 = 1e-2;

/// The gain of the mean vertex without control, where it is stable, or with the linear-quadratic regulator that weighs
/// the output and, for each input, the energy that it puts into the output within a natural period, whichever is
/// smaller. No unit of a state or an input changes it. `None` where there is none, or it is 0.
pub(super) fn reference_gain(requested: InSizes, plant: &VertexPlant) -> Option<f64> {
    let (units, scaled, own) = requested(&Sizes::of(plant, 0.0));
    let standard = Standard::new(&scaled, &own, &own.mean());
    let (n, m) = standard.b.shape();
    let open = (abscissa(&standard.a) < 0.0).then(|| DMatrix::zeros(m, n));
    let regulated = regulator_of_output(&standard, units.time);
    let least = 1e-12;
    let norm = |gain: DMatrix<f64>| standard.closed(&gain).smallest(least, 1e-4);
    let norms = [open, regulated].into_iter().flatten().filter_map(norm);
    let norm = norms.reduce(f64::min)?;
    (norm > least).then_some(norm * units.objective)
}

fn regulator_of_output(standard: &Standard, time: f64) -> Option<DMatrix<f64>> {
    let (a, b, c) = (&standard.a, &standard.b, &standard.c);
    let n = a.nrows();
    let radius = spectral_radius(a);
    // Eigenvalues that are 0 but for rounding count as 0.
    let rate = match radius > 1e-6 * a.norm() {
        true => radius,
        false => time,
    };
    let output = c.transpose() * c;
    let shifted = a - 2.0 * rate * DMatrix::identity(n, n);
    let gram = lyapunov(&shifted, &output)?;
    let effort = (b.transpose() * gram * b).diagonal() / rate;
    let largest = effort.max();
    let weights: DVector<f64> = effort.map(|weight| weight.max(1e-12 * largest));
    if !weights.iter().all(|&weight| weight > 0.0) {
        return None;
    }
    let inverse = DMatrix::from_diagonal(&weights.map(|weight| 1.0 / weight));
    let faster = a + REFERENCE_DECAY * rate * DMatrix::identity(n, n);
    let x = stabilising(&faster, &(b * &inverse * b.transpose()), &output)?;
    Some(-inverse * b.transpose() * x)
}
