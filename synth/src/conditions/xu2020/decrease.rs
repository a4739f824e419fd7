//! Condition (18): the Lyapunov functional decreases between samples.

use nalgebra::DMatrix;

use super::unknowns::{DesignUnknowns, SamplingEnd, SectorUnknowns};
use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, Strictness, SymmetricBlocks};

// Block rows of (18).
const STATE: usize = 0;
const RATE: usize = 1;
const SAMPLE: usize = 2;
const ERROR: usize = 3;
const DEAD_ZONE: usize = 4;
const DISTURBANCE: usize = 5;
const INTEGRAL: usize = 6;

/// The matrix Xi + Omega_r of (18) at one vertex, block by block as printed (corrected terms: Xi_12
/// carries Uh and no L; Xi_45 and Xi_55 as derived for the held state and S = M^-1).
/// Without sector unknowns the dead-zone row is left out; with them it is in units of
/// their own.
/// Side 4n + m + d for r = 1 and 5n + m + d for r = 2. It must be negative definite.
pub fn decrease(
    task: &Task,
    vertex: &DMatrix<f64>,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
) -> Affine {
    let states = vertex.nrows();
    let identity = DMatrix::identity(states, states);
    decrease_with_descriptor(task, (vertex, &identity), interval, unknowns)
}

/// [`decrease`] at one of the model's vertices, with that vertex's own E_i.
fn decrease_at(
    task: &Task,
    index: usize,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
) -> Affine {
    let vertex = &task.system.vertices[index];
    match task.system.descriptors.get(index) {
        None => decrease(task, vertex, interval, unknowns),
        Some(descriptor) => {
            decrease_with_descriptor(task, (vertex, descriptor), interval, unknowns)
        }
    }
}

/// [`decrease`] for E x' = A x + ..., given (A, E): wherever x' is multiplied by Qh' in the printed
/// condition, it is multiplied by E Qh'.
fn decrease_with_descriptor(
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
    }
    out.finish()
}

/// c = sqrt(hbar e^(phi hbar)).
fn integral_factor(task: &Task) -> f64 {
    let specification = &task.specification;
    let hbar = specification.sampling_interval_max;
    (hbar * (specification.decay_rate * hbar).exp()).sqrt()
}

