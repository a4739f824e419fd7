//! Test matrices with padded columns, and the comparison with a reference.

use core::ffi::c_int;

/// Value of the entries that a routine must neither read nor write: reading it is seen in the result.
pub const FORBIDDEN: f64 = 777.0;

/// Orders of the square test matrices; the kernels change method within this range.
pub const SIDES: [usize; 10] = [1, 2, 3, 4, 6, 7, 12, 25, 36, 70];

/// Uniform numbers in [-1, 1) from a linear congruential generator.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A column-major matrix whose columns are followed by padding.
#[derive(Clone, Debug)]
pub struct Padded {
    pub rows: usize,
    pub cols: usize,
    padding: usize,
    pub data: Vec<f64>,
}

impl Padded {
    pub fn from_fn(rows: usize, cols: usize, mut entry: impl FnMut(usize, usize) -> f64) -> Self {
        // Square matrices of even order have no padding, which is how the solver stores them.
        let padding = if rows == cols && rows % 2 == 0 { 0 } else { 3 };
        let ld = rows + padding;
        let mut data = vec![FORBIDDEN; ld * cols + padding];
        for j in 0..cols {
            for i in 0..rows {
                data[i + j * ld] = entry(i, j);
            }
        }
        Padded {
            rows,
            cols,
            padding,
            data,
        }
    }

    pub fn random(rows: usize, cols: usize, random: &mut Random) -> Self {
        Self::from_fn(rows, cols, |_, _| random.next())
    }

    pub fn symmetric(n: usize, random: &mut Random) -> Self {
        let half = Self::random(n, n, random);
        Self::from_fn(n, n, |i, j| half.at(i, j) + half.at(j, i))
    }

    pub fn positive_definite(n: usize, random: &mut Random) -> Self {
        let root = Self::random(n, n, random);
        Self::from_fn(n, n, |i, j| {
            let sum: f64 = (0..n).map(|l| root.at(i, l) * root.at(j, l)).sum();
            sum + if i == j { 0.5 } else { 0.0 }
        })
    }

    /// An output to be overwritten: NaN, which survives if it is read.
    pub fn unset(rows: usize, cols: usize) -> Self {
        Self::from_fn(rows, cols, |_, _| f64::NAN)
    }

    /// The same matrix with every entry outside one triangle forbidden.
    pub fn only_triangle(&self, uplo: u8) -> Self {
        Self::from_fn(self.rows, self.cols, |i, j| {
            if in_triangle(uplo, i, j) {
                self.at(i, j)
            } else {
                FORBIDDEN
            }
        })
    }

    pub fn index(&self, i: usize, j: usize) -> usize {
        assert!(i < self.rows && j < self.cols);
        i + j * (self.rows + self.padding)
    }

    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.data[self.index(i, j)]
    }

    /// Entry of the matrix or of its transpose.
    pub fn op(&self, transposed: bool, i: usize, j: usize) -> f64 {
        if transposed {
            self.at(j, i)
        } else {
            self.at(i, j)
        }
    }

    pub fn ld(&self) -> c_int {
        (self.rows + self.padding).max(1) as c_int
    }

    pub fn rows(&self) -> c_int {
        self.rows as c_int
    }

    pub fn cols(&self) -> c_int {
        self.cols as c_int
    }

    pub fn ptr(&self) -> *const f64 {
        self.data.as_ptr()
    }

    pub fn mut_ptr(&mut self) -> *mut f64 {
        self.data.as_mut_ptr()
    }

    pub fn padding_is_untouched(&self) -> bool {
        let ld = self.rows + self.padding;
        (0..self.data.len()).all(|at| {
            let inside = at / ld < self.cols && at % ld < self.rows;
            inside || self.data[at] == FORBIDDEN
        })
    }
}

pub fn in_triangle(uplo: u8, i: usize, j: usize) -> bool {
    match uplo {
        b'L' => i >= j,
        b'U' => i <= j,
        _ => panic!("no triangle"),
    }
}

/// Compares a matrix with its reference entry by entry.
///
/// The tolerance is for sums of a few hundred products of numbers of order one; an entry that is to be
/// [`FORBIDDEN`] must be so exactly.
pub fn assert_matches(got: &Padded, what: &str, wanted: impl Fn(usize, usize) -> f64) {
    assert!(got.padding_is_untouched(), "{what}: padding written");
    for j in 0..got.cols {
        for i in 0..got.rows {
            let (g, w) = (got.at(i, j), wanted(i, j));
            let tolerance = if w == FORBIDDEN {
                0.0
            } else {
                1e-13 * (got.rows + 10) as f64
            };
            assert!(
                (g - w).abs() <= tolerance,
                "{what} at ({i}, {j}) of {}: got {g}, wanted {w}",
                got.rows
            );
        }
    }
}

/// Asserts that the first `count` columns (or rows) of `q` are orthonormal.
pub fn assert_orthonormal(q: &Padded, by_rows: bool, count: usize) {
    let len = if by_rows { q.cols } else { q.rows };
    for i in 0..count {
        for j in 0..count {
            let dot: f64 = (0..len)
                .map(|l| q.op(by_rows, l, i) * q.op(by_rows, l, j))
                .sum();
            let wanted = if i == j { 1.0 } else { 0.0 };
            assert!(
                (dot - wanted).abs() < 1e-14 * (len + 10) as f64,
                "vectors {i} and {j}: {dot}"
            );
        }
    }
}
