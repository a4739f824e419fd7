//! Links only if no panic can be reached from the controllers: the panic handler calls a function
//! that does not exist, and the linker finds out unless the optimiser has removed every call of it.
#![no_std]
#![no_main]

use core::panic::PanicInfo;

// Program start and memcpy; a program without std is linked without them.
#[link(name = "c")]
unsafe extern "C" {}

unsafe extern "C" {
    safe fn panic_code_is_linked() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    panic_code_is_linked()
}

/// Exit status 0 when the controllers command some torque within their limits, a codec holds some, and values arrive.
///
/// With the feature `control-panic` one assertion is in, and the link must fail: the check can fail.
#[no_mangle]
pub extern "C" fn main() -> i32 {
    #[cfg(feature = "control-panic")]
    assert!(core::hint::black_box(true));
    let torque = no_std_check::exercise_controllers();
    let number = no_std_check::exercise_algebra();
    let held = no_std_check::exercise_compression();
    let values = no_std_check::exercise_repeats();
    match (torque, number, held) {
        (Ok(torque), Ok(number), Ok(held))
            if torque > 0.0 && torque <= 2.0 && number.is_finite() && held > 0.0 && values > 0 =>
        {
            0
        }
        (Ok(_), Ok(_), Ok(_)) => 1,
        _ => 2,
    }
}
