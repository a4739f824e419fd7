//! Dense kernels on matrix views, over faer.
#![forbid(unsafe_code)]

pub(super) mod blas;
pub(super) mod factor;
pub(super) mod spectral;
mod tridiagonal;
mod workspace;
