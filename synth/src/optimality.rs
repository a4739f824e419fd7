//! The gap between a proved design and the best objective that any solver reported.

use serde::Serialize;

/// Above this relative gap a report notes that the design is worse than the best objective seen.
const POOR: f64 = 0.01;

/// A design's objective and the best one that a solver reported for the same problem. The best one is the
/// solver's number and not proved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Optimality {
    /// The best objective that a solver reported, in the design's unit.
    pub best_seen: f64,
    /// How much worse the design is, relative to the best objective seen; 0 where it is not worse.
    pub relative_gap: f64,
}

impl Optimality {
    /// For an objective of which smaller is better; `None` without two positive finite numbers.
    pub fn of_smallest(found: f64, best_seen: f64) -> Option<Self> {
        Self::new(found / best_seen, best_seen)
    }

    /// For an objective of which larger is better; `None` without two positive finite numbers.
    pub fn of_largest(found: f64, best_seen: f64) -> Option<Self> {
        Self::new(best_seen / found, best_seen)
    }

    fn new(ratio: f64, best_seen: f64) -> Option<Self> {
        let usable = ratio > 0.0 && ratio.is_finite() && best_seen > 0.0 && best_seen.is_finite();
        usable.then_some(Optimality {
            best_seen,
            relative_gap: (ratio - 1.0).max(0.0),
        })
    }

    /// True when the design is worse than the best objective seen by more than 1 %.
    pub fn is_poor(&self) -> bool {
        self.relative_gap > POOR
    }

    /// What a verdict line adds for a design that [is poor](Optimality::is_poor).
    pub fn remark(&self) -> Option<String> {
        self.is_poor().then(|| {
            format!(
                "{:.3} times worse than the best objective that a solver reported ({:.6}, not proved)",
                1.0 + self.relative_gap,
                self.best_seen
            )
        })
    }
}
