//! What is done of many runs, on disk: work that was ended goes on from it.
//!
//! A store holds chunks of runs, each whole or absent. There are two: a sweep appends a line to a
//! [`journal::Journal`] for each point, so that one point is lost at most, and reads all of them at the end; a
//! campaign writes a table for each chunk of runs ([`chunks::Chunks`]), because millions of runs fit in no
//! journal that is read as a whole, and because shards on several machines are made of whole chunks. What
//! both need is here too: a folder holds one piece of work ([`identity`]), and one process works on it
//! ([`lock`]).

pub mod chunks;
pub mod identity;
pub mod journal;
pub mod lock;

use std::ops::Range;

/// Keeps the records of runs in chunks.
pub trait Store<R>: Sync {
    /// Why records cannot be kept.
    type Error;

    /// The chunks that are not kept yet, in their order.
    fn missing(&self) -> Vec<Range<u64>>;

    /// Keeps the records of one chunk, in the order of its runs.
    ///
    /// # Errors
    /// They cannot be written.
    fn keep(&self, chunk: Range<u64>, records: Vec<R>) -> Result<(), Self::Error>;
}
