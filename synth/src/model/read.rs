//! Reading and writing files safely.

use std::fs;
use std::io::Write;
use std::path::Path;

use serde::de::DeserializeOwned;

use super::{FileError, Kind};

/// The largest file that is read [bytes].
pub const MAX_FILE_BYTES: u64 = 64 << 20;

/// Reads a whole text file of at most [`MAX_FILE_BYTES`].
pub fn read_text(path: &Path) -> Result<String, FileError> {
    let failed = |source| FileError::Io {
        action: "cannot be read",
        source,
    };
    let information = fs::metadata(path).map_err(failed)?;
    if information.is_dir() {
        return Err(failed(std::io::ErrorKind::IsADirectory.into()));
    }
    if information.len() > MAX_FILE_BYTES {
        return Err(FileError::TooLarge {
            bytes: information.len(),
            limit: MAX_FILE_BYTES,
        });
    }
    let bytes = fs::read(path).map_err(failed)?;
    String::from_utf8(bytes).map_err(|error| FileError::NotText {
        position: error.utf8_error().valid_up_to(),
    })
}

/// Writes a file under a temporary name beside it and renames it, so that it is either the old one
/// or the complete new one.
pub fn write_atomically(path: &Path, contents: &[u8]) -> Result<(), FileError> {
    let failed = |source| FileError::Io {
        action: "cannot be written",
        source,
    };
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(failed)?;
    file.write_all(contents).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    make_readable(file.path()).map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Temporary files are private; a result file is as readable as any other.
#[cfg(unix)]
fn make_readable(path: &Path) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn make_readable(_path: &Path) -> std::io::Result<()> {
    Ok(())
}

/// Parses JSON into `T`; errors name the field.
pub fn parse<T: DeserializeOwned>(text: &str, expected: Kind) -> Result<T, FileError> {
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let parsed = serde_path_to_error::deserialize(&mut deserializer);
    let value: T = parsed.map_err(|error| explain(text, expected, error))?;
    deserializer.end().map_err(|error| FileError::NotJson {
        reason: error.to_string(),
    })?;
    Ok(value)
}

fn explain(
    text: &str,
    expected: Kind,
    error: serde_path_to_error::Error<serde_json::Error>,
) -> FileError {
    let field = error.path().to_string();
    let inner = error.into_inner();
    if let Some(found) = kind_of(text).filter(|found| *found != expected) {
        return FileError::WrongKind { found, expected };
    }
    match (inner.classify(), field.as_str()) {
        (serde_json::error::Category::Data, "." | "") => FileError::Field {
            field: "(top level)".to_string(),
            reason: inner.to_string(),
        },
        (serde_json::error::Category::Data, _) => FileError::Field {
            field,
            reason: inner.to_string(),
        },
        (_, "." | "") => FileError::NotJson {
            reason: inner.to_string(),
        },
        _ => FileError::NotJson {
            reason: format!("{inner}, in field '{field}' (numbers must be finite decimals)"),
        },
    }
}

/// What a file is, told by keys that only its kind has; `None` when it is none of them.
pub fn kind_of(text: &str) -> Option<Kind> {
    let value: serde_json::Value = serde_json::from_str(text).ok()?;
    let keys = value.as_object()?;
    if keys.contains_key("certificate") {
        Some(Kind::Design)
    } else if keys.contains_key("duration_s") {
        Some(Kind::Scenario)
    } else if keys.contains_key("specs") {
        Some(Kind::Model)
    } else {
        None
    }
}
