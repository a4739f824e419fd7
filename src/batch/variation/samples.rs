//! Samples of the unit cube, one for each run: independent, a Latin hypercube or a Sobol sequence.
//!
//! A sample follows from the seed and the run's index; nothing is stored for each run.

use crate::scenario::PlanFile;
use crate::sim::random::{open_unit, CampaignStream, Random};
use sobol::params::JoeKuoD6;
use sobol::Sobol;

/// Most numbers that a Sobol sequence has directions for.
const SOBOL_NUMBERS: usize = 1000;
/// Bits of a Sobol number; the sequence is used for fewer than 2^this runs.
const SOBOL_BITS: usize = 52;

/// The samples of a campaign.
#[derive(Debug, Clone)]
pub struct Samples {
    seed: u64,
    numbers: usize,
    method: SamplingMethod,
}

#[derive(Debug, Clone)]
enum SamplingMethod {
    Independent,
    LatinHypercube(Vec<Permutation>),
    Sobol {
        directions: Vec<Vec<u64>>,
        shifts: Vec<u64>,
    },
}

/// More numbers are sampled than there are directions for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "field 'dispersions.sampling': a Sobol sequence has at most {most} numbers; {numbers} are drawn"
)]
pub struct TooManyNumbers {
    /// Numbers that are sampled.
    pub numbers: usize,
    /// Most.
    pub most: usize,
}

/// What determines a run: the seed of its noise, and a point of the unit cube.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// Seed of the run.
    pub seed: u64,
    /// Coordinates, each in (0, 1).
    pub coordinates: Vec<f64>,
}

impl Samples {
    /// The samples of a campaign of `runs` runs that draws `numbers` numbers for each.
    ///
    /// # Errors
    /// More numbers than a Sobol sequence is known for.
    pub fn new(
        plan: PlanFile,
        seed: u64,
        runs: u64,
        numbers: usize,
    ) -> Result<Self, TooManyNumbers> {
        let streams = || {
            let all = 0..numbers as u64;
            all.map(|number| Random::of_campaign(seed, CampaignStream::Number(number)))
        };
        let method = match plan {
            PlanFile::Independent => SamplingMethod::Independent,
            PlanFile::LatinHypercube => {
                let permutations = streams().map(|mut random| Permutation::new(runs, &mut random));
                SamplingMethod::LatinHypercube(permutations.collect())
            }
            PlanFile::Sobol if numbers > SOBOL_NUMBERS => {
                return Err(TooManyNumbers {
                    numbers,
                    most: SOBOL_NUMBERS,
                });
            }
            PlanFile::Sobol => SamplingMethod::Sobol {
                directions: Sobol::<f64>::init_direction_vals(
                    numbers,
                    SOBOL_BITS,
                    &JoeKuoD6::standard(),
                ),
                shifts: streams().map(|mut random| random.bits()).collect(),
            },
        };
        Ok(Samples {
            seed,
            numbers,
            method,
        })
    }

    /// The sample of a run, and the seed of its noise.
    pub fn sample(&self, run: u64) -> Sample {
        let mut random = Random::of_campaign(self.seed, CampaignStream::Run(run));
        let seed = random.bits();
        let coordinates = match &self.method {
            SamplingMethod::Independent => {
                (0..self.numbers).map(|_| random.open_uniform()).collect()
            }
            SamplingMethod::LatinHypercube(permutations) => {
                let cells = permutations.iter();
                cells
                    .map(|cells| cells.fraction(run, random.open_uniform()))
                    .collect()
            }
            SamplingMethod::Sobol { directions, shifts } => {
                let numbers = directions.iter().zip(shifts);
                numbers
                    .map(|(directions, shift)| open_unit(sobol(directions, run) ^ shift))
                    .collect()
            }
        };
        Sample { seed, coordinates }
    }
}

/// Coordinate `index` of a Sobol sequence in Gray code order, as 64 bits.
fn sobol(directions: &[u64], index: u64) -> u64 {
    let gray = index ^ (index >> 1);
    let bits = directions.iter().enumerate();
    let set = bits.filter(|(bit, _)| gray >> bit & 1 == 1);
    set.fold(0, |sum, (_, direction)| sum ^ direction)
}

/// A random permutation of 0..length that needs no memory: a Feistel network on the next larger power
/// of four, walked until it is back in the range.
#[derive(Debug, Clone)]
struct Permutation {
    length: u64,
    half_bits: u32,
    keys: [u64; ROUNDS],
}

/// Rounds of the network; four are enough for large ranges, small ones need more.
const ROUNDS: usize = 12;

