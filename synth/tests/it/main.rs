//! Every test of the synthesis crate: one program, linked once.

#[path = "support/closed_loop.rs"]
mod closed_loop;
#[path = "support/exact.rs"]
mod exact;
#[path = "support/expressions.rs"]
mod expressions;
#[path = "support/instants.rs"]
mod instants;
#[path = "support/numbers.rs"]
mod numbers;
#[path = "support/printed.rs"]
mod printed;
#[path = "support/random.rs"]
mod random;
#[path = "support/semidefinite.rs"]
mod semidefinite;
#[path = "support/simulation.rs"]
mod simulation;
#[allow(dead_code)]
#[path = "../../../tests/it/support/solvers.rs"]
mod solvers;
#[path = "support/tampering.rs"]
mod tampering;
#[path = "support/units.rs"]
mod units;

mod both;
mod conditions;
mod controller_rounding;
mod corrections;
mod feasibility_boundary;
mod gains;
mod held_command;
mod imperfections;
mod inertia;
mod infeasible;
mod lapack_symbols;
mod lmi_layer;
mod problems;
mod reduction;
mod requirements;
mod scaling;
mod scheduled;
mod sdpa_files;
mod structured;
mod takagi_sugeno;
mod tamper;
mod verified_arithmetic;
mod verified_definiteness;
