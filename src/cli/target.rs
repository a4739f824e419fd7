//! Where results go: the rule for what may be replaced, and the trial before any long work.
//!
//! A result replaces a file of its own kind, such as a design a design, and nothing else: a file of another kind, or
//! one that is not recognised, is left as it is unless `--force` is given. An input is never replaced.

use std::path::{Path, PathBuf};

use synth::model::new_in;

use super::contents::{found, Contents};
use super::error::CliError;
use crate::base::files::OutputError;

/// What a verb may do to the files that it writes.
#[derive(Debug, Clone, Copy)]
pub struct Targets<'a> {
    /// Files that must stay.
    pub inputs: &'a [&'a Path],
    /// Whether files of another kind are replaced too.
    pub force: bool,
}

impl Targets<'_> {
    /// Refuses an output file that cannot be written, that is an input, or that holds something of another kind.
    pub fn check_file(&self, path: Option<&Path>, contents: Contents) -> Result<(), CliError> {
        let Some(path) = path else {
            return Ok(());
        };
        let refuse = |reason: &str| Err(CliError::unsuitable(path, reason));
        let folder = folder_of(path);
        if path.is_dir() {
            return refuse("this is a folder; a file name is needed");
        }
        if let Some(file) = folder.ancestors().find(|place| place.is_file()) {
            let reason = format!(
                "cannot be written: {} is a file, not a folder",
                file.display()
            );
            return Err(CliError::unsuitable(path, reason));
        }
        if !folder.is_dir() {
            return refuse("cannot be written: its folder does not exist");
        }
        if path.exists() && !path.is_file() {
            return refuse("cannot be written: it is not an ordinary file");
        }
        self.check_kept(path, contents)?;
        try_to_write(path, folder)
    }

    /// Refuses an output folder that is something else, that cannot be written, or in which one of the files to be
    /// written there holds something of another kind.
    pub fn check_folder(
        &self,
        folder: Option<&Path>,
        files: &[(&str, Contents)],
    ) -> Result<(), CliError> {
        let Some(folder) = folder else {
            return Ok(());
        };
        let there = folder.ancestors().find(|place| place.exists());
        let there = there.unwrap_or(Path::new("."));
        if !there.is_dir() {
            let reason = match there == folder {
                true => "this is a file; a folder is needed".to_string(),
                false => format!("cannot be created: {} is a file", there.display()),
            };
            return Err(CliError::unsuitable(folder, reason));
        }
        for (name, contents) in files {
            let path = folder.join(name);
            if path.is_dir() {
                let reason = "this is a folder; a file of this name is to be written";
                return Err(CliError::unsuitable(&path, reason));
            }
            self.check_kept(&path, *contents)?;
        }
        try_to_write(folder, there)
    }

    /// Refuses a folder that holds another piece of work, which this file in it tells: its page would be replaced.
    pub fn check_no_other(
        &self,
        folder: Option<&Path>,
        (name, contents): (&str, Contents),
        what: &str,
    ) -> Result<(), CliError> {
        let there = folder.map(|folder| (folder, folder.join(name)));
        match there {
            Some((folder, file)) if !self.force && contents.stands_in(&file) => {
                let reason = format!(
                    "holds {what}; choose another folder, or give --force to write into it all the same"
                );
                Err(CliError::unsuitable(folder, reason))
            }
            _ => Ok(()),
        }
    }

    /// Refuses a folder of parts of the result that is a link, or that has an entry which is none of them.
    pub fn check_parts(
        &self,
        folder: &Path,
        is_own: impl Fn(&str) -> bool,
    ) -> Result<(), CliError> {
        let refuse = |reason: String| Err(CliError::unsuitable(folder, reason));
        let Ok(about) = folder.symlink_metadata() else {
            return Ok(());
        };
        if about.is_symlink() {
            return refuse("this is a link; a folder of this name is to be written".to_string());
        }
        if !about.is_dir() {
            return refuse("this is a file; a folder of this name is to be written".to_string());
        }
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        let mut names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
        match names.find(|name| !is_own(name)) {
            Some(name) if !self.force => refuse(format!(
                "holds {name}, which is not of this work; choose another folder for the results, or give --force to \
                 leave it where it is"
            )),
            _ => Ok(()),
        }
    }

    /// Refuses to replace an input, or a file of another kind.
    fn check_kept(&self, path: &Path, contents: Contents) -> Result<(), CliError> {
        let real = |path: &Path| path.canonicalize().ok();
        let own = real(path);
        if own.is_some() && self.inputs.iter().any(|input| real(input) == own) {
            let reason = "this is the input; it would be overwritten";
            return Err(CliError::unsuitable(path, reason));
        }
        if self.force || !path.exists() || contents.is_in(path) {
            return Ok(());
        }
        let reason = format!(
            "holds {}, where {} would be written; choose another name, or give --force to replace it",
            found(path),
            contents.name()
        );
        Err(CliError::unsuitable(path, reason))
    }
}

/// The folder of a file.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Makes and removes a file in a folder, so that one that cannot be written is known before any work.
fn try_to_write(path: &Path, folder: &Path) -> Result<(), CliError> {
    let folder = match folder.as_os_str().is_empty() {
        true => PathBuf::from("."),
        false => folder.to_path_buf(),
    };
    let made = new_in(&folder).map(drop);
    made.map_err(|error| OutputError::io(path, "cannot be written", error).into())
}
