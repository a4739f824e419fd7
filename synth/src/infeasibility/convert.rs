//! Infeasibility certificates: from numbers to files and back, with the checks of shapes and ranges.

use nalgebra::DMatrix;

use super::file::{
    flushed, rows, DeadZoneMomentsFile, GainWeightsFile, HeldMomentsFile, InputWeightFile,
    MomentsFile, RegionWeightFile, VertexWeightFile, WeightsFile,
};
use crate::certify::infeasible::{
    DeadZoneMoments, DualMultipliers, GainDuals, HeldMoments, InputDual, IntegralCross, Moments,
    RegionDual, VertexDual,
};
use crate::model::{check_matrix, check_positive, check_symmetric, finite, Model, ModelError};

impl WeightsFile {
    /// The numbers as written, `None` without dual multipliers of a gain. Those too small to be allowed in a file
    /// become 0.
    pub(crate) fn new(weights: &DualMultipliers) -> Option<Self> {
        let region = |weight: &RegionDual| RegionWeightFile {
            state: rows(&weight.state),
            cross: rows(&weight.cross),
            unit: rows(&weight.unit),
        };
        let contains = !weights.must_contain.is_empty();
        let (first, further) = weights.gains.split_first()?;
        Some(WeightsFile {
            containment_weight: contains.then_some(weights.containment_weight),
            gain: (!weights.given.is_empty()).then_some(first.gain + 1),
            decrease_start: MomentsFile::new(&first.start),
            decrease_end: MomentsFile::new(&first.end),
            integral: rows(&first.integral),
            anti_windup: first.inputs.iter().map(InputWeightFile::new).collect(),
            further_gains: further.iter().filter_map(GainWeightsFile::new).collect(),
            region: weights.region.iter().map(region).collect(),
            must_contain: weights.must_contain.iter().map(rows).collect(),
        })
    }

    /// Checked numbers.
    pub(crate) fn weights(
        &self,
        model: &Model,
        given: &[DMatrix<f64>],
    ) -> Result<DualMultipliers, ModelError> {
        let system = model.plant.nominal().takagi_sugeno();
        let n = system.states();
        check_length("region", self.region.len(), system.region.len())?;
        // Without them the statement is about every rho.
        let contained = match self.must_contain.is_empty() && self.containment_weight.is_none() {
            true => 0,
            false => model.file.specs.must_contain.len(),
        };
        check_length("must_contain", self.must_contain.len(), contained)?;
        let bounds = self.region.iter().zip(&system.region).enumerate();
        let region = bounds.map(|(index, (weight, bound))| {
            let field = format!("region[{index}]");
            let k = bound.rows.nrows();
            let cross = (Some(n), Some(k));
            Ok(RegionDual {
                state: symmetric(&format!("{field}.state"), &weight.state, n)?,
                cross: check_matrix(&format!("{field}.cross"), &weight.cross, cross)?,
                unit: symmetric(&format!("{field}.unit"), &weight.unit, k)?,
            })
        });
        let must_contain = self.must_contain.iter().enumerate();
        let must_contain =
            must_contain.map(|(index, rows)| symmetric(&format!("must_contain[{index}]"), rows, n));
        let mut gains = vec![self.first_gain(model, given.len())?];
        if given.is_empty() {
            check_length("further_gains", self.further_gains.len(), 0)?;
        }
        for (index, further) in self.further_gains.iter().enumerate() {
            let weights = further.weights(model, given.len());
            gains.push(weights.map_err(|error| error.within(&format!("further_gains[{index}]")))?);
        }
        Ok(DualMultipliers {
            given: given.to_vec(),
            containment_weight: self.containment(contained > 0)?,
            gains,
            region: region.collect::<Result<_, _>>()?,
            must_contain: must_contain.collect::<Result<_, _>>()?,
        })
    }

    /// The dual multipliers of the only or first gain.
    fn first_gain(&self, model: &Model, given: usize) -> Result<GainDuals, ModelError> {
        let gain = match self.gain {
            Some(gain) if given > 0 => gain_index(gain, given)?,
            Some(gain) => {
                return Err(ModelError::OutOfRange {
                    field: "gain".to_string(),
                    value: gain as f64,
                    allowed: "left out: no gains are given".to_string(),
                })
            }
            None if given > 0 => return Err(missing("gain", "the number of a gain")),
            None => 0,
        };
        let (start, end) = (&self.decrease_start, &self.decrease_end);
        let part = PartFile {
            ends: [start, end],
            integral: &self.integral,
            anti_windup: &self.anti_windup,
        };
        let part = part.weights(model, gain, given > 0)?;
        let (n, eps) = (part.integral.nrows(), model.file.specs.eps);
        if part.end.multiplied_sample.is_none() && eps[2] == 0.0 {
            let expected = format!("{n} x {n}, because eps[2] is 0");
            return Err(missing("decrease_end.multiplied_sample", &expected));
        }
        if part.end.multiplied_sample.is_none() && given > 0 && part.end.held.is_none() {
            let expected = format!("{n} x {n}, because there is no held state");
            return Err(missing("decrease_end.multiplied_sample", &expected));
        }
        Ok(part)
    }

