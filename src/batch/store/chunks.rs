//! Runs in chunks of fixed size, and shards of whole chunks.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// A part of some work, for one of several machines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shard {
    /// Which, from 1.
    pub index: u64,
    /// Of how many.
    pub count: u64,
}

/// The division of runs into chunks, which depends on nothing but the work: what was done before an
/// interruption counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Chunks {
    size: u64,
    runs: u64,
}

/// More shards than chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the campaign can be divided into at most {most} shards; {shards} are asked for")]
pub struct TooManyShards {
    /// Shards that are asked for.
    pub shards: u64,
    /// Most.
    pub most: u64,
}

impl Chunks {
    /// So many runs in chunks of a size, which is above 0; the last one may be smaller.
    pub fn new(runs: u64, size: u64) -> Self {
        Chunks { size, runs }
    }

    /// Their number.
    pub fn count(&self) -> u64 {
        self.runs.div_ceil(self.size)
    }

    /// The number of the chunk that holds a run.
    pub fn holding(&self, run: u64) -> u64 {
        run / self.size
    }

    /// The runs of a chunk.
    pub fn runs_of(&self, chunk: u64) -> Range<u64> {
        let end = ((chunk + 1) * self.size).min(self.runs);
        chunk * self.size..end
    }

    /// The chunks of a shard; all without one.
    ///
    /// # Errors
    /// More shards than chunks.
    pub fn of_shard(&self, shard: Option<Shard>) -> Result<Range<u64>, TooManyShards> {
        let most = self.count();
        let Some(Shard { index, count }) = shard else {
            return Ok(0..most);
        };
        if count > most {
            let shards = count;
            return Err(TooManyShards { shards, most });
        }
        let start = |index: u64| (u128::from(index) * u128::from(most) / u128::from(count)) as u64;
        Ok(start(index - 1)..start(index))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_whole_chunks_without_gap_or_overlap() {
        for (runs, size, count) in [(10, 1, 3), (1000, 4, 7), (100_000, 391, 256), (5, 5, 1)] {
            let chunks = Chunks::new(runs, size);
            let mut next = 0;
            for index in 1..=count {
                let shard = Shard { index, count };
                for chunk in chunks.of_shard(Some(shard)).expect("a shard") {
                    let own = chunks.runs_of(chunk);
                    assert_eq!(own.start, next);
                    assert_eq!(chunks.holding(own.start), chunk);
                    assert!(own.end > own.start);
                    next = own.end;
                }
            }
            assert_eq!(next, runs);
        }
    }
}
