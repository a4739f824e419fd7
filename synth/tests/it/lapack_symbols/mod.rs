//! Every BLAS and LAPACK symbol of the crate against plain references: triple loops, reconstruction residuals.
//!
//! The symbols are called through their C declarations, as the conic solver calls them, with padded columns.

mod decompositions;
mod matrices;
mod products;
mod solver;
mod symbols;
mod systems;

#[test]
fn the_symbols_can_be_kept_by_name() {
    synth::solve::lapack::link();
}
