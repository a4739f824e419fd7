//! The symbols that C links with. The names are the only thing that is unsafe here: another library may have the same.
#![allow(unsafe_code)]

use core::mem::{align_of, size_of, MaybeUninit};

use runtime::wu2018;

use crate::parameters::{
    measurement, CommandOfC, Wu2018Parameters, Xu2020Controller, Xu2020Parameters, BAD_PARAMETERS,
    NULL_POINTER,
};

/// Words of `steadfast_xu2020` and `steadfast_wu2018`.
const XU2020_WORDS: usize = 100;
const WU2018_WORDS: usize = 40;

const _: () = assert!(size_of::<Xu2020Controller>() <= 8 * XU2020_WORDS);
const _: () = assert!(size_of::<wu2018::Controller>() <= 8 * WU2018_WORDS);
const _: () = assert!(align_of::<Xu2020Controller>() <= 8 && align_of::<wu2018::Controller>() <= 8);

/// See the header.
#[no_mangle]
pub extern "C" fn steadfast_xu2020_init(
    controller: Option<&mut MaybeUninit<Xu2020Controller>>,
    parameters: Option<&Xu2020Parameters>,
) -> i32 {
    let (Some(place), Some(parameters)) = (controller, parameters) else {
        return NULL_POINTER;
    };
    match parameters.controller() {
        Ok(made) => {
            place.write(made);
            0
        }
        Err(_) => BAD_PARAMETERS,
    }
}

/// See the header.
#[no_mangle]
pub extern "C" fn steadfast_xu2020_step(
    controller: Option<&mut Xu2020Controller>,
    time_s: f64,
    error_quaternion: Option<&[f64; 4]>,
    rate_rad_s: Option<&[f64; 3]>,
    out: Option<&mut CommandOfC>,
) -> i32 {
    let (Some(controller), Some(error), Some(rate), Some(out)) =
        (controller, error_quaternion, rate_rad_s, out)
    else {
        return NULL_POINTER;
    };
    let state = measurement(error, rate).checked_state();
    *out = CommandOfC::of(&controller.step_measured(time_s, state));
    out.status()
}

/// See the header.
#[no_mangle]
pub extern "C" fn steadfast_xu2020_reset(controller: Option<&mut Xu2020Controller>) -> i32 {
    controller.map_or(NULL_POINTER, |controller| {
        controller.reset();
        0
    })
}

/// See the header.
#[no_mangle]
pub extern "C" fn steadfast_wu2018_init(
    controller: Option<&mut MaybeUninit<wu2018::Controller>>,
    parameters: Option<&Wu2018Parameters>,
) -> i32 {
    let (Some(place), Some(parameters)) = (controller, parameters) else {
        return NULL_POINTER;
    };
    match parameters.controller() {
        Ok(made) => {
            place.write(made);
            0
        }
        Err(_) => BAD_PARAMETERS,
    }
}

/// See the header.
#[no_mangle]
pub extern "C" fn steadfast_wu2018_step(
    controller: Option<&mut wu2018::Controller>,
    time_s: f64,
    error_quaternion: Option<&[f64; 4]>,
    rate_rad_s: Option<&[f64; 3]>,
    out: Option<&mut CommandOfC>,
) -> i32 {
    let (Some(controller), Some(error), Some(rate), Some(out)) =
        (controller, error_quaternion, rate_rad_s, out)
    else {
        return NULL_POINTER;
    };
    *out = CommandOfC::of(&controller.step(time_s, &measurement(error, rate)));
    out.status()
}

/// See the header.
#[no_mangle]
pub extern "C" fn steadfast_wu2018_reset(controller: Option<&mut wu2018::Controller>) -> i32 {
    controller.map_or(NULL_POINTER, |controller| {
        controller.reset();
        0
    })
}
