//! Samples for reference vectors: small and large states, and what a controller must refuse.

use nalgebra::Vector3;
use runtime::attitude::{AttitudeMeasurement, Quaternion};

use crate::sim::random::{Purpose, Random};

/// Samples of a set of vectors where no number is asked for.
pub const SAMPLES: usize = 400;

/// Seed of the samples.
const SEED: u64 = 1;

/// Sizes of the jumps, over those of the certified set.
const SIZES: [f64; 4] = [1.2, 0.1, 1e-3, 1e-7];

/// What a state does between samples and jumps: it decays by this factor, and moves by this share of itself.
const DECAY: f64 = 0.97;
const MOVED: f64 = 0.04;

/// What the samples are like.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// Size of each state.
    pub states: Vec<f64>,
    /// Longest sampling interval (s).
    pub interval_s: f64,
}

/// Times (s) with states; some are no numbers, or no times that follow.
pub fn states(extent: &Extent, count: usize) -> Vec<(f64, Vec<f64>)> {
    let mut random = Random::new(SEED, Purpose::InitialState);
    let mut state = extent.states.clone();
    let mut time_s = 0.0;
    let samples = (0..count).map(|index| {
        step(&mut state, extent, index, &mut random);
        let last_s = time_s;
        time_s += extent.interval_s * (0.2 + 0.8 * random.open_uniform());
        match index % 50 {
            // Later than the proof allows.
            7 => time_s += 2.0 * extent.interval_s,
            17 => return (time_s - 100.0 * extent.interval_s, state.clone()),
            19 => return (last_s, state.clone()),
            23 => return (f64::NAN, state.clone()),
            _ => {}
        }
        let mut seen = state.clone();
        let place = index % seen.len();
        if let Some(component) = seen.get_mut(place) {
            match index % 50 {
                29 => *component = f64::NAN,
                31 => *component = f64::INFINITY,
                37 => *component = 1e200,
                _ => {}
            }
        }
        (time_s, seen)
    });
    samples.collect()
}

/// The next state.
fn step(state: &mut [f64], extent: &Extent, index: usize, random: &mut Random) {
    let signed = |random: &mut Random| 2.0 * random.open_uniform() - 1.0;
    let size = SIZES[(index / 25) % SIZES.len()];
    for (component, &extent) in state.iter_mut().zip(&extent.states) {
        *component = match index % 25 {
            0 => size * extent * signed(random),
            _ => *component * (DECAY + MOVED * signed(random)),
        };
    }
}

/// The same for attitudes: the last three states are the vector part of the error quaternion, of which either sign is
/// measured; some quaternions are none of an attitude.
pub fn attitudes(extent: &Extent, count: usize) -> Vec<(f64, AttitudeMeasurement)> {
    let samples = states(extent, count).into_iter().enumerate();
    let measured = samples.map(|(index, (time_s, state))| {
        let [rate, vector] = [0, 3].map(|first| Vector3::from_fn(|axis, _| state[first + axis]));
        let square = vector.dot(&vector);
        let (scalar, vector) = match square < 1.0 {
            true => ((1.0 - square).sqrt(), vector),
            // Beyond a half turn: as far as there is; what is no number stays so.
            false if square < 1e4 => (0.0, vector / square.sqrt()),
            false => (0.5, vector),
        };
        let sign = match index % 3 {
            0 => -1.0,
            _ => 1.0,
        };
        let size = match index % 50 {
            41 => 1.1,
            43 => 1.004,
            _ => 1.0,
        };
        let error = Quaternion::new(sign * size * scalar, vector * (sign * size));
        let measurement = AttitudeMeasurement {
            error,
            rate_rad_s: rate,
        };
        (time_s, measurement)
    });
    measured.collect()
}
