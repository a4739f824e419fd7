//! Chordal decomposition of a block matrix inequality.
//!
//! A symmetric block matrix whose pattern is chordal is positive semidefinite exactly when it is a
//! sum of positive semidefinite matrices, each supported on one clique (Agler, Helton, McCullough,
//! Rodman 1988). Blocks are split off one after the other; what a split-off clique hands to the rest
//! is a free symmetric matrix on its separator.

use crate::conditions::xu2020::{Basis, Signal, Term};
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks, Unknowns};

/// Splits one block off: `residual` meets only the blocks of `separator`.
#[derive(Debug, Clone)]
pub struct Split {
    /// Name of the clique.
    pub name: &'static str,
    /// The blocks that appear in this clique only.
    pub residual: Vec<usize>,
    /// The blocks it shares with the rest.
    pub separator: Vec<usize>,
}

/// The splits that eliminate the further bounded signals of (18) and then others in the given order, read off its pattern: the separator of each is what
/// it still meets, and what is handed to the separator couples all of it.
pub fn elimination(basis: &Basis, terms: &[Term], order: &[Signal]) -> Vec<Split> {
    let further = basis.signals().iter();
    let further = further.filter(|signal| matches!(signal, Signal::Further(_)));
    let mut meets = basis.pattern(terms);
    let mut remaining: Vec<bool> = basis.sizes().iter().map(|size| *size > 0).collect();
    let mut out = Vec::new();
    for signal in further.chain(order) {
        let Some(block) = basis.block(*signal).filter(|block| remaining[*block]) else {
            continue;
        };
        remaining[block] = false;
        let neighbour = |other: &usize| remaining[*other] && meets[block][*other];
        let separator: Vec<usize> = (0..remaining.len()).filter(neighbour).collect();
        for &a in &separator {
            separator.iter().for_each(|&b| meets[a][b] = true);
        }
        out.push(Split {
            name: signal.clique(),
            residual: vec![block],
            separator,
        });
    }
    out
}

/// Each clique's name with its signals, in the order of the rows of [`split`]'s matrices; the root last.
pub fn members(basis: &Basis, splits: &[Split]) -> Vec<(&'static str, Vec<Signal>)> {
    let signals = basis.signals();
    let named = |blocks: &[usize]| blocks.iter().map(|block| signals[*block]).collect();
    let split_off = |block: &usize| splits.iter().any(|split| split.residual.contains(block));
    let root: Vec<usize> = (0..signals.len())
        .filter(|block| !split_off(block))
        .collect();
    let cliques = splits.iter().map(|split| {
        let blocks = [split.residual.as_slice(), &split.separator].concat();
        (split.name, named(&blocks))
    });
    cliques.chain([("root", named(&root))]).collect()
}

/// Why a matrix cannot be split in the requested order.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("block {residual} still meets block {other}, which is not in its separator")]
pub struct NotChordal {
    /// The block to be split off.
    pub residual: usize,
    /// The block it meets.
    pub other: usize,
}

/// Splits `matrix >= 0` (blocks of the given sizes) into one matrix for each clique, named; the last
/// one holds the blocks that remain. All of them are positive semidefinite for some value of the new
/// unknowns exactly when the given matrix is.
pub fn split(
    matrix: &Affine,
    sizes: &[usize],
    splits: &[Split],
    unknowns: &mut Unknowns,
) -> Result<Vec<(&'static str, Affine)>, NotChordal> {
    let mut blocks = BlockView::new(matrix.clone(), sizes);
    let mut remaining: Vec<usize> = (0..sizes.len()).collect();
    let mut out = Vec::new();
    for step in splits {
        remaining.retain(|block| !step.residual.contains(block));
        blocks.check(step, &remaining)?;
        let shared = blocks.side(&step.separator);
        let handed = unknowns.symmetric(&format!("separator {}", step.name), shared);
        out.push((step.name, blocks.clique(step, &handed)));
        blocks.subtract(&step.separator, &handed);
    }
    out.push(("root", blocks.extract(&remaining)));
    Ok(out)
}

