//! Reports the progress of a search to an observer, which may stop it.

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use crate::programs::Cancelled;
use sdp::solve::{Observer, Progress};

/// Shows the search's own progress in the place of its solvers'.
pub struct SearchProgress {
    observer: Option<Observer>,
    cancelled: Arc<AtomicBool>,
    shown: Arc<Mutex<Progress>>,
    solves: AtomicU32,
}

impl SearchProgress {
    /// Progress for an observer, which is called between a solver's iterations.
    pub fn new(observer: Option<Observer>) -> Self {
        SearchProgress {
            observer,
            cancelled: Arc::default(),
            shown: Arc::new(Mutex::new(Progress {
                iteration: 0,
                objective: f64::NAN,
                relative_gap: 1.0,
            })),
            solves: AtomicU32::new(0),
        }
    }

    /// The observer for a solver.
    pub fn evaluator(&self) -> Observer {
        let outer = self.observer.clone();
        let (cancelled, shown) = (Arc::clone(&self.cancelled), Arc::clone(&self.shown));
        Arc::new(move |_| {
            let progress = *shown.lock().unwrap_or_else(PoisonError::into_inner);
            let go_on = outer.as_ref().is_none_or(|observer| observer(&progress));
            if !go_on {
                cancelled.store(true, Ordering::Relaxed);
            }
            go_on && !cancelled.load(Ordering::Relaxed)
        })
    }

    /// Counts a program; an error when the observer stopped it.
    pub fn solved(&self) -> Result<(), Cancelled> {
        self.solves.fetch_add(1, Ordering::Relaxed);
        match self.cancelled.load(Ordering::Relaxed) {
            true => Err(Cancelled),
            false => Ok(()),
        }
    }

    /// A new best value; `increase` is how much better it is, relative.
    pub fn reached(&self, objective: f64, increase: f64) {
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        *shown = Progress {
            iteration: self.count(),
            objective,
            relative_gap: increase,
        };
    }

    /// Continues from an earlier count.
    pub fn restart(&self, count: u32) {
        self.solves.store(count, Ordering::Relaxed);
    }

    /// Programs solved so far.
    pub fn count(&self) -> u32 {
        self.solves.load(Ordering::Relaxed)
    }
}
