//! The condition on the time before the first torque, for a given functional.
//!
//! Without torque V = x'Ux + the integral term obeys V' <= kappa V + xi |tau|^2 when, with multipliers of their own,
//!
//! ```text
//! [ [Q1 A]_s - kappa U,  U - Q1 E + A'Q2',   Q1 B_w + A'Q3'  ;
//!   *,                   -[Q2 E]_s + h_m Y,  Q2 B_w - E'Q3'  ;
//!   *,                   *,                  [Q3 B_w]_s - xi I ] < 0
//! ```
//!
//! at every vertex. It is linear in kappa and the multipliers.

use nalgebra::DMatrix;

use crate::conditions::Task;
use sdp::lmi::{Affine, Condition, LmiProblem, Strictness, SymmetricBlocks, Unknowns};

/// The functional, in the units of the task.
pub struct Functional {
    /// U, n x n.
    pub lyapunov: DMatrix<f64>,
    /// Y, n x n.
    pub integral_weight: DMatrix<f64>,
    /// xi.
    pub disturbance_weight: f64,
}

/// The unknowns. n states, d disturbances.
pub struct FirstTorqueUnknowns {
    /// kappa [1/s].
    pub growth: Affine,
    /// Q1, n x n.
    pub state: Affine,
    /// Q2, n x n.
    pub rate: Affine,
    /// Q3, d x n.
    pub disturbance: Affine,
}

/// The smallest kappa, with the condition at every vertex.
pub fn smallest_growth(task: &Task, functional: &Functional) -> (LmiProblem, FirstTorqueUnknowns) {
    let mut unknowns = Unknowns::new();
    let (n, d) = (task.system.states(), task.system.disturbance.ncols());
    let own = FirstTorqueUnknowns {
        growth: unknowns.scalar("kappa"),
        state: unknowns.general("Q1", n, n),
        rate: unknowns.general("Q2", n, n),
        disturbance: unknowns.general("Q3", d, n),
    };
    let strictness = Strictness::fixed(task.specification.margin);
    let mut conditions = vec![Condition::semidefinite(
        "growth positive",
        own.growth.clone(),
    )];
    for vertex in 0..task.system.vertices.len() {
        let name = format!("before the first torque vertex {}", vertex + 1);
        let form = without_torque(task, functional, &own, vertex);
        conditions.push(strictness.positive(name, -form));
    }
    let problem = LmiProblem {
        objective: own.growth.clone(),
        unknowns,
        conditions,
    };
    (problem, own)
}

fn without_torque(
    task: &Task,
    functional: &Functional,
    own: &FirstTorqueUnknowns,
    vertex: usize,
) -> Affine {
    let system = &task.system;
    let n = system.states();
    let identity = DMatrix::identity(n, n);
    let (a, bw) = (&system.vertices[vertex], &system.disturbance);
    let e = system.descriptors.get(vertex).unwrap_or(&identity);
    let d = bw.ncols();
    let (q1, q2, q3) = (&own.state, &own.rate, &own.disturbance);
    let known = |matrix: &DMatrix<f64>| Affine::constant(matrix);
    let oldest = task.oldest_sample();
    let mut out = SymmetricBlocks::new(&[n, n, d]);
    let weighted = own.growth.times_matrix(&functional.lyapunov);
    out.add(0, 0, &((q1 * a).symmetrised() - weighted));
    let beside = known(&functional.lyapunov) - q1 * e + a.transpose() * &q2.transposed();
    out.add(0, 1, &beside);
    out.add(0, 2, &(q1 * bw + a.transpose() * &q3.transposed()));
    let integral = known(&(&functional.integral_weight * oldest));
    out.add(1, 1, &(integral - (q2 * e).symmetrised()));
    out.add(1, 2, &(q2 * bw - e.transpose() * &q3.transposed()));
    let weight = Affine::identity(d, functional.disturbance_weight);
    out.add(2, 2, &((q3 * bw).symmetrised() - weight));
    out.finish()
}
