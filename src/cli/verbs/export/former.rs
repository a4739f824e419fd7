//! Flight code that an earlier export left in a folder, by its list of digests.

use std::path::Path;

use crate::base::files::OutputError;
use crate::base::provenance::sha256_of;
use crate::cli::contents::Contents;
use crate::cli::error::CliError;
use crate::export::flight::package::{Package, DIGESTS};

/// What the list says.
pub struct Former {
    /// The list's first line.
    title: String,
    /// Names with their digests.
    listed: Vec<(String, String)>,
}

impl Former {
    /// What a folder holds; nothing where there is no list.
    pub fn in_folder(folder: &Path) -> Self {
        let list = folder.join(DIGESTS);
        let is_list = is_ordinary(&list) && Contents::FlightCode.stands_in(&list);
        let text = match is_list {
            true => std::fs::read_to_string(list).unwrap_or_default(),
            false => String::new(),
        };
        let listed = text.lines().filter_map(|line| {
            let (digest, name) = line.split_once("  ")?;
            let is_plain = !name.contains(['/', '\\']) && !name.starts_with('.');
            (is_plain && !line.starts_with('#')).then(|| (name.to_string(), digest.to_string()))
        });
        Former {
            title: text.lines().next().unwrap_or_default().to_string(),
            listed: listed.collect(),
        }
    }

    /// Refuses, before anything is written, a folder in which a link or something else that is no file stands where a file is
    /// to be written. Without `force` also the code of another controller, and a file that differs from what is to be written
    /// and from what the list says: somebody has edited it.
    pub fn check(&self, folder: &Path, package: &Package, force: bool) -> Result<(), CliError> {
        for file in &package.files {
            let path = folder.join(&file.name);
            if path.symlink_metadata().is_ok() && !is_ordinary(&path) {
                let reason =
                    "this is a link or no ordinary file; a file of this name is to be written";
                return Err(CliError::unsuitable(&path, reason));
            }
        }
        if force {
            return Ok(());
        }
        if let Some(other) = self.other_controller(package) {
            let reason = format!(
                "holds the flight code of another controller, {other}; choose another folder, or give --force to replace it"
            );
            return Err(CliError::unsuitable(folder, reason));
        }
        for file in package.files.iter().filter(|file| file.name != DIGESTS) {
            let path = folder.join(&file.name);
            let there = path.exists().then(|| std::fs::read_to_string(&path));
            let lost = there.is_some_and(|there| {
                !there.is_ok_and(|there| there == file.text || self.wrote(&file.name, &there))
            });
            if lost {
                let reason = format!(
                    "was edited since it was exported, or is not in {DIGESTS}; move it, or give --force to replace it"
                );
                return Err(CliError::unsuitable(&path, reason));
            }
        }
        Ok(())
    }

    /// Removes what the former export wrote, nobody has edited, and the new one does not have. The names of edited ones,
    /// which stay.
    pub fn remove_others(&self, folder: &Path, package: &Package) -> Result<Vec<String>, CliError> {
        let mut kept = Vec::new();
        let others = self.listed.iter();
        for (name, _) in others.filter(|(name, _)| package.text_of(name).is_none()) {
            let path = folder.join(name);
            if !is_ordinary(&path) {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap_or_default();
            if self.wrote(name, &text) && Contents::FlightCode.is_in(&path) {
                std::fs::remove_file(&path)
                    .map_err(|error| OutputError::io(&path, "cannot be removed", error))?;
            } else {
                kept.push(name.clone());
            }
        }
        Ok(kept)
    }

    /// Whether the list says that a text was written under a name.
    fn wrote(&self, name: &str, text: &str) -> bool {
        let listed = self.listed.iter().find(|(own, _)| own == name);
        listed.is_some_and(|(_, digest)| *digest == sha256_of(text))
    }

    /// What the list belongs to, where that is another controller.
    fn other_controller(&self, package: &Package) -> Option<String> {
        let own = package.text_of(DIGESTS).and_then(controller_in);
        let listed = controller_in(&self.title)?;
        (own != Some(listed)).then(|| listed.to_string())
    }
}

/// The controller that the first line of a list names.
fn controller_in(line: &str) -> Option<&str> {
    let (_, rest) = line.split_once("controller '")?;
    rest.split_once("',").map(|(name, _)| name)
}

/// Whether a path is a file itself, not a link to one.
fn is_ordinary(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|about| about.is_file())
}