    fn containment(&self, needed: bool) -> Result<f64, ModelError> {
        match (needed, self.containment_weight) {
            (true, Some(weight)) => {
                check_positive("containment_weight", weight)?;
                Ok(weight)
            }
            (true, None) => Err(missing(
                "containment_weight",
                "a number above 0, because the model has must_contain states",
            )),
            (false, Some(value)) => Err(ModelError::OutOfRange {
                field: "containment_weight".to_string(),
                value,
                allowed: "left out: the model has no must_contain states".to_string(),
            }),
            (false, None) => Ok(1.0),
        }
    }
}

impl GainWeightsFile {
    fn new(weights: &GainDuals) -> Option<Self> {
        let cross = weights.integral_cross.as_ref()?;
        Some(GainWeightsFile {
            gain: weights.gain + 1,
            decrease_start: MomentsFile::new(&weights.start),
            decrease_end: MomentsFile::new(&weights.end),
            integral: rows(&weights.integral),
            state_integral: rows(&cross.state),
            sample_integral: rows(&cross.sample),
            anti_windup: weights.inputs.iter().map(InputWeightFile::new).collect(),
        })
    }

    fn weights(&self, model: &Model, given: usize) -> Result<GainDuals, ModelError> {
        let gain = gain_index(self.gain, given)?;
        let part = PartFile {
            ends: [&self.decrease_start, &self.decrease_end],
            integral: &self.integral,
            anti_windup: &self.anti_windup,
        };
        let part = part.weights(model, gain, true)?;
        let n = part.integral.nrows();
        if part.end.multiplied_sample.is_none() {
            let expected = format!("{n} x {n}");
            return Err(missing("decrease_end.multiplied_sample", &expected));
        }
        let square = (Some(n), Some(n));
        Ok(GainDuals {
            integral_cross: Some(IntegralCross {
                state: check_matrix("state_integral", &self.state_integral, square)?,
                sample: check_matrix("sample_integral", &self.sample_integral, square)?,
            }),
            ..part
        })
    }
}

/// The parts that the dual multipliers of every gain have.
struct PartFile<'a> {
    ends: [&'a MomentsFile; 2],
    integral: &'a [Vec<f64>],
    anti_windup: &'a [InputWeightFile],
}

impl PartFile<'_> {
    fn weights(&self, model: &Model, gain: usize, given: bool) -> Result<GainDuals, ModelError> {
        let (n, m, _, _) = model.plant.sizes();
        check_length("anti_windup", self.anti_windup.len(), m)?;
        let inputs = self.anti_windup.iter().enumerate().map(|(index, weight)| {
            let field = format!("anti_windup[{index}]");
            finite(&format!("{field}.unit"), weight.unit)?;
            Ok(InputDual {
                state: symmetric(&format!("{field}.state"), &weight.state, n)?,
                unit: weight.unit,
            })
        });
        let [start, end] = self.ends;
        let start = start.moments(model, given);
        let start = start.map_err(|error| error.within("decrease_start"))?;
        if start.multiplied_sample.is_none() {
            let expected = format!("{n} x {n}");
            return Err(missing("decrease_start.multiplied_sample", &expected));
        }
        let end = end.moments(model, given);
        Ok(GainDuals {
            gain,
            start,
            end: end.map_err(|error| error.within("decrease_end"))?,
            integral: symmetric("integral", self.integral, n)?,
            integral_cross: None,
            inputs: inputs.collect::<Result<_, _>>()?,
        })
    }
}

/// The index of a gain that files number from 1.
fn gain_index(number: usize, count: usize) -> Result<usize, ModelError> {
    match (1..=count).contains(&number) {
        true => Ok(number - 1),
        false => Err(ModelError::OutOfRange {
            field: "gain".to_string(),
            value: number as f64,
            allowed: format!("1 to {count}"),
        }),
    }
}

fn missing(field: &str, expected: &str) -> ModelError {
    ModelError::WrongShape {
        field: field.to_string(),
        found: "nothing".to_string(),
        expected: expected.to_string(),
    }
}

