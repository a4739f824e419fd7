//! Work split in two, by the problem and never by the threads: sums are the same however many threads there are.

/// Runs both, side by side where two threads may be used.
pub fn both<A: Send, B: Send>(
    threads: usize,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if threads > 1 {
        rayon::join(first, second)
    } else {
        (first(), second())
    }
}
