//! Faults that every controller of a comparison must face, in proportion to its task.

use nalgebra::Vector3;

use crate::base::number::short;
use crate::plants::rigid_body::FaultFile;

/// A named set of actuator faults.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardFault {
    /// Short name.
    pub name: &'static str,
    /// What happens, as text.
    pub description: String,
    /// The faults, as a scenario file has them.
    pub faults: Vec<FaultFile>,
}

/// The standard faults of a run of `duration_s` seconds with the torque `limit`, N m, that can act on
/// each axis (finite).
pub fn standard_faults(duration_s: f64, limit: &Vector3<f64>) -> Vec<StandardFault> {
    let fault = |axis: u8, window: (f64, f64), effectiveness: f64, fraction: f64| FaultFile {
        axis: u32::from(axis) + 1,
        from_s: window.0 * duration_s,
        until_s: window.1 * duration_s,
        effectiveness,
        additive_nm: fraction * limit[usize::from(axis)],
        additive_wave: None,
    };
    let from = |fraction: f64| format!("{} s", short(fraction * duration_s));
    let quarter = from(0.25);
    let lasting = (0.25, 1.0);
    vec![
        StandardFault {
            name: "half_torque",
            description: format!("from {quarter} on every axis gives half of its torque"),
            faults: (0..3).map(|axis| fault(axis, lasting, 0.5, 0.0)).collect(),
        },
        StandardFault {
            name: "weak_axis",
            description: format!("from {quarter} on axis 2 gives a fifth of its torque"),
            faults: vec![fault(1, lasting, 0.2, 0.0)],
        },
        StandardFault {
            name: "dead_axis",
            description: format!(
                "axis 1 gives no torque from {} to {}",
                from(0.1),
                from(0.15)
            ),
            faults: vec![fault(0, (0.1, 0.15), 0.0, 0.0)],
        },
        StandardFault {
            name: "bias",
            description: format!("from {quarter} on a fifth of the limit acts on axis 3"),
            faults: vec![fault(2, lasting, 1.0, 0.2)],
        },
        StandardFault {
            name: "beyond_limit",
            description: format!(
                "one and a half times the limit acts on axis 1 from {} to {}",
                from(0.5),
                from(0.51)
            ),
            faults: vec![fault(0, (0.5, 0.51), 1.0, -1.5)],
        },
        StandardFault {
            name: "worn",
            description: format!(
                "from {quarter} on every axis gives 0.7 of its torque, with a tenth of the limit on top"
            ),
            faults: (0..3).map(|axis| fault(axis, lasting, 0.7, 0.1)).collect(),
        },
    ]
}
