//! Angular momentum beside that of the rigid body: wheels, and a reference that moves.
//!
//! With wheels of momentum h (body axes), a reference of rate omega_r and acceleration alpha_r, and the error state
//! [omega - R omega_r; q] the equation of motion is that of the body itself,
//!
//! ```text
//! J omega_e' = -omega_e^x J omega_e + h_eff^x omega_e + sat(u) + tau + tau_r,
//! h_eff = h + (2 J - tr(J) I) R omega_r,    tau_r = -(R omega_r)^x (J R omega_r + h) - J R alpha_r,
//! ```
//!
//! so that bounds on all of them are one bound on h_eff and one on a further torque (derivation: the book's chapter on
//! imperfections).

use nalgebra::{Matrix3, Vector3};

/// A bound on the momentum of the wheels [N m s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WheelMomentum {
    /// On its norm.
    Norm(f64),
    /// On each component.
    PerAxis([f64; 3]),
}

/// Bounds on what exchanges angular momentum with the body beside the commanded torque; all 0 by default.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MomentumExchange {
    /// Momentum of the wheels.
    pub wheels: Option<WheelMomentum>,
    /// Norm of the reference's rate [rad/s].
    pub reference_rate: f64,
    /// Norm of the reference's angular acceleration [rad/s^2].
    pub reference_acceleration: f64,
    /// Step to which the torque of each axis is rounded [N m].
    pub torque_quantum: f64,
}

/// Corner coordinates p, q of the icosahedron (0, +-p, +-q) and its cyclic permutations, which contains the unit ball: (p +
/// q)^2 >= 3 and q^4 >= q^2 + (q - p)^2, the squared distances of its two kinds of faces.
pub(crate) const ICOSAHEDRON: [f64; 2] = [0.661_584_56, 1.070_466_29];

/// At least sqrt(3)/2: the norm of the rounding error of three axes, each at most half a step, relative to the step.
pub(crate) const ROUNDED_AXES: f64 = 0.866_025_403_8;

/// The largest and the smallest principal moment over a set of inertias, and the largest |tr(J) I - 2 J| [kg m^2].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct InertiaExtremes {
    pub smallest: f64,
    pub largest: f64,
    pub coupling: f64,
}

impl InertiaExtremes {
    /// Those of the inertias' convex hull, rounded to nearest.
    pub fn of<'a>(inertias: impl IntoIterator<Item = &'a Matrix3<f64>>) -> Self {
        let none = InertiaExtremes {
            smallest: f64::INFINITY,
            largest: 0.0,
            coupling: 0.0,
        };
        inertias.into_iter().fold(none, |known, inertia| {
            let moments = inertia.symmetric_eigenvalues();
            let trace = inertia.trace();
            let couplings = moments.iter().map(|moment| (trace - 2.0 * moment).abs());
            InertiaExtremes {
                smallest: known.smallest.min(moments.min()),
                largest: known.largest.max(moments.max()),
                coupling: couplings.fold(known.coupling, f64::max),
            }
        })
    }
}

impl WheelMomentum {
    /// A bound on the norm.
    pub fn norm(&self) -> f64 {
        match self {
            WheelMomentum::Norm(bound) => *bound,
            WheelMomentum::PerAxis(bounds) => Vector3::from(*bounds).norm(),
        }
    }
}

impl MomentumExchange {
    /// Whether h_eff may differ from 0.
    pub fn has_momentum(&self) -> bool {
        self.wheels.is_some_and(|wheels| wheels.norm() > 0.0) || self.reference_rate > 0.0
    }

    /// Corners of the polytope of h_eff, in units of its half-widths: those of a cube where each component is bounded, of
    /// an icosahedron where the norm is, and 0 alone without momentum.
    pub(crate) fn directions(&self) -> Vec<[f64; 3]> {
        if !self.has_momentum() {
            return vec![[0.0; 3]];
        }
        if let Some(WheelMomentum::PerAxis(_)) = self.wheels {
            let sign = |corner: usize, axis: usize| match corner >> axis & 1 {
                1 => 1.0,
                _ => -1.0,
            };
            let corner = |corner: usize| std::array::from_fn(|axis| sign(corner, axis));
            return (0..8).map(corner).collect();
        }
        let [p, q] = ICOSAHEDRON;
        let signs = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let corner = |axis: usize, [a, b]: [f64; 2]| {
            let mut out = [0.0; 3];
            out[(axis + 1) % 3] = a * p;
            out[(axis + 2) % 3] = b * q;
            out
        };
        let axes = 0..3;
        axes.flat_map(|axis| signs.map(|sign| corner(axis, sign)))
            .collect()
    }

    /// Half-widths of the set of h_eff along each axis [N m s]: of each component, or the radius of a ball, three times.
    pub(crate) fn half_widths(&self, extremes: &InertiaExtremes) -> [f64; 3] {
        let moving = self.reference_rate * extremes.coupling;
        let own = match self.wheels {
            None => [0.0; 3],
            Some(WheelMomentum::Norm(bound)) => [bound; 3],
            Some(WheelMomentum::PerAxis(bounds)) => bounds,
        };
        own.map(|bound| bound + moving)
    }

    /// The corners of the polytope of h_eff [N m s].
    pub(crate) fn corners(&self, extremes: &InertiaExtremes) -> Vec<Vector3<f64>> {
        let widths = Vector3::from(self.half_widths(extremes));
        let directions = self.directions().into_iter();
        directions
            .map(|direction| Vector3::from(direction).component_mul(&widths))
            .collect()
    }

    /// A bound on the norm of the torques beside the command and the disturbance [N m]: the reference's and the rounding
    /// of the command.
    pub(crate) fn further_torque(&self, extremes: &InertiaExtremes) -> f64 {
        let wheels = self.wheels.map_or(0.0, |wheels| wheels.norm());
        let rate = self.reference_rate;
        rate * rate * 0.5 * (extremes.largest - extremes.smallest)
            + rate * wheels
            + extremes.largest * self.reference_acceleration
            + ROUNDED_AXES * self.torque_quantum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;

    #[test]
    fn the_icosahedron_contains_the_unit_ball_exactly() {
        let exactly = |value: f64| BigRational::from_float(value).expect("finite");
        let [p, q] = ICOSAHEDRON.map(exactly);
        let squared = |value: &BigRational| value * value;
        assert!(squared(&(&p + &q)) >= exactly(3.0));
        assert!(squared(&squared(&q)) >= squared(&q) + squared(&(&q - &p)));
        let half = exactly(ROUNDED_AXES);
        assert!(squared(&half) * exactly(4.0) >= exactly(3.0));
    }

    #[test]
    fn twelve_corners_surround_every_direction() {
        let exchange = MomentumExchange {
            wheels: Some(WheelMomentum::Norm(20.0)),
            ..MomentumExchange::default()
        };
        let extremes = InertiaExtremes::of([&Matrix3::identity()]);
        let corners = exchange.corners(&extremes);
        assert_eq!(corners.len(), 12);
        for k in 0..1000 {
            let (a, b) = (f64::from(k) * 0.37, f64::from(k) * 0.011);
            let direction = Vector3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos());
            let farthest = corners.iter().map(|corner| corner.dot(&direction));
            // The support of the polytope is at least that of the ball.
            assert!(farthest.fold(0.0, f64::max) >= 20.0);
        }
    }
}
