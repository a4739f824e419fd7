//! What no controller can do.
use synth::claim::Claim;

use super::file::Requirements;

/// A demand that physics refuses.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Impossible {
    /// The torque or the rate limit does not turn the body in time.
    #[error(
        "field 'limits.settle_s': the value {settle_s} is not allowed; no controller turns this body by \
         {angle_deg} deg from rest to rest in less than {} s {}",
        Claim::AtLeast(*least_s), means(*rate_rad_s)
    )]
    Time {
        /// Demanded, s.
        settle_s: f64,
        /// Least possible, s.
        least_s: f64,
        /// Angle, deg.
        angle_deg: f64,
        /// Rate limit, where the torque would do, rad/s.
        rate_rad_s: Option<f64>,
    },
    /// The disturbance may be stronger than the actuators.
    #[error(
        "field 'disturbance.bound_nm': the value {bound_nm} is not allowed; it must be below {limit_nm}, the \
         smallest of spacecraft.torque_limit_nm"
    )]
    Disturbance {
        /// Bound of the disturbance, N m.
        bound_nm: f64,
        /// Smallest torque limit, N m.
        limit_nm: f64,
    },
}

fn means(rate_rad_s: Option<f64>) -> String {
    match rate_rad_s {
        None => "with these torques".to_string(),
        Some(rate) => format!("at {rate} rad/s or less"),
    }
}

/// The shortest time, s, of a turn from rest to rest by the angle without its tolerance.
///
/// A lower bound for every controller: the angular momentum grows by at most the norm of all torques,
/// so that the body rate grows by at most that over the smallest principal moment, and the angle turned
/// is at most the integral of the rate.
pub fn least_time_s(requirements: &Requirements) -> f64 {
    least_times_s(requirements)[1]
}

/// The shortest times, s, with the torques alone and with the rate limit too.
fn least_times_s(requirements: &Requirements) -> [f64; 2] {
    let tolerance = 2.0 * (3f64.sqrt() * requirements.component).min(1.0).asin();
    let angle = (requirements.angle_rad - tolerance).max(0.0);
    let file = &requirements.file;
    let torque = requirements.torque_limit_nm.norm() + file.disturbance.bound_nm.get();
    let acceleration = torque / requirements.moments_kg_m2.0;
    let rate = file.limits.rate_rad_s.get();
    let free = 2.0 * (angle / acceleration).sqrt();
    // Up to the rate limit with full torque, and down again.
    match angle * acceleration <= rate * rate {
        true => [free, free],
        false => [free, angle / rate + rate / acceleration],
    }
}

/// Refuses what no controller can do.
///
/// # Errors
/// The first demand that physics refuses, with the number that is possible.
pub fn check_possible(requirements: &Requirements) -> Result<(), Impossible> {
    let file = &requirements.file;
    let bound_nm = file.disturbance.bound_nm.get();
    let limit_nm = requirements.torque_limit_nm.min();
    if bound_nm >= limit_nm {
        return Err(Impossible::Disturbance { bound_nm, limit_nm });
    }
    let settle_s = file.limits.settle_s.get();
    let means = [None, Some(file.limits.rate_rad_s.get())];
    let mut times = least_times_s(requirements).into_iter().zip(means);
    match times.find(|(least_s, _)| *least_s > settle_s) {
        None => Ok(()),
        Some((least_s, rate_rad_s)) => Err(Impossible::Time {
            settle_s,
            least_s,
            angle_deg: file.manoeuvre.angle_deg,
            rate_rad_s,
        }),
    }
}
