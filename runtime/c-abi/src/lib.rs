//! The controllers of the runtime crate as functions of C. `include/steadfast.h` is their description, kept by hand; the
//! sizes in it are checked here when this is compiled.
//!
//! References take the place of pointers: null is `None`, and no code here is unsafe but for the names of the symbols.
#![no_std]
#![deny(unsafe_code)]

mod parameters;
mod symbols;

use core::panic::PanicInfo;

/// Nothing panics: this is needed to link, and never runs.
#[panic_handler]
fn never(_: &PanicInfo) -> ! {
    loop {}
}
