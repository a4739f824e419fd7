//! Points to start the iterations from.

use super::dense::dot;
use super::iterate::Factors;
use super::layout::{Iterate, Layout};

/// The start's slack and multipliers, relative to the size of the data.
const START_SLACK: f64 = 1.0;
/// See above.
const START_MULTIPLIER: f64 = 0.1;

/// Multiples of the identity by the size of the data, in the manner of CSDP (Borchers 1999); `scale` makes them
/// larger.
pub fn cold_start(layout: &Layout, scale: f64) -> Iterate {
    let norms = layout.coefficient_norms();
    let sides = layout.blocks.iter().map(|block| block.side);
    let n = sides.max().unwrap_or(1) as f64;
    let ratios = layout
        .cost
        .iter()
        .zip(&norms)
        .map(|(c, norm)| (1.0 + c.abs()) / (1.0 + norm));
    let multiplier = scale * START_MULTIPLIER * n * ratios.fold(0.0, f64::max);
    let largest = norms
        .iter()
        .fold(layout.constant_norm(), |max, &norm| max.max(norm));
    let slack = scale * START_SLACK * (1.0 + largest.max(layout.constant_norm()));
    let mut point = layout.origin();
    layout.add_identity(slack, &mut point.s);
    layout.add_identity(multiplier, &mut point.z);
    point
}

/// A start from unknowns that satisfy the inequalities strictly, on the central path as far as its equations
/// allow: Z is the multiple of S^-1 that meets `<A_i, Z> = c_i` best.
pub fn feasible_start(layout: &Layout, y: &[f64]) -> Option<Iterate> {
    let mut point = layout.origin();
    point.y.copy_from_slice(y);
    layout.evaluate(1.0, y, 1, &mut point.s);
    // Any definite matrix: only the factors of S are wanted.
    layout.add_identity(1.0, &mut point.z);
    let mut factors = Factors::new(layout);
    if !factors.update(layout, &point, 1) {
        return None;
    }
    let mut products = vec![0.0; layout.cost.len()];
    layout.adjoint(&factors.s_inverse, 1, &mut products);
    let size = dot(&products, &products);
    let best = dot(&products, &layout.cost) / size;
    let fallback = dot(&layout.cost, &layout.cost).sqrt() / size.sqrt();
    let multiple = if best > 0.0 { best } else { fallback };
    if !(multiple > 0.0 && multiple.is_finite()) {
        return None;
    }
    let inverse = factors.s_inverse.iter();
    point.z = inverse.map(|entry| multiple * entry).collect();
    Some(point)
}
