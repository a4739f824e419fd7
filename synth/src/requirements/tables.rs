//! Numbers that a design starts from, found on many spacecraft in natural units. Nothing proved depends on them.

/// Angle (rad), fastest decay rate times T, box rate times T over the angle.
const TABLE: [[f64; 3]; 12] = [
    [0.0, 0.90, 1.0],
    [0.209, 0.80, 1.0],
    [0.384, 0.74, 1.0],
    [0.541, 0.59, 0.95],
    [0.820, 0.45, 0.80],
    [1.134, 0.32, 0.65],
    [1.379, 0.23, 0.60],
    [1.536, 0.19, 0.55],
    [1.745, 0.13, 0.48],
    [1.972, 0.07, 0.45],
    [2.182, 0.03, 0.42],
    [2.443, 0.01, 0.40],
];

/// The largest decay rate with which an angle (rad) is certified, times the time T of a turn by it.
pub fn fastest_decay(angle: f64) -> f64 {
    interpolated(angle, 1)
}

/// The rate of the box, times T over the angle (rad).
pub fn box_rate(angle: f64) -> f64 {
    interpolated(angle, 2)
}

/// The smallest scalar part of the box for an angle (rad).
pub fn smallest_scalar_part(angle: f64) -> f64 {
    let reach = (1.12 * angle + 0.03).min(0.5 * (angle + std::f64::consts::PI));
    (0.5 * reach).cos()
}

fn interpolated(angle: f64, column: usize) -> f64 {
    for pair in TABLE.windows(2) {
        let [left, right] = [pair[0], pair[1]];
        if angle <= right[0] {
            let part = ((angle - left[0]) / (right[0] - left[0])).max(0.0);
            return left[column] + part * (right[column] - left[column]);
        }
    }
    TABLE[TABLE.len() - 1][column]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tables_are_followed_in_between_and_beyond() {
        assert!((fastest_decay(0.0) - 0.9).abs() < 1e-12);
        assert!((fastest_decay(3.0) - 0.01).abs() < 1e-12);
        let middle = fastest_decay(0.5 * (0.209 + 0.384));
        assert!((middle - 0.77).abs() < 1e-12, "{middle}");
        assert!((box_rate(1.0) - 0.714).abs() < 0.01);
        assert!(smallest_scalar_part(3.0) > 0.0);
    }
}
