//! Starting from the way to a neighbouring solution.

use super::interior_point::Measures;
use super::iterate::Point;

/// Points on the way to a solution.
#[derive(Debug, Clone, Default)]
pub struct Trail {
    points: Vec<(Point, f64)>,
}

impl Trail {
    /// Keeps a point.
    pub fn record(&mut self, point: &Point, measures: &Measures) {
        let _ = (point, measures);
        let _ = &self.points;
    }
}