impl InputWeightFile {
    fn new(weight: &InputDual) -> Self {
        InputWeightFile {
            state: rows(&weight.state),
            unit: flushed(weight.unit),
        }
    }
}

impl MomentsFile {
    fn new(moments: &Moments) -> Self {
        let vertex = |weight: &VertexDual| VertexWeightFile {
            vertex: weight.vertex + 1,
            moments: rows(&weight.moments),
        };
        let held = |held: &HeldMoments| HeldMomentsFile {
            multiplied_held: rows(&held.multiplied_held),
            sample_held: rows(&held.sample_held),
            held: rows(&held.held),
        };
        MomentsFile {
            vertices: moments.vertices.iter().map(vertex).collect(),
            state_sample: rows(&moments.state_sample),
            multiplied_sample: moments.multiplied_sample.as_ref().map(rows),
            sample: rows(&moments.sample),
            multiplied_disturbance: rows(&moments.multiplied_disturbance),
            disturbance: rows(&moments.disturbance),
            held: moments.held.as_ref().map(held),
            dead_zone: moments.dead_zone.as_ref().map(|zone| DeadZoneMomentsFile {
                multiplied_zone: rows(&zone.multiplied),
                held_zone: rows(&zone.held),
                zone: rows(&zone.own),
            }),
        }
    }

    fn moments(&self, model: &Model, given: bool) -> Result<Moments, ModelError> {
        let (n, m, d, _) = model.plant.sizes();
        let count = model.plant.nominal().takagi_sugeno().vertices.len();
        let square = (Some(n), Some(n));
        let vertices = self.vertices.iter().enumerate().map(|(index, weight)| {
            let field = format!("vertices[{index}]");
            if !(1..=count).contains(&weight.vertex) {
                return Err(ModelError::OutOfRange {
                    field: format!("{field}.vertex"),
                    value: weight.vertex as f64,
                    allowed: format!("1 to {count}"),
                });
            }
            Ok(VertexDual {
                vertex: weight.vertex - 1,
                moments: symmetric(&format!("{field}.moments"), &weight.moments, 2 * n)?,
            })
        });
        let multiplied_sample = self.multiplied_sample.as_ref();
        let multiplied_sample =
            multiplied_sample.map(|rows| check_matrix("multiplied_sample", rows, square));
        let held = self.held.as_ref().map(|held| {
            Ok(HeldMoments {
                multiplied_held: check_matrix(
                    "held.multiplied_held",
                    &held.multiplied_held,
                    square,
                )?,
                sample_held: check_matrix("held.sample_held", &held.sample_held, square)?,
                held: symmetric("held.held", &held.held, n)?,
            })
        });
        if self.dead_zone.is_some() != given {
            return Err(ModelError::WrongShape {
                field: "dead_zone".to_string(),
                found: if given { "nothing" } else { "moments" }.to_string(),
                expected: "moments of the dead zone exactly where gains are given".to_string(),
            });
        }
        let dead_zone = self.dead_zone.as_ref().map(|zone| {
            let tall = (Some(n), Some(m));
            Ok(DeadZoneMoments {
                multiplied: check_matrix("dead_zone.multiplied_zone", &zone.multiplied_zone, tall)?,
                held: check_matrix("dead_zone.held_zone", &zone.held_zone, tall)?,
                own: symmetric("dead_zone.zone", &zone.zone, m)?,
            })
        });
        Ok(Moments {
            vertices: vertices.collect::<Result<_, _>>()?,
            state_sample: check_matrix("state_sample", &self.state_sample, square)?,
            multiplied_sample: multiplied_sample.transpose()?,
            sample: symmetric("sample", &self.sample, n)?,
            multiplied_disturbance: check_matrix(
                "multiplied_disturbance",
                &self.multiplied_disturbance,
                (Some(n), Some(d)),
            )?,
            disturbance: symmetric("disturbance", &self.disturbance, d)?,
            held: held.transpose()?,
            dead_zone: dead_zone.transpose()?,
        })
    }
}

fn check_length(field: &str, found: usize, expected: usize) -> Result<(), ModelError> {
    if found == expected {
        return Ok(());
    }
    Err(ModelError::WrongShape {
        field: field.to_string(),
        found: format!("{found} entries"),
        expected: format!("{expected} entries"),
    })
}

fn symmetric(field: &str, rows: &[Vec<f64>], side: usize) -> Result<DMatrix<f64>, ModelError> {
    let matrix = check_matrix(field, rows, (Some(side), Some(side)))?;
    check_symmetric(field, &matrix)?;
    Ok(matrix)
}
