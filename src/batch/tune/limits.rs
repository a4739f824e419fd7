//! What no controller can do.

use nalgebra::Vector3;

use super::file::Requirements;

/// A demand that physics refuses.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Impossible {
    /// The torque does not turn the body in time.
    #[error(
        "field 'limits.settle_s': the value {settle_s} is not allowed; no controller turns this body by \
         {angle_deg} deg from rest to rest in less than {least_s:.4} s with these torques"
    )]
    Torque {
        /// Demanded, s.
        settle_s: f64,
        /// Least possible, s.
        least_s: f64,
        /// Angle, deg.
        angle_deg: f64,
    },
    /// The rate limit does not turn the body in time.
    #[error(
        "field 'limits.settle_s': the value {settle_s} is not allowed; no controller turns this body by \
         {angle_deg} deg from rest to rest in less than {least_s:.4} s at {rate_rad_s} rad/s or less"
    )]
    Rate {
        /// Rate limit, rad/s.
        rate_rad_s: f64,
        /// Demanded, s.
        settle_s: f64,
        /// Least possible, s.
        least_s: f64,
        /// Angle, deg.
        angle_deg: f64,
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

/// The shortest time, s, of a turn from rest to rest by the angle without its tolerance.
///
/// A lower bound for every controller: the angular momentum grows by at most the norm of all torques,
/// so that the body rate grows by at most that over the smallest principal moment, and the angle turned
/// is at most the integral of the rate.
pub fn least_time_s(requirements: &Requirements) -> f64 {
    let (angle, acceleration) = angle_and_acceleration(requirements);
    let rate = requirements.file.limits.rate_rad_s;
    // Up to the rate limit with full torque, and down again.
    match angle * acceleration <= rate * rate {
        true => 2.0 * (angle / acceleration).sqrt(),
        false => angle / rate + rate / acceleration,
    }
}

fn angle_and_acceleration(requirements: &Requirements) -> (f64, f64) {
    let tolerance = 2.0 * (3f64.sqrt() * requirements.component).min(1.0).asin();
    let angle = (requirements.angle_rad - tolerance).max(0.0);
    let limit = Vector3::from(requirements.file.spacecraft.torque_limit_nm).norm();
    let torque = limit + requirements.file.disturbance.bound_nm;
    (angle, torque / requirements.moments_kg_m2.0)
}

/// Refuses what no controller can do.
///
/// # Errors
/// The first demand that physics refuses, with the number that is possible.
pub fn check_possible(requirements: &Requirements) -> Result<(), Impossible> {
    let (limits, angle_deg) = (
        &requirements.file.limits,
        requirements.file.manoeuvre.angle_deg,
    );
    let settle_s = limits.settle_s;
    let bound_nm = requirements.file.disturbance.bound_nm;
    let limit_nm = requirements.least_torque_nm();
    if bound_nm >= limit_nm {
        return Err(Impossible::Disturbance { bound_nm, limit_nm });
    }
    let (angle, acceleration) = angle_and_acceleration(requirements);
    let least_s = 2.0 * (angle / acceleration).sqrt();
    if least_s > settle_s {
        return Err(Impossible::Torque {
            settle_s,
            least_s,
            angle_deg,
        });
    }
    let least_s = least_time_s(requirements);
    if least_s > settle_s {
        return Err(Impossible::Rate {
            rate_rad_s: limits.rate_rad_s,
            settle_s,
            least_s,
            angle_deg,
        });
    }
    Ok(())
}
