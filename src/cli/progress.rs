//! Progress of long work on a terminal, and its cancellation by Ctrl-C.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use synth::solve::{Observer, Progress};
use synth::synthesis::SynthesisError;

use super::answer::complain;
use super::error::CliError;
use crate::base::files::what_was_written;
use crate::batch::engine::{Control, Threads};

/// Threads for `--jobs`; one for each processor when left out.
pub(crate) fn threads(jobs: Option<u16>) -> Result<Threads, CliError> {
    Threads::new(jobs.map_or(0, usize::from)).map_err(|error| CliError::Argument {
        argument: "--jobs",
        reason: error.to_string(),
    })
}

/// The first words of the progress of a synthesis.
pub(crate) const ASSEMBLING: &str = "assembling the conditions";

/// Runs a solver for a model file and shows its progress, at first with these words.
pub(crate) fn solve<T>(
    model: &Path,
    what: &str,
    run: impl FnOnce(Option<Observer>) -> Result<T, SynthesisError>,
) -> Result<T, CliError> {
    let found = watched(what, |observer| run(Some(observer)));
    found.map_err(|error| CliError::synthesis(model, error))
}

/// As [`solve`], for work in parts: it may say where it stands, which is shown before the solver's own progress.
pub(crate) fn solve_in_parts<T>(
    model: &Path,
    run: impl FnOnce(Option<Observer>, &(dyn Fn(String) + Sync)) -> Result<T, SynthesisError>,
) -> Result<T, CliError> {
    let found = watched_in_parts(ASSEMBLING, |observer, stands| run(Some(observer), stands));
    found.map_err(|error| CliError::synthesis(model, error))
}

/// Runs a solver with a spinner on standard error when that is a terminal, nothing otherwise; Ctrl-C stops it.
pub(crate) fn watched<T>(what: &str, run: impl FnOnce(Observer) -> T) -> T {
    watched_in_parts(what, |observer, _| run(observer))
}

fn watched_in_parts<T>(what: &str, run: impl FnOnce(Observer, &(dyn Fn(String) + Sync)) -> T) -> T {
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed} {prefix}{msg}") {
        bar.set_style(style);
    }
    bar.set_message(what.to_string());
    bar.enable_steady_tick(Duration::from_millis(100));
    let (shown, interrupted) = (bar.clone(), interrupted());
    let observer = Arc::new(move |progress: &Progress| {
        shown.set_message(format!(
            "iteration {}, objective {:.6e}, gap {:.1e}",
            progress.iteration, progress.objective, progress.relative_gap
        ));
        !interrupted.load(Ordering::Relaxed)
    });
    let result = run(observer, &|stands| bar.set_prefix(format!("{stands}; ")));
    bar.finish_and_clear();
    result
}

/// Shows a line on a terminal, nothing otherwise.
pub(crate) fn ahead(line: &str) {
    let bar = ProgressBar::new_spinner();
    bar.println(line);
    bar.finish_and_clear();
}

/// Set by Ctrl-C, for the whole process: a signal handler can be installed once only.
static INTERRUPTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// Set by Ctrl-C, from the first call on.
pub fn interrupted() -> Arc<AtomicBool> {
    WATCHED.store(true, Ordering::Relaxed);
    install()
}

fn install() -> Arc<AtomicBool> {
    let install = || {
        let flag = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&flag);
        // Without a handler Ctrl-C ends the process at once, which is safe too.
        let _ = ctrlc::set_handler(move || {
            // The second time the user does not want to wait for the part in work. Files are renamed
            // into place when they are whole, so none is left half written.
            if seen.swap(true, Ordering::Relaxed) || !WATCHED.load(Ordering::Relaxed) {
                complain(&format!("interrupted; {}", what_was_written()));
                std::process::exit(1);
            }
        });
        flag
    };
    Arc::clone(INTERRUPTED.get_or_init(install))
}

/// Whether some work looks at the flag. Until then Ctrl-C ends the process at once.
static WATCHED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C say what is on the disk, in every verb.
pub(super) fn watch_for_interruption() {
    install();
}

/// A bar over the parts of long work on standard error when that is a terminal, nothing otherwise.
pub struct PartsProgress {
    bar: ProgressBar,
    interrupted: Arc<AtomicBool>,
}

impl PartsProgress {
    /// Starts showing `count` parts of what is named, such as "points".
    pub fn start(count: usize, what: &str) -> Self {
        PartsProgress::resume(0, count, what)
    }

    /// Starts showing `count` parts of which some were done before.
    pub fn resume(done: usize, count: usize, what: &str) -> Self {
        let bar = ProgressBar::new(count as u64).with_position(done as u64);
        bar.reset_eta();
        let template = "{elapsed} [{bar:40}] {pos}/{len} {msg}, {per_sec}, {eta} left";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.set_message(what.to_string());
        bar.enable_steady_tick(Duration::from_millis(200));
        PartsProgress {
            bar,
            interrupted: interrupted(),
        }
    }

    /// One part more is done.
    pub fn done(&self) {
        self.bar.inc(1);
    }

    /// Set by Ctrl-C.
    pub fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.interrupted)
    }

    /// What work is watched and stopped by that calls `done` for each part.
    pub fn control<'a>(&self, done: &'a (dyn Fn() + Sync)) -> Control<'a> {
        Control {
            done,
            stop: self.stop(),
        }
    }
}

impl Drop for PartsProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
