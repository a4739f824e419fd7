//! Symmetric block matrices.

use super::Affine;

/// A symmetric matrix assembled block by block; only blocks on and above the diagonal are given,
/// the others are their transposes (the stars of the papers).
#[derive(Debug, Clone)]
pub struct SymmetricBlocks {
    offsets: Vec<usize>,
    matrix: Affine,
}

impl SymmetricBlocks {
    /// A zero matrix with the given block sizes.
    pub fn new(sizes: &[usize]) -> Self {
        let mut offsets = vec![0];
        for size in sizes {
            offsets.push(offsets[offsets.len() - 1] + size);
        }
        let side = offsets[sizes.len()];
        SymmetricBlocks {
            offsets,
            matrix: Affine::zeros(side, side),
        }
    }

    /// The whole matrix from its blocks on and above the diagonal, one list for each row of blocks, each beginning with
    /// the block on the diagonal.
    pub fn of(upper: &[&[&Affine]]) -> Affine {
        let sizes: Vec<usize> = upper.iter().map(|blocks| blocks[0].nrows()).collect();
        let mut out = SymmetricBlocks::new(&sizes);
        for (row, blocks) in upper.iter().enumerate() {
            for (k, block) in blocks.iter().enumerate() {
                out.add(row, row + k, block);
            }
        }
        out.finish()
    }

    /// Adds `block` at block position (row, column), row <= column, and its transpose at the
    /// mirrored position.
    ///
    /// # Panics
    /// When the block lies below the diagonal, has the wrong shape, or stands on the diagonal
    /// without being symmetric.
    pub fn add(&mut self, row: usize, column: usize, block: &Affine) {
        assert!(row <= column, "give the blocks on and above the diagonal");
        let size = |k: usize| self.offsets[k + 1] - self.offsets[k];
        assert_eq!((block.nrows(), block.ncols()), (size(row), size(column)));
        let (r, c) = (self.offsets[row], self.offsets[column]);
        if row == column {
            assert!(block.is_symmetric(), "a diagonal block must be symmetric");
            self.matrix.add_block(r, r, block);
        } else {
            self.matrix.add_block(r, c, block);
            self.matrix.add_block(c, r, &block.transposed());
        }
    }

    /// The whole matrix.
    pub fn finish(self) -> Affine {
        self.matrix
    }
}
