//! An axis of a figure: its ends, its spacing and where its numbers stand.

use std::ops::Range;

use crate::base::number::{tick, tick_of_logarithm};

/// Fraction of the value range left free at both ends.
const HEADROOM: f64 = 0.06;
/// Ratio of the largest to the smallest value from which on a fitting scale is logarithmic.
const LOGARITHMIC_FROM: f64 = 30.0;

/// How the values of an axis are spaced.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Spacing {
    /// At equal distances.
    #[default]
    Linear,
    /// At equal ratios.
    Logarithmic,
    /// At equal ratios where all values are above 0 and far apart, else at equal distances.
    Fitting,
    /// A row of cells with these names, the first of which is at 0.
    Cells(Vec<String>),
}

/// An axis.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlotAxis {
    /// Name and unit.
    pub label: String,
    /// How its values are spaced.
    pub spacing: Spacing,
    /// Its ends; those of the values, with headroom, when left out.
    pub ends: Option<(f64, f64)>,
}

impl PlotAxis {
    /// An axis whose ends are those of its values.
    pub fn new(label: impl Into<String>, spacing: Spacing) -> Self {
        PlotAxis {
            label: label.into(),
            spacing,
            ends: None,
        }
    }

    /// An axis between two ends.
    pub fn between(label: impl Into<String>, start: f64, end: f64) -> Self {
        PlotAxis {
            ends: Some((start, end)),
            ..PlotAxis::new(label, Spacing::Linear)
        }
    }

    /// The axis as it is drawn, with a place for all of the values.
    pub fn scale(&self, values: impl Iterator<Item = f64>) -> Scale<'_> {
        let finite: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        let names: &[String] = match &self.spacing {
            Spacing::Cells(names) => names,
            _ => &[],
        };
        let mut scale = Scale {
            range: -0.5..names.len() as f64 - 0.5,
            logarithmic: match self.spacing {
                Spacing::Linear | Spacing::Cells(_) => false,
                Spacing::Logarithmic => true,
                Spacing::Fitting => ends(finite.iter().copied())
                    .is_some_and(|(low, high)| low > 0.0 && high / low >= LOGARITHMIC_FROM),
            },
            names,
        };
        if names.is_empty() {
            let places = finite.iter().map(|&value| scale.place(value));
            let places = ends(places.filter(|place| place.is_finite()));
            scale.range = match (self.ends, places) {
                (Some((start, end)), _) => start..end,
                (None, None) => 0.0..1.0,
                (None, Some((low, high))) => {
                    let size = high.abs().max(low.abs());
                    let wide = high - low > 1e-12 * size;
                    let width = if wide { high - low } else { size.max(1e-9) };
                    low - HEADROOM * width..high + HEADROOM * width
                }
            };
        }
        scale
    }
}

/// The smallest and the largest value.
pub fn ends(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |ends, value| {
        let (low, high) = ends.unwrap_or((value, value));
        Some((low.min(value), high.max(value)))
    })
}

/// An axis as it is drawn: the places of values, and the numbers at places.
pub struct Scale<'a> {
    /// The places of its ends.
    pub range: Range<f64>,
    logarithmic: bool,
    /// The names of its cells.
    pub names: &'a [String],
}

impl Scale<'_> {
    /// Where a value stands; not finite for what a logarithm does not have.
    pub fn place(&self, value: f64) -> f64 {
        match self.logarithmic {
            true => value.log10(),
            false => value,
        }
    }

    /// What stands at a place of the axis.
    pub fn tick(&self, place: f64) -> String {
        match (self.names, self.logarithmic) {
            ([], true) => tick_of_logarithm(place),
            // Ten ticks at most.
            ([], false) => tick(place, 0.1 * (self.range.end - self.range.start)),
            (names, _) => {
                let own = (place - place.round()).abs() < 1e-9 && place > -0.5;
                let name = names.get(place.round() as usize).filter(|_| own);
                name.cloned().unwrap_or_default()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use plotters::coord::ranged1d::Ranged;
    use plotters::coord::types::RangedCoordf64;

    use super::*;

    fn fitting() -> PlotAxis {
        PlotAxis::new("", Spacing::Fitting)
    }

    fn ticks(values: &[f64]) -> Vec<String> {
        let axis = fitting();
        let scale = axis.scale(values.iter().copied());
        let places = RangedCoordf64::from(scale.range.clone()).key_points(6);
        places.into_iter().map(|place| scale.tick(place)).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        assert_eq!(ticks(&[0.0, 1.0]), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        let ticks_from_0 = ["0", "0.05", "0.1", "0.15", "0.2"];
        assert_eq!(ticks(&[0.01, 0.2]), ticks_from_0);
        assert_eq!(ticks(&[1e-4, 1.0]), ["1e-4", "0.001", "0.01", "0.1", "1"]);
        assert_eq!(ticks(&[-3.0, 3.0]), ["-2", "0", "2"]);
    }

    #[test]
    fn values_that_are_all_the_same_and_no_values_have_a_scale_too() {
        for values in [&[][..], &[0.0], &[5.0, 5.0], &[f64::NAN]] {
            let Range { start, end } = fitting().scale(values.iter().copied()).range;
            assert!(start < end, "{values:?}: {start} to {end}");
        }
    }

    #[test]
    fn ends_are_mapped_to_the_ends() {
        for values in [[1.0, 2.0], [1.0, 1000.0]] {
            let range = fitting().scale(values.into_iter()).range;
            let coordinate = RangedCoordf64::from(range.clone());
            assert_eq!(coordinate.map(&range.start, (10, 110)), 10);
            assert_eq!(coordinate.map(&range.end, (10, 110)), 110);
        }
    }

    #[test]
    fn cells_have_their_names_in_the_middle() {
        let names = ["a", "b"].map(str::to_string).to_vec();
        let axis = PlotAxis::new("", Spacing::Cells(names));
        let scale = axis.scale(std::iter::empty());
        assert_eq!(scale.range, -0.5..1.5);
        assert_eq!(
            [0.0, 0.5, 1.0, 2.0].map(|place| scale.tick(place)),
            ["a", "", "b", ""]
        );
    }
}
