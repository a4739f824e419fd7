//! The numbers of a model that a design depends on.

use crate::model::{GyroscopicForm, Model, ModelFile, PlantFile, RulesSystem};

/// A number of the model, or several that are changed by one factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// phi [1/s].
    DecayRate,
    /// hbar (s).
    SamplingInterval,
    /// nu.
    Threshold,
    /// xi_max.
    DisturbanceWeight,
    /// eps_1.
    FirstWeight,
    /// eps_3.
    ThirdWeight,
    /// The box: bound on the rate about an axis, from 0 [rad/s].
    Rate(usize),
    /// The box: smallest scalar part q0.
    ScalarPart,
    /// The gyroscopic form's part along the identity.
    FormMean,
    /// The gyroscopic form's part along the inertia's deviation.
    FormDeviation,
    /// The bound on a spacecraft's disturbance torque [N m].
    DisturbanceBound,
    /// The limits of all inputs.
    InputLimits,
    /// The extents of the region; for a spacecraft the rates and the vector part.
    Region,
}

impl Parameter {
    /// Its field in a model file; of several numbers that of the first.
    pub fn field(self) -> String {
        let field = match self {
            Parameter::Rate(axis) => return format!("plant.exact.rate_rad_s[{axis}]"),
            Parameter::DecayRate => "specs.phi_per_s",
            Parameter::SamplingInterval => "specs.hbar_s",
            Parameter::Threshold => "specs.nu",
            Parameter::DisturbanceWeight => "specs.xi_max",
            Parameter::FirstWeight => "specs.eps[0]",
            Parameter::ThirdWeight => "specs.eps[2]",
            Parameter::ScalarPart => "plant.exact.q0_min",
            Parameter::FormMean | Parameter::FormDeviation => "plant.exact.gyroscopic_form_kg_m2",
            Parameter::DisturbanceBound => "plant.exact.disturbance_bound_nm",
            Parameter::InputLimits => "plant.exact.torque_limit_nm[0]",
            Parameter::Region => "plant.exact.rate_rad_s[0]",
        };
        field.to_string()
    }

    /// Its number in a file, of several the first; `None` where the plant has none.
    fn place(self, file: &mut ModelFile) -> Option<&mut f64> {
        let specs = &mut file.specs;
        match (self, &mut file.plant) {
            (Parameter::DecayRate, _) => Some(&mut specs.phi_per_s),
            (Parameter::SamplingInterval, _) => Some(&mut specs.hbar_s),
            (Parameter::Threshold, _) => Some(&mut specs.nu),
            (Parameter::DisturbanceWeight, _) => Some(&mut specs.xi_max),
            (Parameter::FirstWeight, _) => Some(&mut specs.eps[0]),
            (Parameter::ThirdWeight, _) => Some(&mut specs.eps[2]),
            (Parameter::Rate(axis), PlantFile::Exact(exact)) => exact.rate_rad_s.get_mut(axis),
            (Parameter::ScalarPart, PlantFile::Exact(exact)) => Some(&mut exact.q0_min),
            (Parameter::DisturbanceBound, PlantFile::Exact(exact)) => {
                Some(&mut exact.disturbance_bound_nm)
            }
            (Parameter::InputLimits, plant) => input_limits(plant).first_mut(),
            (Parameter::Region, PlantFile::Exact(exact)) => exact.rate_rad_s.first_mut(),
            (Parameter::Region, PlantFile::Vertices(system)) => {
                system.region.first_mut().map(|bound| &mut bound.bound)
            }
            (Parameter::Region, PlantFile::Rules(rules)) => rules.state_bounds.first_mut(),
            // These are parts of a matrix.
            (Parameter::FormMean | Parameter::FormDeviation, _) => None,
            (Parameter::Rate(_) | Parameter::ScalarPart | Parameter::DisturbanceBound, _) => None,
        }
    }

