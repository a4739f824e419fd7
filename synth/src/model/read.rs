//! Reading and writing files safely.

use std::fs;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::Serialize;

use super::explain::{explain, list_for_object};
use super::vanishing::first_vanishing;
use super::{FileError, Kind};

/// The largest file that is read (bytes).
pub const MAX_FILE_BYTES: u64 = 16 << 20;

/// Reads a whole text file of at most [`MAX_FILE_BYTES`].
pub fn read_text(path: &Path) -> Result<String, FileError> {
    read_text_up_to(path, MAX_FILE_BYTES)
}

/// Reads a whole text file of at most `limit` bytes.
pub fn read_text_up_to(path: &Path, limit: u64) -> Result<String, FileError> {
    let bytes = read_bytes_up_to(path, limit)?;
    String::from_utf8(bytes).map_err(|error| FileError::NotText {
        position: error.utf8_error().valid_up_to(),
    })
}

/// Reads a file of at most `limit` bytes.
pub fn read_bytes_up_to(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let failed = |source| FileError::Io {
        action: "cannot be read",
        source,
    };
    let file = fs::File::open(path).map_err(failed)?;
    let information = file.metadata().map_err(failed)?;
    if information.is_dir() {
        return Err(failed(std::io::ErrorKind::IsADirectory.into()));
    }
    let too_large = |bytes| FileError::TooLarge { bytes, limit };
    if information.len() > limit {
        return Err(too_large(information.len()));
    }
    // A pipe or a device does not report its length.
    let mut bytes = Vec::new();
    file.take(limit + 1)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > limit {
        return Err(too_large(limit + 1));
    }
    Ok(bytes)
}

/// Writes a file under a temporary name beside it and renames it, so that it is either the old one
/// or the complete new one. A link is followed; devices and pipes are refused.
pub fn write_atomically(path: &Path, contents: &[u8]) -> Result<(), FileError> {
    let failed = |source| FileError::Io {
        action: "cannot be written",
        source,
    };
    let path = ordinary_file(path).map_err(failed)?;
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut file = new_in(folder).map_err(failed)?;
    let written = file.write_all(contents).map_err(without_path);
    written.map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    make_readable(file.path()).map_err(failed)?;
    file.persist(&path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// A new file in a folder, under a temporary name that no error tells.
///
/// # Errors
/// The system's.
pub fn new_in(folder: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    tempfile::NamedTempFile::new_in(folder).map_err(without_path)
}

/// Whether a name is a temporary one, which a process that was killed leaves behind.
pub fn is_temporary(name: &str) -> bool {
    let rest = name.strip_prefix(".tmp").unwrap_or("");
    rest.len() == 6 && rest.bytes().all(|byte| byte.is_ascii_alphanumeric())
}

/// The system's reason without the temporary name.
fn without_path(error: std::io::Error) -> std::io::Error {
    match error.to_string().split_once(" at path ") {
        Some((reason, _)) => std::io::Error::new(error.kind(), reason.to_string()),
        None => error,
    }
}

/// Gives a new file the permissions of any other result: temporary files are private.
///
/// # Errors
/// The system's.
#[cfg(unix)]
pub fn make_readable(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

/// Nothing: only Unix makes temporary files private.
///
/// # Errors
/// None.
#[cfg(not(unix))]
pub fn make_readable(_path: &Path) -> std::io::Result<()> {
    Ok(())
}

/// The file that a path stands for: itself, or where its link leads. Renaming over a device such as
/// `/dev/null` would replace it.
fn ordinary_file(path: &Path) -> std::io::Result<PathBuf> {
    let Ok(information) = fs::symlink_metadata(path) else {
        return Ok(path.to_path_buf());
    };
    let target = match information.is_symlink() {
        true => fs::canonicalize(path)?,
        false => path.to_path_buf(),
    };
    if fs::metadata(&target)?.is_file() {
        return Ok(target);
    }
    Err(std::io::Error::other("it is not an ordinary file"))
}

/// Parses JSON into `T`; errors name the field.
pub fn parse<T: DeserializeOwned + Serialize>(text: &str, expected: Kind) -> Result<T, FileError> {
    if text.starts_with('\u{feff}') {
        return Err(FileError::ByteOrderMark);
    }
    let list_expected_object = |field| FileError::Field {
        field,
        reason: "found a list, expected an object with named fields".to_string(),
    };
    if text.trim_start().starts_with('[') {
        return Err(list_expected_object("(top level)".to_string()));
    }
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let parsed = serde_path_to_error::deserialize(&mut deserializer);
    let value: T = parsed.map_err(|error| explain(text, expected, error))?;
    deserializer.end().map_err(|error| FileError::NotJson {
        reason: error.to_string(),
    })?;
    if let Some(field) = list_for_object(text, &value) {
        return Err(list_expected_object(field));
    }
    match first_vanishing(text) {
        Some(number) => Err(number.into()),
        None => Ok(value),
    }
}
