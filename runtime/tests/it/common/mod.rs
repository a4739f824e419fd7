//! Rigid body with fixed-step integration, for closed-loop tests.
#![allow(dead_code)]

use runtime::attitude::{AttitudeMeasurement, Quaternion};
use runtime::nalgebra::{Matrix3, Vector3};

/// Attitude and rate of a rigid body.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    pub attitude: Quaternion,
    pub rate: Vector3<f64>,
}

pub struct Plant {
    pub inertia: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

impl Plant {
    pub fn new(inertia: Matrix3<f64>) -> Self {
        let inverse = inertia.try_inverse().unwrap();
        Self { inertia, inverse }
    }

    pub fn largest_inertia(&self) -> f64 {
        self.inertia.symmetric_eigenvalues().max()
    }

    /// Angular acceleration, rad/s^2.
    pub fn acceleration(&self, rate: &Vector3<f64>, torque: &Vector3<f64>) -> Vector3<f64> {
        self.inverse * (torque - rate.cross(&(self.inertia * rate)))
    }

    /// One Runge-Kutta step of order 4 under a held torque and a disturbance in time.
    pub fn advance(
        &self,
        body: &Body,
        time: f64,
        step: f64,
        torque: &Vector3<f64>,
        disturbance: impl Fn(f64) -> Vector3<f64>,
    ) -> Body {
        let slope = |body: &Body, time: f64| Body {
            attitude: body.attitude.derivative(&body.rate),
            rate: self.acceleration(&body.rate, &(torque + disturbance(time))),
        };
        let k1 = slope(body, time);
        let k2 = slope(&moved(body, &k1, step / 2.0), time + step / 2.0);
        let k3 = slope(&moved(body, &k2, step / 2.0), time + step / 2.0);
        let k4 = slope(&moved(body, &k3, step), time + step);
        let mut next = *body;
        for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
            next = moved(&next, &k, step * weight / 6.0);
        }
        next.attitude = next.attitude.normalised().unwrap();
        next
    }
}

fn moved(body: &Body, slope: &Body, step: f64) -> Body {
    Body {
        attitude: Quaternion::new(
            body.attitude.scalar + slope.attitude.scalar * step,
            body.attitude.vector + slope.attitude.vector * step,
        ),
        rate: body.rate + slope.rate * step,
    }
}

impl Body {
    pub fn at_rest(attitude: Quaternion) -> Self {
        Self {
            attitude,
            rate: Vector3::zeros(),
        }
    }

    pub fn measured(&self) -> AttitudeMeasurement {
        AttitudeMeasurement {
            error: self.attitude,
            rate_rad_s: self.rate,
        }
    }

    pub fn angle_deg(&self) -> f64 {
        self.attitude.rotation_angle_rad().to_degrees()
    }
}
