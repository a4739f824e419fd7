//! The symbols that C links with. The names are the only thing that is unsafe here: another library may have the same.
#![allow(unsafe_code)]

use core::mem::{align_of, size_of, MaybeUninit};

use runtime::attitude::AttitudeMeasurement;
use runtime::command::Command;
use runtime::error::ParameterError;
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

/// Makes a controller in the caller's place.
fn init<C, P>(
    place: Option<&mut MaybeUninit<C>>,
    parameters: Option<&P>,
    make: impl FnOnce(&P) -> Result<C, ParameterError>,
) -> i32 {
    let (Some(place), Some(parameters)) = (place, parameters) else {
        return NULL_POINTER;
    };
    match make(parameters) {
        Ok(made) => {
            place.write(made);
            0
        }
        Err(_) => BAD_PARAMETERS,
    }
}

/// Takes a sample: quaternion and rate.
fn step<C>(
    controller: Option<&mut C>,
    (error, rate_rad_s): (Option<&[f64; 4]>, Option<&[f64; 3]>),
    out: Option<&mut CommandOfC>,
    take: impl FnOnce(&mut C, &AttitudeMeasurement) -> Command<3>,
) -> i32 {
    let (Some(controller), Some(error), Some(rate), Some(out)) =
        (controller, error, rate_rad_s, out)
    else {
        return NULL_POINTER;
    };
    *out = CommandOfC::of(&take(controller, &measurement(error, rate)));
    out.status()
}

/// See the header.
#[no_mangle]
pub extern "C" fn steadfast_xu2020_init(
    controller: Option<&mut MaybeUninit<Xu2020Controller>>,
    parameters: Option<&Xu2020Parameters>,
) -> i32 {
    init(controller, parameters, Xu2020Parameters::controller)
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
    let measured = (error_quaternion, rate_rad_s);
    step(controller, measured, out, |controller, measured| {
        controller.step_measured(time_s, measured.checked_state())
    })
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
    init(controller, parameters, Wu2018Parameters::controller)
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
    let measured = (error_quaternion, rate_rad_s);
    step(controller, measured, out, |controller, measured| {
        controller.step(time_s, measured)
    })
}

/// See the header.
#[no_mangle]
pub extern "C" fn steadfast_wu2018_reset(controller: Option<&mut wu2018::Controller>) -> i32 {
    controller.map_or(NULL_POINTER, |controller| {
        controller.reset();
        0
    })
}