/// `lhs < 0`, a form with the given terms and a slack matrix, as one condition for each clique; `order`: the signals that
/// are eliminated, `None` for one clique of all.
pub fn split_conditions(
    lhs: Affine,
    (basis, terms, order): (&Basis, &[Term], Option<&[Signal]>),
    strictness: &Strictness,
    unknowns: &mut Unknowns,
    place: &str,
) -> Vec<Condition> {
    let strict = strictness.positive_against("", -lhs, &basis.margin_weight());
    let splits = order.map_or(Vec::new(), |order| elimination(basis, terms, order));
    let parts = split(strict.expression(), basis.sizes(), &splits, unknowns)
        .unwrap_or_else(|error| unreachable!("the pattern of (18) is chordal: {error}"));
    let named = parts.into_iter().map(|(clique, part)| {
        Condition::semidefinite(format!("decrease{place} clique {clique}"), part)
    });
    named.collect()
}

struct BlockView {
    matrix: Affine,
    sizes: Vec<usize>,
    offsets: Vec<usize>,
}

impl BlockView {
    fn new(matrix: Affine, sizes: &[usize]) -> Self {
        let offsets = sizes
            .iter()
            .scan(0, |next, size| {
                let offset = *next;
                *next += size;
                Some(offset)
            })
            .collect();
        BlockView {
            matrix,
            sizes: sizes.to_vec(),
            offsets,
        }
    }

    fn side(&self, blocks: &[usize]) -> usize {
        blocks.iter().map(|&b| self.sizes[b]).sum()
    }

    fn block(&self, row: usize, column: usize) -> Affine {
        let (r, c) = (self.offsets[row], self.offsets[column]);
        self.matrix.view(r, c, self.sizes[row], self.sizes[column])
    }

    fn check(&self, step: &Split, remaining: &[usize]) -> Result<(), NotChordal> {
        let range = |b: usize| self.offsets[b]..self.offsets[b] + self.sizes[b];
        for &residual in &step.residual {
            let outside = remaining.iter().filter(|b| !step.separator.contains(b));
            for &other in outside {
                if self.matrix.touches(range(residual), range(other)) {
                    return Err(NotChordal { residual, other });
                }
            }
        }
        Ok(())
    }

    fn extract(&self, chosen: &[usize]) -> Affine {
        let sizes: Vec<usize> = chosen.iter().map(|&b| self.sizes[b]).collect();
        let mut out = SymmetricBlocks::new(&sizes);
        for (j, &column) in chosen.iter().enumerate() {
            for (i, &row) in chosen.iter().enumerate().take(j + 1) {
                out.add(i, j, &self.block(row, column));
            }
        }
        out.finish()
    }

    /// The residual blocks as they are, the separator's own block replaced by what is handed over.
    fn clique(&self, step: &Split, handed: &Affine) -> Affine {
        let residual = self.side(&step.residual);
        let both: Vec<usize> = step
            .residual
            .iter()
            .chain(&step.separator)
            .copied()
            .collect();
        let mut out = self.extract(&both);
        let shared = self.side(&step.separator);
        let own = out.view(residual, residual, shared, shared);
        out.add_block(residual, residual, &(handed - &own));
        out
    }

    fn subtract(&mut self, separator: &[usize], handed: &Affine) {
        let negative = -handed;
        let mut row = 0;
        for &i in separator {
            let mut column = 0;
            for &j in separator {
                let block = negative.view(row, column, self.sizes[i], self.sizes[j]);
                self.matrix
                    .add_block(self.offsets[i], self.offsets[j], &block);
                column += self.sizes[j];
            }
            row += self.sizes[i];
        }
    }
}

/// Whether the condition with the vertex slack is split into its cliques.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cliques {
    /// Small cones and a free matrix for each separator: for solvers whose work grows with the side of a cone.
    Split,
    /// One cone for each end of the interval: for solvers whose work grows with the number of unknowns.
    Whole,
}
