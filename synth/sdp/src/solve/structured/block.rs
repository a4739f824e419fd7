//! One semidefinite block and its coefficients.

use crate::lmi::{inner, svec_index, Entry};

/// Coefficients as the iterations read them: where in the column-major block, what, and how often. All that is read for
/// one unknown is contiguous and small.
#[derive(Debug, Clone, Default)]
struct Compact {
    at: Vec<u32>,
    value: Vec<f64>,
    /// The value times how often it stands in the full matrix.
    weight: Vec<f64>,
}

/// One block: `constant + sum_i y_i coefficient_i >= 0`.
#[derive(Debug, Clone)]
pub struct Block {
    /// Side.
    pub side: usize,
    /// Where its side * side entries begin in packed storage.
    pub offset: usize,
    /// Constant matrix.
    pub constant: Vec<Entry>,
    /// Unknowns that occur, those with the most entries first.
    pub unknowns: Vec<usize>,
    /// Entries of the k-th of these unknowns: `entries[starts[k]..starts[k + 1]]`.
    pub starts: Vec<usize>,
    /// See `starts`.
    pub entries: Vec<Entry>,
    /// Index of the cone it comes from.
    pub source: usize,
    /// Its rows in that cone.
    pub rows: Vec<usize>,
    /// Factor of each row: the block is `D X D` of the cone's X.
    pub scale: Vec<f64>,
    compact: Compact,
}

impl Block {
    /// A block with its constant, and no unknowns yet.
    pub fn new(source: usize, rows: Vec<usize>, offset: usize, constant: Vec<Entry>) -> Self {
        Block {
            side: rows.len(),
            offset,
            constant,
            unknowns: Vec::new(),
            starts: vec![0],
            entries: Vec::new(),
            source,
            scale: vec![1.0; rows.len()],
            rows,
            compact: Compact::default(),
        }
    }

    /// Adds an unknown's coefficient.
    pub fn push(&mut self, unknown: usize, entries: impl IntoIterator<Item = Entry>) {
        self.unknowns.push(unknown);
        self.entries.extend(entries);
        self.starts.push(self.entries.len());
    }

    /// Where it lies in packed storage.
    pub fn range(&self) -> std::ops::Range<usize> {
        self.offset..self.offset + self.side * self.side
    }

    /// Entries of the k-th unknown.
    pub fn entries_of(&self, k: usize) -> &[Entry] {
        &self.entries[self.starts[k]..self.starts[k + 1]]
    }

    /// For each of its places (i, j): where it lies in the stacked triangle of its cone, and the factor by which it is
    /// larger than the entry there.
    pub fn places(&self) -> impl Iterator<Item = ((usize, usize), usize, f64)> + '_ {
        let pairs = (0..self.side).flat_map(|j| (0..self.side).map(move |i| (i, j)));
        pairs.map(|(i, j)| {
            let at = svec_index(self.rows[i], self.rows[j]);
            ((i, j), at, self.scale[i] * self.scale[j])
        })
    }

    /// Makes the entries ready for [`evaluate`](Block::evaluate) and [`adjoint`](Block::adjoint), once nothing more changes.
    pub fn finish(&mut self) {
        let side = self.side;
        let entries = self.entries.iter();
        self.compact = Compact {
            at: entries
                .clone()
                .map(|e| (e.column * side + e.row) as u32)
                .collect(),
            value: entries.clone().map(|e| e.value).collect(),
            weight: entries.map(|e| e.count() * e.value).collect(),
        };
    }

    /// Multiplies each unknown's coefficient by its factor.
    pub fn scale_unknowns(&mut self, factors: &[f64]) {
        for (k, &unknown) in self.unknowns.iter().enumerate() {
            for entry in &mut self.entries[self.starts[k]..self.starts[k + 1]] {
                entry.value *= factors[unknown];
            }
        }
    }

    /// Scales rows and columns by powers of two towards entries of one.
    pub fn balance_rows(&mut self) {
        let mut largest = vec![0.0_f64; self.side];
        for entry in &self.entries {
            let size = entry.value.abs();
            largest[entry.row] = largest[entry.row].max(size);
            largest[entry.column] = largest[entry.column].max(size);
        }
        let factors: Vec<f64> = largest
            .iter()
            .map(|&size| power_of_two(1.0 / size.sqrt()))
            .collect();
        for entry in self.entries.iter_mut().chain(&mut self.constant) {
            entry.value *= factors[entry.row] * factors[entry.column];
        }
        for (scale, factor) in self.scale.iter_mut().zip(&factors) {
            *scale *= factor;
        }
    }

    /// `out = constant * factor + sum_i y_i coefficient_i`, full and column-major.
    pub fn evaluate(&self, factor: f64, y: &[f64], out: &mut [f64]) {
        let n = self.side;
        out.fill(0.0);
        if factor != 0.0 {
            for e in &self.constant {
                out[e.column * n + e.row] += factor * e.value;
            }
        }
        let Compact { at, value, .. } = &self.compact;
        for (&unknown, range) in self.unknowns.iter().zip(self.starts.windows(2)) {
            let (from, to) = (range[0], range[1]);
            for (&at, value) in at[from..to].iter().zip(&value[from..to]) {
                out[at as usize] += y[unknown] * value;
            }
        }
        super::dense::mirror(out, n, |upper, _| upper);
    }

    /// `out_i += <A_i, W>` for a symmetric W.
    pub fn adjoint(&self, w: &[f64], out: &mut [f64]) {
        let Compact { at, weight, .. } = &self.compact;
        for (&unknown, range) in self.unknowns.iter().zip(self.starts.windows(2)) {
            let (from, to) = (range[0], range[1]);
            let entries = at[from..to].iter().zip(&weight[from..to]);
            let sum: f64 = entries.map(|(&at, weight)| weight * w[at as usize]).sum();
            out[unknown] += sum;
        }
    }

    /// `<constant, W>` for a symmetric W.
    pub fn against_constant(&self, w: &[f64]) -> f64 {
        inner(&self.constant, |row, column| w[column * self.side + row])
    }
}

/// The power of two nearest to a positive number; 1 for zero and infinity, which stand for "nothing there".
pub fn power_of_two(x: f64) -> f64 {
    if !(x.is_finite() && x > 0.0) {
        return 1.0;
    }
    x.log2().round().clamp(-500.0, 500.0).exp2()
}
