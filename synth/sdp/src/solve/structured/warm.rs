//! Warm starts from the iterates of a neighbouring problem.
//!
//! A solution itself is a bad start: it lies on the boundary, where short steps are all that a changed problem allows. The points
//! on the way to it are well inside, and the last of them that the changed problem still finds well inside is a good start.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::dense;
use super::layout::{Iterate, Layout};
use crate::lmi::Semidefinite;

/// Kinds of problems remembered.
const KINDS: usize = 4;

/// How far from the central path a start may lie: the smallest eigenvalue of S Z relative to their mean.
const CENTRAL: f64 = 0.03;

/// Points are kept when the complementarity has fallen to this part of the last one's.
const KEPT: f64 = 0.7;

/// A start's residual of `<A_i, Z> = c_i`, relative, may exceed its relative complementarity by this factor.
const DUAL_ROOM: f64 = 100.0;

/// Iterates of a solve, in the problem's own units.
#[derive(Debug, Clone, Default)]
pub struct Iterates {
    points: Vec<Known>,
    /// Of the last one.
    complementarity: Option<f64>,
}

#[derive(Debug, Clone)]
struct Known {
    values: Vec<f64>,
    duals: Vec<Vec<f64>>,
}

impl Iterates {
    /// Keeps a point that is nearer to the solution than the last one.
    pub fn record(&mut self, layout: &Layout, problem: &Semidefinite, point: &Iterate) {
        let complementarity = dense::dot(&point.s, &point.z);
        let near = |last: f64| complementarity > KEPT * last;
        if self.complementarity.is_some_and(near) {
            return;
        }
        self.complementarity = Some(complementarity);
        self.points.push(Known {
            values: layout.values(&point.y, problem.cost.len()),
            duals: layout.duals(&point.z, problem),
        });
    }

    /// A point that is a good start for a problem of the same shape while the next one is not, and the part of the
    /// iterates before it.
    pub fn start(&self, layout: &Layout) -> Option<(Iterate, Iterates)> {
        let mut found = None;
        let (mut low, mut high) = (0, self.points.len());
        while low < high {
            let middle = (low + high) / 2;
            let known = &self.points[middle];
            let point = layout.point(&known.values, &known.duals);
            if is_central(layout, &point) {
                found = Some((middle, point));
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        let (index, point) = found?;
        let iterates = Iterates {
            points: self.points[..index].to_vec(),
            complementarity: None,
        };
        Some((point, iterates))
    }

    /// True when nothing was recorded.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }
}

/// Whether S and Z are positive definite, near the central path, and Z nearly meets its equations.
fn is_central(layout: &Layout, point: &Iterate) -> bool {
    let complementarity = dense::dot(&point.s, &point.z);
    let mean = complementarity / layout.order as f64;
    if !(mean > 0.0 && mean.is_finite()) {
        return false;
    }
    let mut products = vec![0.0; layout.cost.len()];
    layout.adjoint(&point.z, 1, &mut products);
    let objective = dense::dot(&layout.cost, &point.y).abs();
    if layout.dual_residual(&products) > DUAL_ROOM * complementarity / objective.max(1e-3) {
        return false;
    }
    let least = CENTRAL * mean;
    dense::vectorised(
        #[inline(always)]
        || {
            for block in &layout.blocks {
                let range = block.range();
                if !exceeds(block.side, &point.s[range.clone()], &point.z[range], least) {
                    return false;
                }
            }
            true
        },
    )
}

/// Whether every eigenvalue of S Z is above `least`.
#[inline(always)]
fn exceeds(n: usize, s: &[f64], z: &[f64], least: f64) -> bool {
    let mut root = z.to_vec();
    if !dense::cholesky(&mut root, n) {
        return false;
    }
    // L' S L has the eigenvalues of S Z.
    let (mut half, mut product) = (vec![0.0; n * n], vec![0.0; n * n]);
    dense::product(s, &root, &mut half, n);
    dense::transposed_product(&root, &half, &mut product, n);
    for k in 0..n {
        product[k * n + k] -= least;
    }
    dense::cholesky(&mut product, n)
}

/// Iterates of the last problems, by their shape. Cheap to clone: clones share it.
#[derive(Debug, Clone, Default)]
pub struct Memory {
    iterates: Arc<Mutex<Vec<(u64, Iterates)>>>,
}

impl Memory {
    /// The same iterates, not shared.
    pub fn copied(&self) -> Self {
        Memory {
            iterates: Arc::new(Mutex::new(self.lock().clone())),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(u64, Iterates)>> {
        self.iterates.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The iterates of the last problem of this shape.
    pub fn recall(&self, shape: u64) -> Option<Iterates> {
        let kept = self.lock();
        let known = kept.iter().find(|(known, _)| *known == shape);
        known.map(|(_, iterates)| iterates.clone())
    }

    /// Keeps the iterates of a solve in the place of those of the same shape, or of the oldest.
    pub fn keep(&self, shape: u64, iterates: Iterates) {
        if iterates.is_empty() {
            return;
        }
        let mut kept = self.lock();
        kept.retain(|(known, _)| *known != shape);
        kept.push((shape, iterates));
        if kept.len() > KINDS {
            kept.remove(0);
        }
    }
}

/// What two problems must have in common: sides, unknowns, and which unknowns occur where.
pub fn shape(problem: &Semidefinite) -> u64 {
    let mut hasher = DefaultHasher::new();
    problem.cost.len().hash(&mut hasher);
    for cone in &problem.cones {
        cone.side.hash(&mut hasher);
        for (unknown, entries) in &cone.coefficients {
            (unknown, entries.len()).hash(&mut hasher);
        }
    }
    hasher.finish()
}
