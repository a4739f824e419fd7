//! Searches over what the certificate depends on and the engineer does not care about.

mod climb;
mod inner;
mod parameters;

#[cfg(test)]
mod experiment;
