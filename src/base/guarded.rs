//! Readers of other crates that panic on some damaged files: what they panic on is refused like any other damaged file.

use std::cell::Cell;
use std::panic::{catch_unwind, set_hook, take_hook, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

static QUIET: Once = Once::new();

/// Runs a reader; `None`, and no words on standard error, where it panics.
pub fn guarded<T>(read: impl FnOnce() -> T) -> Option<T> {
    QUIET.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |info| {
            if !GUARDED.get() {
                before(info);
            }
        }));
    });
    let outer = GUARDED.replace(true);
    // Whatever the reader holds is given up with it.
    let read = catch_unwind(AssertUnwindSafe(read));
    GUARDED.set(outer);
    read.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_panics_gives_nothing_and_what_does_not_its_value() {
        assert_eq!(guarded(|| 3), Some(3));
        let empty: [u8; 0] = [];
        let index = std::hint::black_box(2);
        assert_eq!(guarded(|| empty[index]), None);
        assert!(!GUARDED.get());
    }
}
