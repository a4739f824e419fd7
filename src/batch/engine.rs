//! Many runs: the threads that make them, and when they stop.
//!
//! The runs of a [`Job`] are numbered from 0, and what a run comes to depends on its number only. So neither
//! the number of threads nor interruptions change what is kept. [`Threads::execute`] makes the runs that a
//! [`Store`] does not hold yet; [`Threads::collect`] makes a few whose results stay in memory.

use std::any::Any;
use std::panic::{catch_unwind, resume_unwind, AssertUnwindSafe};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::Arc;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

use super::store::Store;

/// What long work is watched and stopped by.
pub struct Control<'a> {
    /// Called after each run (each candidate of a search), from several threads.
    pub done: &'a (dyn Fn() + Sync),
    /// Set it to stop.
    pub stop: Arc<AtomicBool>,
}

/// The work was stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

impl Control<'_> {
    /// Goes on unless it was stopped.
    ///
    /// # Errors
    /// It was stopped.
    pub fn check(&self) -> Result<(), Interrupted> {
        check(&self.stop)
    }
}

/// Goes on unless `stop` is set.
///
/// # Errors
/// It is set.
pub fn check(stop: &AtomicBool) -> Result<(), Interrupted> {
    match stop.load(Ordering::Relaxed) {
        true => Err(Interrupted),
        false => Ok(()),
    }
}

/// Runs by number.
pub trait Job: Sync {
    /// What is kept of a run.
    type Record: Send;
    /// Why a run cannot be made.
    type Error: From<Interrupted> + Send;

    /// Makes a run.
    ///
    /// # Errors
    /// The run cannot be made, or was given up because `stop` was set.
    fn run(&self, index: u64, stop: &Arc<AtomicBool>) -> Result<Self::Record, Self::Error>;

    /// What is kept of a run at which the program itself failed with this message; `None` where that
    /// ends the program.
    fn failed(&self, _index: u64, _message: &str) -> Option<Self::Record> {
        None
    }
}

/// Threads that make runs.
pub struct Threads {
    pool: ThreadPool,
}

impl Threads {
    /// So many threads; 0 stands for one for each processor.
    ///
    /// # Errors
    /// They cannot be started.
    pub fn new(count: usize) -> Result<Self, ThreadPoolBuildError> {
        let pool = ThreadPoolBuilder::new().num_threads(count).build()?;
        Ok(Threads { pool })
    }

    /// Makes every run that the store does not hold and keeps it. Chunks that are begun are ended after a
    /// stop, unless the job gives its runs up.
    ///
    /// # Errors
    /// It was stopped; a run that cannot be made; records that cannot be kept. What was kept before stays.
    pub fn execute<J, S>(&self, job: &J, store: &S, control: &Control) -> Result<(), J::Error>
    where
        J: Job,
        S: Store<J::Record>,
        J::Error: From<S::Error>,
    {
        self.each(store.missing(), &control.stop, |chunk| {
            let run = |index| {
                let record = guarded(job, index, &control.stop)?;
                (control.done)();
                Ok::<_, J::Error>(record)
            };
            let records = chunk.clone().map(run).collect::<Result<Vec<_>, _>>()?;
            Ok(store.keep(chunk, records)?)
        })
    }

    /// Does something with every item, until the first error.
    ///
    /// # Errors
    /// It was stopped; the first error of an item.
    pub fn each<T: Send, E: From<Interrupted> + Send>(
        &self,
        items: Vec<T>,
        stop: &AtomicBool,
        one: impl Fn(T) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        self.pool.install(|| {
            items.into_par_iter().with_max_len(1).try_for_each(|item| {
                check(stop)?;
                one(item)
            })
        })
    }

    /// Makes so many runs; what is kept of them is in their order.
    ///
    /// # Errors
    /// It was stopped; the error of the first run that cannot be made.
    pub fn collect<J: Job>(
        &self,
        job: &J,
        count: usize,
        control: &Control,
    ) -> Result<Vec<J::Record>, J::Error> {
        let run = |index: usize| -> Result<J::Record, J::Error> {
            control.check()?;
            let record = guarded(job, index as u64, &control.stop)?;
            (control.done)();
            Ok(record)
        };
        let all = || (0..count).into_par_iter().with_max_len(1);
        let records: Vec<Result<J::Record, J::Error>> =
            self.pool.install(|| all().map(run).collect());
        records.into_iter().collect()
    }
}

/// Makes a run; a defect of the program that one run shows need not cost the others.
fn guarded<J: Job>(job: &J, index: u64, stop: &Arc<AtomicBool>) -> Result<J::Record, J::Error> {
    catch_unwind(AssertUnwindSafe(|| job.run(index, stop))).unwrap_or_else(|panic| {
        let record = job.failed(index, message(panic.as_ref()));
        record.map_or_else(|| resume_unwind(panic), Ok)
    })
}

fn message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("no message")
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;
    use std::ops::Range;
    use std::sync::Mutex;

    use super::*;

    struct Squares;

    impl From<Infallible> for Interrupted {
        fn from(never: Infallible) -> Self {
            match never {}
        }
    }

    impl Job for Squares {
        type Record = u64;
        type Error = Interrupted;

        fn run(&self, index: u64, stop: &Arc<AtomicBool>) -> Result<u64, Interrupted> {
            match index {
                5 => stop.store(true, Ordering::Relaxed),
                3 => panic!("three"),
                _ => {}
            }
            Ok(index * index)
        }

        fn failed(&self, _index: u64, message: &str) -> Option<u64> {
            assert_eq!(message, "three");
            Some(0)
        }
    }

    type Chunk = (Range<u64>, Vec<u64>);

    #[derive(Default)]
    struct Memory {
        end: u64,
        kept: Mutex<Vec<Chunk>>,
    }

    impl Store<u64> for Memory {
        type Error = Infallible;

        fn missing(&self) -> Vec<Range<u64>> {
            (0..self.end).step_by(2).map(|at| at..at + 2).collect()
        }

        fn keep(&self, chunk: Range<u64>, records: Vec<u64>) -> Result<(), Infallible> {
            self.kept.lock().unwrap().push((chunk, records));
            Ok(())
        }
    }

    fn executed(end: u64) -> (Result<(), Interrupted>, Vec<Chunk>) {
        let store = Memory {
            end,
            ..Memory::default()
        };
        let control = Control {
            done: &|| {},
            stop: Arc::default(),
        };
        let threads = Threads::new(1).unwrap();
        let ended = threads.execute(&Squares, &store, &control);
        (ended, store.kept.into_inner().unwrap())
    }

    #[test]
    fn a_run_that_fails_costs_no_other() {
        let (ended, mut kept) = executed(4);
        kept.sort_by_key(|(chunk, _)| chunk.start);
        assert_eq!(ended, Ok(()));
        assert_eq!(kept, [(0..2, vec![0, 1]), (2..4, vec![4, 0])]);
    }

    #[test]
    fn a_chunk_that_is_begun_is_ended_and_none_is_begun_after_a_stop() {
        let (ended, kept) = executed(1000);
        assert_eq!(ended, Err(Interrupted));
        assert!(kept.contains(&(4..6, vec![16, 25])), "{kept:?}");
        assert!(kept.len() < 500);
    }
}
