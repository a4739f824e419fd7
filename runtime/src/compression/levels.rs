//! Which step belongs to which magnitude of the command: Yang et al. 2025, (21)-(22).

use crate::error::{AllowedRange, Field, ParameterError};

/// One interval of the command's magnitude and the step that belongs to it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Level {
    /// Lower end of the interval, N m.
    pub from: f64,
    /// Threshold of the trigger and size of the step in it, N m.
    pub threshold: f64,
}

/// Levels of one axis, counted from zero at the smallest magnitude.
///
/// The paper writes the step of level h as o_h z^h. With the coefficients it gives (its Table 3) these
/// steps exceed twice the torque limit, so that they could never be made: the coefficients are taken
/// for the steps themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Levels<const L: usize> {
    /// Given one by one: the first `count` of them. The first interval begins at zero.
    Table {
        /// The levels.
        levels: [Level; L],
        /// How many of them are used.
        count: usize,
    },
    /// Intervals of equal width up to the limit, and steps that grow evenly from level to level.
    Even {
        /// Number of levels.
        count: u32,
        /// Step of level 0, N m.
        smallest_threshold: f64,
        /// Step of the last level, N m; that of level 0 when there is only one level.
        largest_threshold: f64,
    },
}

impl<const L: usize> Levels<L> {
    /// Levels given one by one; `None` when there are more than `L`.
    pub fn table(given: &[Level]) -> Option<Self> {
        if given.len() > L {
            return None;
        }
        let mut levels = [Level::default(); L];
        for (place, level) in levels.iter_mut().zip(given) {
            *place = *level;
        }
        Some(Self::Table {
            levels,
            count: given.len(),
        })
    }

    /// Number of levels.
    pub fn count(&self) -> u32 {
        match self {
            Self::Table { levels, count } => {
                u32::try_from(levels.len().min(*count)).unwrap_or(u32::MAX)
            }
            Self::Even { count, .. } => *count,
        }
    }

    /// The level of a command's magnitude, N m, for an axis with this limit.
    pub fn level(&self, magnitude: f64, limit: f64) -> u32 {
        match self {
            Self::Table { levels, count } => {
                let used = levels.iter().take(*count);
                let reached = used.take_while(|level| magnitude >= level.from).count();
                u32::try_from(reached).unwrap_or(u32::MAX).saturating_sub(1)
            }
            Self::Even { count, .. } => {
                // A conversion of a number that does not fit gives the nearest one that does.
                let level = libm::floor(magnitude / limit * f64::from(*count)) as u32;
                level.min(count.saturating_sub(1))
            }
        }
    }

    /// The step of a level, N m; `None` for a level that is not there.
    pub fn threshold(&self, level: u32) -> Option<f64> {
        if level >= self.count() {
            return None;
        }
        match self {
            Self::Table { levels, .. } => {
                let index = usize::try_from(level).ok()?;
                levels.get(index).map(|level| level.threshold)
            }
            Self::Even {
                count,
                smallest_threshold,
                largest_threshold,
            } => {
                let last = f64::from(count.saturating_sub(1).max(1));
                let share = f64::from(level) / last;
                Some(smallest_threshold + (largest_threshold - smallest_threshold) * share)
            }
        }
    }

    /// Checks the levels of `axis` for its limit and the number of levels that a word can name.
    pub(super) fn check(&self, axis: usize, limit: f64, most: u32) -> Result<(), ParameterError> {
        let step = AllowedRange::left_open(0.0, 2.0 * limit);
        let count = |most, used| {
            AllowedRange::closed(1.0, most).check(Field::component("level_count", axis), used)
        };
        match self {
            Self::Table {
                levels,
                count: used,
            } => {
                count(f64::from(most).min(levels.len() as f64), *used as f64)?;
                let mut lower = AllowedRange::closed(0.0, 0.0);
                for (index, level) in levels.iter().take(*used).enumerate() {
                    let field = |name| Field::entry(name, axis, index);
                    lower.check(field("from"), level.from)?;
                    step.check(field("threshold"), level.threshold)?;
                    lower = AllowedRange::open(level.from, limit);
                }
                Ok(())
            }
            Self::Even {
                count: used,
                smallest_threshold,
                largest_threshold,
            } => {
                count(f64::from(most), f64::from(*used))?;
                let field = |name| Field::component(name, axis);
                step.check(field("smallest_threshold"), *smallest_threshold)?;
                step.check(field("largest_threshold"), *largest_threshold)
            }
        }
    }
}
