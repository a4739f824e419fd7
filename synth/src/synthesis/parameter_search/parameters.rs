//! What a search may vary, and between which limits.

use crate::model::{ModelFile, PlantFile};

/// A number of the model that the certificate depends on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// phi [1/s].
    DecayRate,
    /// The box: bound on the rate about an axis, from 0 [rad/s].
    Rate(usize),
    /// The box: smallest scalar part q0.
    ScalarPart,
    /// eps_1.
    FirstWeight,
    /// eps_3.
    ThirdWeight,
    /// xi_max.
    DisturbanceWeight,
    /// nu.
    Threshold,
}

impl Parameter {
    /// Its field in a model file.
    pub fn field(self) -> String {
        match self {
            Parameter::DecayRate => "specs.phi_per_s".to_string(),
            Parameter::Rate(axis) => format!("plant.exact.rate_rad_s[{axis}]"),
            Parameter::ScalarPart => "plant.exact.q0_min".to_string(),
            Parameter::FirstWeight => "specs.eps[0]".to_string(),
            Parameter::ThirdWeight => "specs.eps[2]".to_string(),
            Parameter::DisturbanceWeight => "specs.xi_max".to_string(),
            Parameter::Threshold => "specs.nu".to_string(),
        }
    }

    /// Its value in a file; `None` where the plant has none.
    pub fn of(self, file: &ModelFile) -> Option<f64> {
        let (specs, plant) = (&file.specs, &file.plant);
        match (self, plant) {
            (Parameter::DecayRate, _) => Some(specs.phi_per_s),
            (Parameter::FirstWeight, _) => Some(specs.eps[0]),
            (Parameter::ThirdWeight, _) => Some(specs.eps[2]),
            (Parameter::DisturbanceWeight, _) => Some(specs.xi_max),
            (Parameter::Threshold, _) => Some(specs.nu),
            (Parameter::Rate(axis), PlantFile::Exact(exact)) => exact.rate_rad_s.get(axis).copied(),
            (Parameter::ScalarPart, PlantFile::Exact(exact)) => Some(exact.q0_min),
            (Parameter::Rate(_) | Parameter::ScalarPart, _) => None,
        }
    }

    /// Sets its value in a file.
    pub fn set(self, file: &mut ModelFile, value: f64) {
        let specs = &mut file.specs;
        match (self, &mut file.plant) {
            (Parameter::DecayRate, _) => specs.phi_per_s = value,
            (Parameter::FirstWeight, _) => specs.eps[0] = value,
            (Parameter::ThirdWeight, _) => specs.eps[2] = value,
            (Parameter::DisturbanceWeight, _) => specs.xi_max = value,
            (Parameter::Threshold, _) => {
                specs.nu = value;
                specs.nu_min = specs.nu_min.map(|lowest| lowest.min(value));
            }
            (Parameter::Rate(axis), PlantFile::Exact(exact)) => {
                if let Some(bound) = exact.rate_rad_s.get_mut(axis) {
                    *bound = value;
                }
            }
            (Parameter::ScalarPart, PlantFile::Exact(exact)) => exact.q0_min = value,
            (Parameter::Rate(_) | Parameter::ScalarPart, _) => {}
        }
    }

    /// Its coordinate in the search: the logarithm, which makes steps relative; of a scalar part q0 that of
    /// |q| / q0.
    pub fn coordinate(self, value: f64) -> f64 {
        match self {
            Parameter::ScalarPart => ((1.0 - value * value).max(0.0).sqrt() / value).ln(),
            _ => value.ln(),
        }
    }

    /// The value at a coordinate.
    pub fn value(self, coordinate: f64) -> f64 {
        match self {
            Parameter::ScalarPart => (1.0 + (2.0 * coordinate).exp()).sqrt().recip(),
            _ => coordinate.exp(),
        }
    }
}

/// A parameter with its limits, low < high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// What is varied.
    pub parameter: Parameter,
    /// Smallest and largest value.
    pub limits: [f64; 2],
}

impl Range {
    /// Smallest and largest coordinate.
    pub fn coordinates(&self) -> [f64; 2] {
        let [a, b] = self.limits.map(|value| self.parameter.coordinate(value));
        [a.min(b), a.max(b)]
    }

    /// The parameter's coordinate in a file, inside the limits.
    pub fn start(&self, file: &ModelFile) -> f64 {
        let [low, high] = self.coordinates();
        let value = self.parameter.of(file).unwrap_or(self.limits[0]);
        let coordinate = self.parameter.coordinate(value);
        if coordinate.is_finite() {
            coordinate.clamp(low, high)
        } else {
            0.5 * (low + high)
        }
    }
}

/// The space that is searched.
#[derive(Debug, Clone)]
pub struct Space {
    /// The model, with every other number as it stays.
    pub base: ModelFile,
    /// What is varied.
    pub ranges: Vec<Range>,
}

impl Space {
    /// The model at a point of the space.
    pub fn at(&self, point: &[f64]) -> ModelFile {
        let mut file = self.base.clone();
        for (range, &coordinate) in self.ranges.iter().zip(point) {
            let [low, high] = range.coordinates();
            let value = range.parameter.value(coordinate.clamp(low, high));
            let [least, most] = range.limits;
            range.parameter.set(&mut file, value.clamp(least, most));
        }
        file
    }

    /// The nearest point inside the limits.
    pub fn inside(&self, point: &[f64]) -> Vec<f64> {
        let pairs = self.ranges.iter().zip(point);
        pairs
            .map(|(range, &coordinate)| {
                let [low, high] = range.coordinates();
                coordinate.clamp(low, high)
            })
            .collect()
    }

    /// The model's own point, inside the limits.
    pub fn start(&self) -> Vec<f64> {
        self.ranges
            .iter()
            .map(|range| range.start(&self.base))
            .collect()
    }
}
