//! What a search may vary, and between which limits.

use crate::model::ModelFile;
use crate::programs::Parameter;

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
        // A limit that is left out is above every other.
        if coordinate.is_finite() || coordinate == f64::INFINITY {
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

    /// The limits of a number of the model; its value twice where it stays.
    pub fn limits(&self, parameter: Parameter) -> [f64; 2] {
        let mut ranges = self.ranges.iter();
        let varied = ranges.find(|range| range.parameter == parameter);
        varied.map_or([parameter.of(&self.base).unwrap_or(f64::NAN); 2], |range| {
            range.limits
        })
    }

    /// A point with the coordinate of its largest xi changed, inside the limits.
    pub fn with_weight(&self, point: &[f64], changed: impl Fn(f64) -> f64) -> Vec<f64> {
        let pairs = self.ranges.iter().zip(point);
        let moved = pairs.map(|(range, &coordinate)| match range.parameter {
            Parameter::DisturbanceWeight => changed(coordinate),
            _ => coordinate,
        });
        self.inside(&moved.collect::<Vec<_>>())
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
