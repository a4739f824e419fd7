//! Where the numbers of many runs come from: values of a file's numbers on a [`grid`], or [`samples`] of a
//! unit cube.

pub mod axis;
pub mod grid;
pub mod parameter;
pub mod samples;
