//! The conditions of Lei, Meng, Wang, Wang and Jin 2022: section V-C, those of its proofs, and the
//! bounds (69) and (80) on the times between events.

use nalgebra::Vector3;
use runtime::attitude::Quaternion;
use runtime::lei2022::{CompositeTrigger, ControlLaw};

/// What the conditions are evaluated for.
#[derive(Debug, Clone)]
pub struct Case {
    /// Control law with its inertia.
    pub law: ControlLaw,
    /// Composite trigger.
    pub trigger: CompositeTrigger,
    /// Torque limit of each axis, N m.
    pub torque_limit: Vector3<f64>,
    /// Error quaternion at the start, scalar part not negative.
    pub error: Quaternion,
    /// Body rate at the start, rad/s.
    pub rate_rad_s: Vector3<f64>,
    /// Bound of each component of the disturbance torque, N m.
    pub disturbance_nm: Vector3<f64>,
    /// Largest body rate that is required, rad/s, where it is.
    pub rate_limit_rad_s: Option<f64>,
}
