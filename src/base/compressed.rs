//! Text that may be compressed.

use std::io::Read;
use std::path::Path;

use synth::model::{read_bytes_up_to, FileError};

/// The first bytes of a gzip file (RFC 1952).
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// Reads a text of at most `limit` bytes, also from a gzip file, whatever its name. Bytes that are not UTF-8, such as
/// the accents of an old comment, become replacement characters.
///
/// # Errors
/// A file that cannot be read or decompressed, or is longer.
pub fn read_text(path: &Path, limit: u64) -> Result<String, FileError> {
    let bytes = read_bytes_up_to(path, limit)?;
    let bytes = match bytes.starts_with(&GZIP) {
        true => decompressed(&bytes, limit)?,
        false => bytes,
    };
    Ok(String::from_utf8(bytes)
        .unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned()))
}

fn decompressed(bytes: &[u8], limit: u64) -> Result<Vec<u8>, FileError> {
    let mut out = Vec::new();
    // Some writers put several parts one after the other.
    let mut decoder = flate2::read::MultiGzDecoder::new(bytes).take(limit + 1);
    decoder
        .read_to_end(&mut out)
        .map_err(|source| FileError::Io {
            action: "cannot be decompressed (gzip)",
            source,
        })?;
    match out.len() as u64 > limit {
        true => Err(FileError::TooLarge {
            bytes: limit + 1,
            limit,
        }),
        false => Ok(out),
    }
}
