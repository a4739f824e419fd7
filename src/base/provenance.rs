//! What a result says of where it comes from.

use sha2::{Digest, Sha256};

/// The program that made a result.
pub const GENERATOR: &str = concat!("steadfast ", env!("CARGO_PKG_VERSION"));

/// SHA-256 of a text, in hexadecimal.
pub fn sha256_of(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}
