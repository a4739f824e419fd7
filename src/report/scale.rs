//! An axis of a plot: its range, its scale and where its numbers stand.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

use crate::base::number::label;

/// Fraction of the range left free at both ends.
const HEADROOM: f64 = 0.05;
/// Ratio of the largest to the smallest value from which on a scale is logarithmic.
const LOGARITHMIC_FROM: f64 = 30.0;

/// A linear or logarithmic axis with its ticks.
#[derive(Debug, Clone, PartialEq)]
pub struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
    ticks: Vec<(f64, String)>,
}

impl Scale {
    /// An axis on which all of the values have a place, with about `count` ticks. It is logarithmic where
    /// the values are above 0 and far apart.
    pub fn of(values: impl Iterator<Item = f64>, count: usize) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let range = finite.fold(None, |range: Option<(f64, f64)>, value| {
            let (low, high) = range.unwrap_or((value, value));
            Some((low.min(value), high.max(value)))
        });
        let (low, high) = range.unwrap_or((0.0, 1.0));
        let logarithmic = low > 0.0 && high / low >= LOGARITHMIC_FROM;
        if logarithmic {
            let room = (high / low).powf(HEADROOM);
            let (low, high) = (low / room, high * room);
            return Scale {
                low,
                high,
                logarithmic,
                ticks: logarithmic_ticks(low, high, count),
            };
        }
        let width = match high - low {
            width if width > 1e-12 * high.abs().max(low.abs()) => width,
            _ => high.abs().max(1e-9),
        };
        let (low, high) = (low - HEADROOM * width, high + HEADROOM * width);
        Scale {
            low,
            high,
            logarithmic,
            ticks: linear_ticks(low, high, count),
        }
    }

    /// A row of cells of width 1, from 0 on, with a name in the middle of each as far as there is room
    /// for `count` of them.
    pub fn cells(names: &[String], count: usize) -> Self {
        let step = names.len().div_ceil(count.max(1)).max(1);
        let named = names.iter().enumerate().step_by(step);
        Scale {
            low: 0.0,
            high: names.len().max(1) as f64,
            logarithmic: false,
            ticks: named
                .map(|(index, name)| (index as f64 + 0.5, name.clone()))
                .collect(),
        }
    }

    /// The lower end.
    pub fn low(&self) -> f64 {
        self.low
    }

    fn fraction(&self, value: f64) -> f64 {
        match self.logarithmic {
            true => (value / self.low).ln() / (self.high / self.low).ln(),
            false => (value - self.low) / (self.high - self.low),
        }
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let fraction = self.fraction(*value);
        from + (f64::from(to - from) * fraction).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _hint: Hint) -> Vec<f64> {
        self.ticks.iter().map(|(value, _)| *value).collect()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Scale {
    fn format_ext(&self, value: &f64) -> String {
        let tick = self.ticks.iter().find(|(own, _)| own == value);
        tick.map_or(String::new(), |(_, text)| text.clone())
    }
}

fn linear_ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let raw = (high - low) / count.max(1) as f64;
    let unit = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * unit);
    let step = step.into_iter().find(|step| *step >= raw * 0.999);
    let step = step.unwrap_or(raw);
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    if !(first.is_finite() && last - first < 1000.0) {
        return Vec::new();
    }
    let values = (0..=(last - first) as i64).map(|index| (first + index as f64) * step);
    values.map(|value| (value, label(value))).collect()
}

fn logarithmic_ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let decades = (high / low).log10();
    let factors: &[f64] = match 3.0 * decades <= count as f64 + 2.0 {
        true => &[1.0, 2.0, 5.0],
        false => &[1.0],
    };
    let every = (decades / count.max(1) as f64).ceil().max(1.0) as i32;
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let powers = (first..=last).filter(|power| power.rem_euclid(every) == 0);
    let values = powers.flat_map(|power| factors.iter().map(move |f| f * 10f64.powi(power)));
    let inside = values.filter(|value| (low..=high).contains(value));
    inside.map(|value| (value, label(value))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ticks(values: &[f64]) -> Vec<String> {
        let scale = Scale::of(values.iter().copied(), 5);
        scale.ticks.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        assert_eq!(ticks(&[0.0, 1.0]), ["0", "0.5", "1"]);
        assert_eq!(ticks(&[0.01, 0.2]), ["0.05", "0.1", "0.15", "0.2"]);
        assert_eq!(ticks(&[1e-4, 1.0]), ["1e-4", "0.001", "0.01", "0.1", "1"]);
        assert_eq!(ticks(&[-3.0, 3.0]), ["-2", "0", "2"]);
    }

    #[test]
    fn values_that_are_all_the_same_and_no_values_have_a_scale_too() {
        for values in [&[][..], &[0.0], &[5.0, 5.0], &[f64::NAN]] {
            let scale = Scale::of(values.iter().copied(), 5);
            assert!(scale.low < scale.high, "{values:?}: {scale:?}");
        }
    }

    #[test]
    fn ends_are_mapped_to_the_ends() {
        for values in [[1.0, 2.0], [1.0, 1000.0]] {
            let scale = Scale::of(values.into_iter(), 5);
            assert_eq!(scale.map(&scale.low, (10, 110)), 10);
            assert_eq!(scale.map(&scale.high, (10, 110)), 110);
        }
    }
}
