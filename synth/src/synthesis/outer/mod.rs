//! Searches over what the certificate depends on and the engineer does not care about.

mod inner;
mod parameters;

#[cfg(test)]
mod experiment;