/// The full-size condition (18) at one vertex, for the (first) gain.
pub fn full_condition(
    task: &Task,
    index: usize,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Condition {
    let lhs = decrease_at(task, index, interval, unknowns);
    strictness.positive(condition_name(interval, index), -lhs)
}

/// The full-size condition (18) at one vertex with its own gain, and what the mismatch of the
/// memberships may add.
pub fn full_matched_condition(
    task: &Task,
    index: usize,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
    strictness: &Strictness,
) -> Condition {
    let at_rule = unknowns.with_rule(index);
    let mut lhs = decrease_at(task, index, interval, &at_rule);
    if let Some(slack) = unknowns.mismatch.get(interval.index() - 1) {
        lhs += &slack
            .total(task)
            .congruence(&mismatch_coordinates(task, unknowns, interval));
    }
    strictness.positive(condition_name(interval, index), -lhs)
}

/// The coordinates (B'v, dead zone, x(t_k)) of the mismatch slack from the rows of [`decrease`].
fn mismatch_coordinates(
    task: &Task,
    unknowns: &DesignUnknowns,
    interval: SamplingEnd,
) -> DMatrix<f64> {
    let b = &task.system.input;
    let (n, m, d) = (b.nrows(), b.ncols(), task.system.disturbance.ncols());
    let zone = if unknowns.sector.is_some() { m } else { 0 };
    let integral = if interval == SamplingEnd::End { n } else { 0 };
    let mut out = DMatrix::zeros(m + zone + n, 4 * n + zone + d + integral);
    for (block, weight) in task.specification.multiplier_weights.iter().enumerate() {
        let mut view = out.view_mut((0, block * n), (m, n));
        view.copy_from(&(*weight * b.transpose()));
    }
    for k in 0..zone {
        out[(m + k, 4 * n + k)] = 1.0;
    }
    for k in 0..n {
        out[(m + zone + k, SAMPLE * n + k)] = 1.0;
        out[(m + zone + k, ERROR * n + k)] = -1.0;
    }
    out
}

/// The vertex term of (18), `2 v' A_i Qh' x` as a matrix on the rows x, x', x(t_k^l), for a numeric Qh:
/// 3n x 3n. [`decrease`] at a vertex is [`decrease`] at A = 0 plus this.
pub fn vertex_term(task: &Task, vertex: &DMatrix<f64>, multiplier: &DMatrix<f64>) -> DMatrix<f64> {
    let n = vertex.nrows();
    let a_qt = vertex * multiplier.transpose();
    let mut out = DMatrix::zeros(3 * n, 3 * n);
    for (row, weight) in task.specification.multiplier_weights.iter().enumerate() {
        let mut block = out.view_mut((row * n, 0), (n, n));
        block.copy_from(&(*weight * &a_qt));
    }
    &out + out.transpose()
}

/// The vertex term at one of the model's vertices, `2 v' (A_i Qh' x - (E_i - I) Qh' x')`, likewise.
pub fn vertex_term_at(task: &Task, index: usize, multiplier: &DMatrix<f64>) -> DMatrix<f64> {
    let n = task.system.states();
    let mut out = vertex_term(task, &task.system.vertices[index], multiplier);
    let Some(descriptor) = task.system.descriptors.get(index) else {
        return out;
    };
    let change = (descriptor - DMatrix::identity(n, n)) * multiplier.transpose();
    for (row, weight) in task.specification.multiplier_weights.iter().enumerate() {
        let block = *weight * &change;
        let mut place = out.view_mut((row * n, n), (n, n));
        place -= &block;
        let mut mirrored = out.view_mut((n, row * n), (n, n));
        mirrored -= block.transpose();
    }
    out
}

/// Name of (18) at one vertex, counted from 1 as in the paper.
pub fn condition_name(interval: SamplingEnd, index: usize) -> String {
    format!("decrease r={} vertex {}", interval.index(), index + 1)
}

/// The quantities that (18) is a quadratic form of, each as a constant matrix that maps the chosen
/// coordinates to it.
#[derive(Debug, Clone)]
pub struct Coordinates {
    /// x(t), n rows.
    pub state: DMatrix<f64>,
    /// x'(t), n rows.
    pub rate: DMatrix<f64>,
    /// The last sample x(t_k^l), n rows.
    pub sample: DMatrix<f64>,
    /// The state held by the controller, x(t_k) = x(t_k^l) - e, n rows.
    pub held: DMatrix<f64>,
    /// The multiplied combination v = eps1 x + eps2 x' + eps3 x(t_k^l), n rows.
    pub multiplied: DMatrix<f64>,
    /// The dead zone of the command, m rows (none without sector unknowns).
    pub dead_zone: DMatrix<f64>,
    /// The disturbance, d rows.
    pub disturbance: DMatrix<f64>,
    /// The integral's Schur complement, n rows (used for r = 2 only).
    pub integral: DMatrix<f64>,
}

/// (18) without its vertex term `2 v' A_i Qh' x`, as the quadratic form that bounds V' + phi V -
/// xi |tau|^2 in (28), in any coordinates. With the vertex term added it equals [`decrease`] up to
/// the congruence between the coordinates.
pub fn decrease_form(
    task: &Task,
    interval: SamplingEnd,
    unknowns: &DesignUnknowns,
    coordinates: &Coordinates,
) -> Affine {
    let specification = &task.specification;
    let (phi, nu) = (specification.decay_rate, specification.trigger_threshold);
    let (b, bw) = (&task.system.input, &task.system.disturbance);
    let Coordinates {
        state: x,
        rate: dx,
        sample: xk,
        held: w,
        multiplied: v,
        dead_zone: p,
        disturbance: tau,
        integral: z,
    } = coordinates;
    let error = xk - w;
    let DesignUnknowns {
        lyapunov: uh,
        integral_weight: yh,
        trigger_weight: wh,
        multiplier: qh,
        ..
    } = unknowns;

    // (24): 2 v' (B F w - B dead zone + B_w tau - x')
    let mut plant = b * &unknowns.gain * w + Affine::constant(&(bw * tau)) - qh.transposed() * dx;
    if let Some(sector) = &unknowns.sector {
        plant = plant - b * &sector.weight * p;
    }
    // (23): 2 (x' L1 + xk' L2) (x - xk)
    let path = x.transpose() * (&unknowns.free_state) + xk.transpose() * (&unknowns.free_sample);
    let mut out = (&v.transpose() * plant).symmetrised()
        + phi * uh.congruence(x)
        + (x.transpose() * uh * dx).symmetrised()
        + (&path * &(x - xk)).symmetrised()
        + nu * wh.congruence(w)
        - wh.congruence(&error)
        - unknowns
            .disturbance_weight
            .times_matrix(&(tau.transpose() * tau));
    if let Some(sector) = &unknowns.sector {
        out += &(-2.0 * sector.weight.congruence(p));
        out += &(p.transpose() * &sector.anti_windup * w).symmetrised();
    }
    match interval {
        SamplingEnd::Start => {
            out += &(specification.sampling_interval_max * yh.congruence(dx));
        }
        SamplingEnd::End => {
            out += &(integral_factor(task) * &(&path * z).symmetrised());
            out += &-yh.congruence(z);
        }
    }
    out
}
