//! The forms of the gyroscopic torque that are searched: K = mean m I + deviation (J - m I) with m = tr(J) / 3.
//!
//! K = 0 is the form of the paper; mean = 1, deviation = -1/2 is the symmetrised one, K = (tr(J) I - J) / 2.

use nalgebra::Matrix3;

use super::file::{ExactPlant, PlantFile};
use super::{Model, Plant};

/// The two numbers of a form K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GyroscopicForm {
    /// Part along the identity, relative to the mean moment.
    pub mean: f64,
    /// Part along the inertia's deviation from its mean moment.
    pub deviation: f64,
}

impl GyroscopicForm {
    /// Forms that are tried first: one that is good for bodies whose moments are not too unlike, the symmetrised one for
    /// slender bodies, and the paper's.
    pub const CANDIDATES: [GyroscopicForm; 3] = [
        GyroscopicForm {
            mean: 0.5,
            deviation: -0.75,
        },
        GyroscopicForm {
            mean: 1.0,
            deviation: -0.5,
        },
        GyroscopicForm::NONE,
    ];

    /// The form of the paper.
    pub const NONE: GyroscopicForm = GyroscopicForm {
        mean: 0.0,
        deviation: 0.0,
    };

    /// K of a plant [kg m^2].
    pub fn matrix(self, exact: &ExactPlant) -> [[f64; 3]; 3] {
        let (mean, deviation) = parts(exact);
        let form = Matrix3::identity() * (self.mean * mean) + deviation * self.deviation;
        std::array::from_fn(|r| std::array::from_fn(|c| form[(r, c)]))
    }

    /// The numbers of a plant's K; of any K those of the nearest such form.
    pub fn of(exact: &ExactPlant) -> Self {
        let Some(rows) = &exact.gyroscopic_form_kg_m2 else {
            return GyroscopicForm::NONE;
        };
        let form = Matrix3::from_fn(|r, c| rows[r][c]);
        let (mean, deviation) = parts(exact);
        let size = deviation.norm_squared();
        GyroscopicForm {
            mean: form.trace() / (3.0 * mean),
            deviation: match size > 0.0 {
                true => form.dot(&deviation) / size,
                false => 0.0,
            },
        }
    }
}

/// The mean moment m, and J - m I.
fn parts(exact: &ExactPlant) -> (f64, Matrix3<f64>) {
    let inertia = Matrix3::from_fn(|r, c| exact.inertia_kg_m2[r][c]);
    let mean = inertia.trace() / 3.0;
    (mean, inertia - Matrix3::identity() * mean)
}

impl Model {
    /// Whether the form of the gyroscopic torque is free: it is to be searched. Scheduled gains have the paper's.
    pub fn has_free_form(&self) -> bool {
        matches!(&self.plant, Plant::Spacecraft(craft) if craft.gyroscopic_form.is_none())
    }

    /// The model with a form; `None` for a plant without one.
    pub fn with_form(&self, form: GyroscopicForm) -> Option<Model> {
        let mut file = self.file.clone();
        let PlantFile::Exact(exact) = &mut file.plant else {
            return None;
        };
        exact.gyroscopic_form_kg_m2 = Some(form.matrix(exact));
        Model::new(file).ok()
    }
}
