//! Lines and points of a figure, thinned to what a screen can show.

use plotters::style::RGBColor;

/// Colours that colour-blind readers can tell apart (P. Tol's bright scheme).
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(68, 119, 170),
    RGBColor(238, 102, 119),
    RGBColor(34, 136, 51),
    RGBColor(204, 187, 68),
    RGBColor(102, 204, 238),
    RGBColor(170, 51, 119),
];

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Connected.
    Line,
    /// Small dots.
    Dots,
    /// Dots joined by lines.
    Joined,
    /// Dots.
    Points,
    /// Larger dots, joined by steps: first along the vertical, then along the horizontal.
    Steps,
    /// Crosses at the lower end of the figure; the vertical value does not count.
    Crosses,
}

/// A named sequence of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; empty for none.
    pub name: String,
    /// How it is drawn.
    pub mark: Mark,
    /// Its points; those of a line over time in order of time.
    pub points: Vec<(f64, f64)>,
    /// Its colour; that of its place among the series when left out.
    pub colour: Option<RGBColor>,
}

/// Columns of a figure that keep at most four points each.
const BUCKETS: usize = 700;

impl Series {
    /// Points drawn in some way.
    pub fn new(name: &str, mark: Mark, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let points: Vec<_> = points.into_iter().collect();
        Self {
            name: name.to_string(),
            mark,
            points: thinned(&points),
            colour: None,
        }
    }

    /// Connected points.
    pub fn connected(name: &str, times: &[f64], values: &[f64]) -> Self {
        let points = times.iter().copied().zip(values.iter().copied());
        Self::new(name, Mark::Line, points)
    }

    /// Values that hold until the next time.
    pub fn held(name: &str, times: &[f64], values: &[f64]) -> Self {
        let ends = times.iter().skip(1).map(|&next| Some(next)).chain([None]);
        let points = times.iter().zip(values).zip(ends);
        let steps = points.flat_map(|((&time, &value), end)| {
            let end = end.map(|end| (end, value));
            [(time, value)].into_iter().chain(end)
        });
        Self::new(name, Mark::Line, steps)
    }

    /// Dots at the times at which something happened: the time since the last of them.
    pub fn intervals(name: &str, times: &[f64]) -> Self {
        let pairs = times.windows(2);
        Self::new(
            name,
            Mark::Dots,
            pairs.map(|pair| (pair[1], pair[1] - pair[0])),
        )
    }

    /// Its colour as the series of a figure with this index.
    pub fn colour(&self, index: usize) -> RGBColor {
        self.colour.unwrap_or(COLOURS[index % COLOURS.len()])
    }
}

/// The first, the last, the smallest and the largest point of every bucket of time.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if points.len() <= 4 * BUCKETS {
        return points.to_vec();
    }
    let (start, end) = (points[0].0, points[points.len() - 1].0);
    let bucket = |time: f64| ((time - start) / (end - start) * BUCKETS as f64) as usize;
    let mut kept = Vec::with_capacity(4 * BUCKETS);
    for group in points.chunk_by(|a, b| bucket(a.0) == bucket(b.0)) {
        let order = |&a: &usize, &b: &usize| group[a].1.total_cmp(&group[b].1);
        let smallest = (0..group.len()).min_by(order).unwrap_or(0);
        let largest = (0..group.len()).max_by(order).unwrap_or(0);
        let mut picked = vec![0, smallest, largest, group.len() - 1];
        picked.sort_unstable();
        picked.dedup();
        kept.extend(picked.into_iter().map(|index| group[index]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_the_extremes_and_the_ends() {
        let mut points: Vec<_> = (0..100_000)
            .map(|index| (f64::from(index), (f64::from(index) * 1e-3).sin()))
            .collect();
        points[55_555].1 = 9.0;
        points[44_444].1 = -9.0;
        let thin = thinned(&points);
        assert!(thin.len() <= 4 * (BUCKETS + 1));
        assert!(thin.contains(&(55_555.0, 9.0)) && thin.contains(&(44_444.0, -9.0)));
        assert_eq!((thin.first(), thin.last()), (points.first(), points.last()));
        assert!(thin.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }

    #[test]
    fn held_values_make_steps() {
        let line = Series::held("u", &[0.0, 1.0, 3.0], &[5.0, 6.0, 7.0]);
        let steps = [(0.0, 5.0), (1.0, 5.0), (1.0, 6.0), (3.0, 6.0), (3.0, 7.0)];
        assert_eq!(line.points, steps);
    }
}
