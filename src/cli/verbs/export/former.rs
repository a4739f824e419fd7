//! Flight code that an earlier export left in a folder, by its list of digests.

use std::path::Path;

use crate::base::files::OutputError;
use crate::base::provenance::sha256_of;
use crate::cli::contents::Contents;
use crate::cli::error::CliError;
use crate::export::flight::package::{Package, DIGESTS};

/// The files that the list names, as far as they are there.
pub struct Former {
    files: Vec<FormerFile>,
}

struct FormerFile {
    name: String,
    /// Whether it is as it was written.
    kept: bool,
}

impl Former {
    /// What a folder holds; nothing where there is no list.
    pub fn in_folder(folder: &Path) -> Self {
        let list = folder.join(DIGESTS);
        let text = match Contents::FlightCode.stands_in(&list) {
            true => std::fs::read_to_string(list).unwrap_or_default(),
            false => String::new(),
        };
        let files = text.lines().filter_map(|line| {
            let (digest, name) = line.split_once("  ")?;
            let is_plain = !name.contains(['/', '\\']) && !name.starts_with('.');
            let path = folder.join(name);
            let own = is_plain && !line.starts_with('#') && path.is_file();
            own.then(|| FormerFile {
                name: name.to_string(),
                kept: std::fs::read_to_string(path).is_ok_and(|text| sha256_of(&text) == digest),
            })
        });
        Former {
            files: files.collect(),
        }
    }

    /// Refuses to write over the code of another controller, or over a file that somebody has edited.
    pub fn check(&self, folder: &Path, package: &Package) -> Result<(), CliError> {
        let header = self
            .files
            .iter()
            .find(|file| file.name.ends_with("_vectors.h"));
        if let Some(other) = header.filter(|file| package.text_of(&file.name).is_none()) {
            let controller = other.name.trim_end_matches("_vectors.h");
            let reason = format!(
                "holds the flight code of another controller, {controller}; choose another folder, or give --force to replace it"
            );
            return Err(CliError::unsuitable(folder, reason));
        }
        let edited = self.files.iter().filter(|file| !file.kept);
        for file in edited {
            let path = folder.join(&file.name);
            let lost = package.text_of(&file.name).is_some_and(|text| {
                std::fs::read_to_string(&path).map_or(true, |there| there != text)
            });
            if lost {
                let reason =
                    "was edited since it was exported; move it, or give --force to replace it";
                return Err(CliError::unsuitable(&path, reason));
            }
        }
        Ok(())
    }

    /// Removes what the former export wrote, nobody has edited, and the new one does not have.
    pub fn remove_others(&self, folder: &Path, package: &Package) -> Result<(), CliError> {
        let stale = self.files.iter().filter(|file| file.kept);
        for file in stale.filter(|file| package.text_of(&file.name).is_none()) {
            let path = folder.join(&file.name);
            std::fs::remove_file(&path)
                .map_err(|error| OutputError::io(&path, "cannot be removed", error))?;
        }
        Ok(())
    }
}
