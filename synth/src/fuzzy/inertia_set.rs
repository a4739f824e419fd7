//! The set of inertia matrices that a robust design is proved for.

use nalgebra::Matrix3;

/// The six entries of a symmetric 3 x 3 matrix, diagonal first.
pub const INERTIA_ENTRIES: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// How far each entry of the inertia matrix may be from its nominal value, independently of the
/// others: the set is a box in the space of the six entries. A percentage is relative to the magnitude
/// of the entry itself, so an entry that is zero has width only from the absolute amount.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct InertiaUncertainty {
    /// Percentage of each diagonal entry, in [0, 100].
    pub diagonal_percent: f64,
    /// Percentage of each off-diagonal entry, in [0, 100].
    pub off_diagonal_percent: f64,
    /// Added to the half-width of each off-diagonal entry [kg m^2].
    pub off_diagonal_amount: f64,
}

impl InertiaUncertainty {
    /// The percentage and the amount [kg m^2] that hold for an entry.
    pub fn of_entry(&self, (row, column): (usize, usize)) -> (f64, f64) {
        match row == column {
            true => (self.diagonal_percent, 0.0),
            false => (self.off_diagonal_percent, self.off_diagonal_amount),
        }
    }

    /// Half-width of an entry [kg m^2] about the nominal inertia, rounded to nearest.
    pub fn half_width(&self, nominal: &Matrix3<f64>, entry: (usize, usize)) -> f64 {
        let (percent, amount) = self.of_entry(entry);
        percent * nominal[entry].abs() / 100.0 + amount
    }

    /// The entries that are not known exactly, in the order of [`INERTIA_ENTRIES`].
    pub fn uncertain_entries(&self, nominal: &Matrix3<f64>) -> Vec<(usize, usize)> {
        let has_width = |entry: &(usize, usize)| {
            let (percent, amount) = self.of_entry(*entry);
            (percent > 0.0 && nominal[*entry] != 0.0) || amount > 0.0
        };
        INERTIA_ENTRIES.into_iter().filter(has_width).collect()
    }

    /// The vertices of the set, rounded to nearest: with k uncertain entries 2^k of them, the nominal
    /// inertia alone when k = 0. Bit b of a vertex's index means that the b-th uncertain entry is at its
    /// upper bound.
    pub fn vertices(&self, nominal: &Matrix3<f64>) -> Vec<Matrix3<f64>> {
        let entries = self.uncertain_entries(nominal);
        let vertex = |index: usize| {
            let mut out = *nominal;
            for (bit, &(row, column)) in entries.iter().enumerate() {
                let width = self.half_width(nominal, (row, column));
                let sign = if index >> bit & 1 == 1 { 1.0 } else { -1.0 };
                out[(row, column)] += sign * width;
                out[(column, row)] = out[(row, column)];
            }
            out
        };
        (0..1 << entries.len()).map(vertex).collect()
    }

    /// How far outside of the set an inertia is: the largest distance of an entry beyond its bound,
    /// relative to the largest nominal moment; 0 or below inside.
    pub fn excess(&self, nominal: &Matrix3<f64>, inertia: &Matrix3<f64>) -> f64 {
        let scale = nominal.amax().max(f64::MIN_POSITIVE);
        let excess = INERTIA_ENTRIES.map(|entry| {
            let distance = (inertia[entry] - nominal[entry]).abs();
            (distance - self.half_width(nominal, entry)) / scale
        });
        excess.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// The inertia whose uncertain entries are at the given places between their lower (0) and upper
    /// (1) bounds, in the order of [`INERTIA_ENTRIES`]; the other places are not used.
    pub fn member(&self, nominal: &Matrix3<f64>, places: &[f64; 6]) -> Matrix3<f64> {
        let mut out = *nominal;
        for (&(row, column), place) in INERTIA_ENTRIES.iter().zip(places) {
            let width = self.half_width(nominal, (row, column));
            out[(row, column)] += (2.0 * place.clamp(0.0, 1.0) - 1.0) * width;
            out[(column, row)] = out[(row, column)];
        }
        out
    }
}

/// By how much the largest principal moment exceeds the sum of the other two [kg m^2]; above 0 no
/// rigid body has this inertia.
pub fn triangle_excess(inertia: &Matrix3<f64>) -> f64 {
    let moments = inertia.symmetric_eigenvalues();
    2.0 * moments.max() - moments.sum()
}