    /// Its value in a file, of several the first; `None` where the plant has none.
    pub fn of(self, file: &ModelFile) -> Option<f64> {
        match (self, &file.plant) {
            (Parameter::FormMean, PlantFile::Exact(exact)) => Some(GyroscopicForm::of(exact).mean),
            (Parameter::FormDeviation, PlantFile::Exact(exact)) => {
                Some(GyroscopicForm::of(exact).deviation)
            }
            _ => self.place(&mut file.clone()).copied(),
        }
    }

    /// Sets its value in a file.
    pub fn set(self, file: &mut ModelFile, value: f64) {
        if let PlantFile::Exact(exact) = &mut file.plant {
            let form = GyroscopicForm::of(exact);
            let form = match self {
                Parameter::FormMean => Some(GyroscopicForm {
                    mean: value,
                    ..form
                }),
                Parameter::FormDeviation => Some(GyroscopicForm {
                    deviation: value,
                    ..form
                }),
                _ => None,
            };
            if let Some(form) = form {
                exact.gyroscopic_form_kg_m2 = Some(form.matrix(exact));
            }
        }
        if let Some(place) = self.place(file) {
            *place = value;
        }
        let specs = &mut file.specs;
        specs.hmin_s = specs.hmin_s.map(|shortest| shortest.min(specs.hbar_s));
        specs.nu_min = specs.nu_min.map(|lowest| lowest.min(specs.nu));
    }

    /// Multiplies it by a factor, of several numbers all.
    pub fn scale(self, file: &mut ModelFile, factor: f64) {
        match (self, &mut file.plant) {
            (Parameter::InputLimits, plant) => {
                input_limits(plant)
                    .iter_mut()
                    .for_each(|limit| *limit *= factor);
            }
            (Parameter::Region, PlantFile::Exact(exact)) => {
                exact.rate_rad_s.iter_mut().for_each(|rate| *rate *= factor);
                let vector = (1.0 - exact.q0_min * exact.q0_min).max(0.0) * factor * factor;
                exact.q0_min = (1.0 - vector).max(0.0).sqrt();
            }
            (Parameter::Region, PlantFile::Vertices(system)) => {
                let bounds = system.region.iter_mut();
                bounds.for_each(|bound| bound.bound *= factor);
            }
            (Parameter::Region, PlantFile::Rules(rules)) => {
                let bounds = rules.state_bounds.iter_mut();
                bounds.for_each(|bound| *bound *= factor);
            }
            _ => {
                if let Some(value) = self.of(file) {
                    self.set(file, value * factor);
                }
            }
        }
    }

    /// The model with it multiplied by a factor; `None` when the model does not have it or does not allow it.
    pub fn scaled(self, model: &Model, factor: f64) -> Option<Model> {
        let mut file = model.file.clone();
        self.scale(&mut file, factor);
        let changed = file != model.file;
        Model::new(file).ok().filter(|_| changed)
    }

    /// Its coordinate in a search: the logarithm, which makes steps relative; of a scalar part q0 that of
    /// |q| / q0, of a part of the gyroscopic form itself.
    pub fn coordinate(self, value: f64) -> f64 {
        match self {
            Parameter::FormMean | Parameter::FormDeviation => value,
            Parameter::ScalarPart => ((1.0 - value * value).max(0.0).sqrt() / value).ln(),
            _ => value.ln(),
        }
    }

    /// The value at a coordinate.
    pub fn value(self, coordinate: f64) -> f64 {
        match self {
            Parameter::FormMean | Parameter::FormDeviation => coordinate,
            Parameter::ScalarPart => (1.0 + (2.0 * coordinate).exp()).sqrt().recip(),
            _ => coordinate.exp(),
        }
    }
}

fn input_limits(plant: &mut PlantFile) -> &mut [f64] {
    match plant {
        PlantFile::Exact(craft) => &mut craft.torque_limit_nm,
        PlantFile::Vertices(system) => &mut system.input_limit,
        PlantFile::Rules(rules) => match &mut rules.system {
            RulesSystem::Spacecraft(craft) => &mut craft.torque_limit_nm,
            RulesSystem::Linear(system) => &mut system.input_limit,
        },
    }
}
