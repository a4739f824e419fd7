//! Condition (18) as printed, block by block: what the terms of the crate are held against.

use nalgebra::DMatrix;
use synth::conditions::xu2020::{DesignUnknowns, SamplingEnd, SectorUnknowns};
use synth::conditions::Task;
use synth::lmi::{Affine, SymmetricBlocks};

// Block rows of (18).
const STATE: usize = 0;
const RATE: usize = 1;
const SAMPLE: usize = 2;
const ERROR: usize = 3;
const DEAD_ZONE: usize = 4;
const DISTURBANCE: usize = 5;
const INTEGRAL: usize = 6;

/// Xi + Omega_r of (18) for E x' = A x + ..., given (A, E), block by block as printed (corrected terms: Xi_12 carries
/// Uh and no L; Xi_45 and Xi_55 as derived for the held state and S = M^-1): wherever x' is multiplied by Qh' in the
/// printed condition, it is multiplied by E Qh'.
pub fn printed(
    task: &Task,
    (vertex, descriptor): (&DMatrix<f64>, &DMatrix<f64>),
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
) -> Affine {
    let DesignUnknowns {
        lyapunov: uh,
        integral_weight: yh,
        trigger_weight: wh,
        multiplier: qh,
        free_state: l1h,
        free_sample: l2h,
        gain: fh,
        disturbance_weight: xi,
        ..
    } = unknowns;
    let specification = &task.specification;
    let [e1, e2, e3] = specification.multiplier_weights;
    let (phi, nu) = (specification.decay_rate, specification.trigger_threshold);
    let (a, b, bw) = (vertex, &task.system.input, &task.system.disturbance);
    let (n, m, d) = (b.nrows(), b.ncols(), bw.ncols());

    let a_qt = a * &qh.transposed(); // A Qh'
    let q_at = a_qt.transposed(); // Qh A'
    let e_qt = descriptor * &qh.transposed(); // E Qh'
    let bf = b * fh;

    let m = if unknowns.sector.is_some() { m } else { 0 };
    let mut sizes = vec![n, n, n, n, m, d];
    if interval == SamplingEnd::End {
        sizes.push(n);
    }
    let mut out = SymmetricBlocks::new(&sizes);
    out.add(
        STATE,
        STATE,
        &((e1 * &a_qt).symmetrised() + phi * uh + l1h.symmetrised()),
    );
    out.add(STATE, RATE, &(uh - &(e1 * &e_qt) + e2 * &q_at));
    out.add(
        STATE,
        SAMPLE,
        &(e1 * &bf + e3 * &q_at - l1h.clone() + l2h.transposed()),
    );
    out.add(STATE, ERROR, &(-e1 * &bf));
    out.add(STATE, DISTURBANCE, &Affine::constant(&(e1 * bw)));
    out.add(RATE, RATE, &(-e2 * e_qt.symmetrised()));
    out.add(RATE, SAMPLE, &(-e3 * e_qt.transposed() + e2 * &bf));
    out.add(RATE, ERROR, &(-e2 * &bf));
    out.add(RATE, DISTURBANCE, &Affine::constant(&(e2 * bw)));
    out.add(
        SAMPLE,
        SAMPLE,
        &(-l2h.symmetrised() + nu * wh + (e3 * &bf).symmetrised()),
    );
    out.add(SAMPLE, ERROR, &(-e3 * &bf - nu * wh));
    out.add(SAMPLE, DISTURBANCE, &Affine::constant(&(e3 * bw)));
    out.add(ERROR, ERROR, &((nu - 1.0) * wh));
    out.add(
        DISTURBANCE,
        DISTURBANCE,
        &-xi.times_matrix(&DMatrix::identity(d, d)),
    );
    if let Some(SectorUnknowns {
        anti_windup,
        weight,
        row_unit,
    }) = &unknowns.sector
    {
        let unit = *row_unit;
        let bs = unit * (b * weight);
        let nt = unit * anti_windup.transposed();
        out.add(STATE, DEAD_ZONE, &(-e1 * &bs));
        out.add(RATE, DEAD_ZONE, &(-e2 * &bs));
        out.add(SAMPLE, DEAD_ZONE, &(-e3 * &bs + nt.clone()));
        out.add(ERROR, DEAD_ZONE, &-nt);
        out.add(DEAD_ZONE, DEAD_ZONE, &(-2.0 * unit * unit * weight));
    }
    match interval {
        SamplingEnd::Start => {
            out.add(RATE, RATE, &(specification.sampling_interval_max * yh));
        }
        SamplingEnd::End => {
            let c = integral_factor(task);
            out.add(STATE, INTEGRAL, &(c * l1h));
            out.add(SAMPLE, INTEGRAL, &(c * l2h));
            out.add(INTEGRAL, INTEGRAL, &-yh);
        }
        SamplingEnd::Any => unreachable!("the paper has no delay"),
    }
    out.finish()
}

/// c = sqrt(hbar e^(phi hbar)).
fn integral_factor(task: &Task) -> f64 {
    let specification = &task.specification;
    let hbar = specification.sampling_interval_max;
    (hbar * (specification.decay_rate * hbar).exp()).sqrt()
}