impl Permutation {
    fn new(length: u64, random: &mut Random) -> Self {
        let bits = u64::BITS - length.saturating_sub(1).leading_zeros();
        Permutation {
            length,
            half_bits: bits.div_ceil(2).max(1),
            keys: std::array::from_fn(|_| random.bits()),
        }
    }

    /// Where `index`, which must be in the range, is moved to.
    fn image(&self, index: u64) -> u64 {
        let mut value = self.network(index);
        // The network permutes the larger range, so the walk comes back to the smaller one.
        while value >= self.length {
            value = self.network(value);
        }
        value
    }

    fn network(&self, value: u64) -> u64 {
        let mask = (1u64 << self.half_bits) - 1;
        let (mut left, mut right) = (value >> self.half_bits, value & mask);
        for key in &self.keys {
            let mixed = mix(right ^ key) & mask;
            (left, right) = (right, left ^ mixed);
        }
        left << self.half_bits | right
    }

    /// A number in the cell of the run: one of `length` equal parts of (0, 1).
    fn fraction(&self, run: u64, within: f64) -> f64 {
        let fraction = (self.image(run) as f64 + within) / self.length as f64;
        fraction.min(1.0 - 0.5 * f64::EPSILON)
    }
}

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): every bit depends on every other.
fn mix(value: u64) -> u64 {
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(plan: PlanFile, runs: u64, numbers: usize) -> Samples {
        Samples::new(plan, 7, runs, numbers).unwrap()
    }

    #[test]
    fn a_latin_hypercube_has_one_point_in_every_cell_of_every_number() {
        for runs in [1, 2, 3, 5, 17, 64, 1000] {
            let points = points(PlanFile::LatinHypercube, runs, 3);
            for number in 0..3 {
                let cell = |run| (points.sample(run).coordinates[number] * runs as f64) as u64;
                let mut cells: Vec<u64> = (0..runs).map(cell).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..runs).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn a_permutation_moves_the_first_index_anywhere_with_the_same_probability() {
        for length in [3u64, 5, 16, 37] {
            let seeds = 2000 * length;
            let mut counts = vec![0.0_f64; length as usize];
            for seed in 0..seeds {
                let mut random = Random::of_campaign(seed, CampaignStream::Number(0));
                counts[Permutation::new(length, &mut random).image(0) as usize] += 1.0;
            }
            let square = |count: &f64| (count - 2000.0).powi(2) / 2000.0;
            let chi: f64 = counts.iter().map(square).sum();
            // Five standard deviations of a chi-square variable.
            let freedom = (length - 1) as f64;
            assert!(
                chi < freedom + 5.0 * (2.0 * freedom).sqrt(),
                "{length}: {chi}"
            );
        }
    }

    #[test]
    fn a_sobol_sequence_is_the_library_s_and_the_shift_keeps_one_point_in_every_cell() {
        let points = points(PlanFile::Sobol, 256, 5);
        let SamplingMethod::Sobol { directions, .. } = &points.method else {
            panic!("not a Sobol sequence");
        };
        let params = JoeKuoD6::standard();
        let library = Sobol::<f64>::new_with_resolution(5, &params, Some(SOBOL_BITS));
        for (run, expected) in library.take(256).enumerate() {
            let own = directions.iter().map(|d| sobol(d, run as u64));
            let own: Vec<f64> = own.map(|bits| bits as f64 / 2.0_f64.powi(64)).collect();
            assert_eq!(own, expected);
        }
        for number in 0..5 {
            let cell = |run| (points.sample(run).coordinates[number] * 256.0) as u64;
            let mut cells: Vec<u64> = (0..256).map(cell).collect();
            cells.sort_unstable();
            assert_eq!(cells, (0..256).collect::<Vec<_>>());
        }
    }

    #[test]
    fn points_are_inside_of_the_open_cube_and_seeds_differ() {
        for plan in [
            PlanFile::Independent,
            PlanFile::LatinHypercube,
            PlanFile::Sobol,
        ] {
            let points = points(plan, 500, 4);
            let mut seeds: Vec<u64> = (0..500).map(|run| points.sample(run).seed).collect();
            seeds.sort_unstable();
            seeds.dedup();
            assert_eq!(seeds.len(), 500);
            let all = (0..500).flat_map(|run| points.sample(run).coordinates);
            assert!(all.into_iter().all(|u| u > 0.0 && u < 1.0));
        }
        assert_eq!(open_unit(0), 0.5 / (1u64 << 52) as f64);
        assert!(open_unit(u64::MAX) < 1.0);
    }
}
