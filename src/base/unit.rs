//! Units, which stand at the end of keys and of columns' names.

/// Ends of keys and the units that they name, the longer ones first.
const UNITS: [(&str, &str); 15] = [
    ("_nm_s_rad", "N m s/rad"),
    ("_nm_rad", "N m/rad"),
    ("_kg_m2", "kg m^2"),
    ("_rad_s2", "rad/s^2"),
    ("_rad_s", "rad/s"),
    ("_deg_s", "deg/s"),
    ("_nm_s", "N m s"),
    ("_per_s", "1/s"),
    ("_seconds", "s"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_nm", "N m"),
    ("_kg", "kg"),
    ("_s", "s"),
    ("_j", "J"),
];

/// The unit that a key ends with; empty without one.
pub fn unit_of_key(key: &str) -> &'static str {
    let found = UNITS.iter().find(|(end, _)| key.ends_with(end));
    found.map_or("", |(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_come_from_the_names() {
        let units = [
            ("time_s", "s"),
            ("rate_1_rad_s", "rad/s"),
            ("torque_2_nm", "N m"),
            ("error_deg", "deg"),
            ("barrier_v1_j", "J"),
            ("error_q0_scalar", ""),
            ("sent", ""),
            ("rate_gain_nm_s_rad", "N m s/rad"),
        ];
        for (name, expected) in units {
            assert_eq!(unit_of_key(name), expected, "{name}");
        }
    }
}
