//! Formats every error message without std and without an allocator. The formatting of numbers in
//! `core` contains panic code, so this program has an ordinary panic handler.
#![no_std]
#![no_main]

use core::fmt::Write;
use core::hint::black_box;
use core::panic::PanicInfo;

use runtime::command::HoldReason;
use runtime::compression::Refusal;
use runtime::nalgebra::Vector3;
use runtime::saturation::Saturation;

// Program start and memcpy; a program without std is linked without them.
#[link(name = "c")]
unsafe extern "C" {}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

/// Counts what is written to it.
struct Length(usize);

impl Write for Length {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        self.0 += text.len();
        Ok(())
    }
}

/// Exit status 0 when the messages are not empty.
#[no_mangle]
pub extern "C" fn main() -> i32 {
    let mut written = Length(0);
    let reason = black_box(HoldReason::TimeNotIncreasing {
        last_s: 2.0,
        time_s: 1.0,
    });
    let refusal = black_box(Refusal::OutOfLimits { torque: 1.0 });
    let refused = Saturation::new(black_box(Vector3::repeat(-1.0)));
    let outcome = match &refused {
        Ok(_) => return 1,
        Err(error) => write!(written, "{error} {reason} {refusal}"),
    };
    i32::from(outcome.is_err() || written.0 < 40)
}
