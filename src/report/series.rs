//! Lines of a figure, thinned to what a screen can show.

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// Connected.
    Line,
    /// Dots.
    Dot,
}

/// A named sequence of points (time in s, value).
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Points in order of time.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub mark: Mark,
}

/// Columns of a figure that keep at most four points each.
const BUCKETS: usize = 700;

impl Line {
    /// Connected points.
    pub fn connected(name: &str, times: &[f64], values: &[f64]) -> Self {
        let points: Vec<_> = times.iter().copied().zip(values.iter().copied()).collect();
        Self {
            name: name.to_string(),
            points: thinned(&points),
            mark: Mark::Line,
        }
    }

    /// Values that hold until the next time.
    pub fn held(name: &str, times: &[f64], values: &[f64]) -> Self {
        let mut points = Vec::with_capacity(2 * times.len());
        for (index, (&time, &value)) in times.iter().zip(values).enumerate() {
            points.push((time, value));
            if let Some(&next) = times.get(index + 1) {
                points.push((next, value));
            }
        }
        Self {
            name: name.to_string(),
            points: thinned(&points),
            mark: Mark::Line,
        }
    }

    /// Dots at the times at which something happened: the time since the last of them.
    pub fn intervals(name: &str, times: &[f64]) -> Self {
        let pairs = times.windows(2);
        let points: Vec<_> = pairs.map(|pair| (pair[1], pair[1] - pair[0])).collect();
        Self {
            name: name.to_string(),
            points: thinned(&points),
            mark: Mark::Dot,
        }
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
        let extreme = |largest: bool| {
            let indices = 0..group.len();
            let order = |&a: &usize, &b: &usize| group[a].1.total_cmp(&group[b].1);
            if largest {
                indices.max_by(order)
            } else {
                indices.min_by(order)
            }
        };
        let mut picked = [
            0,
            extreme(false).unwrap_or(0),
            extreme(true).unwrap_or(0),
            group.len() - 1,
        ];
        picked.sort_unstable();
        let mut last = None;
        for index in picked {
            if last != Some(index) {
                kept.push(group[index]);
            }
            last = Some(index);
        }
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
        let line = Line::held("u", &[0.0, 1.0, 3.0], &[5.0, 6.0, 7.0]);
        let steps = [(0.0, 5.0), (1.0, 5.0), (1.0, 6.0), (3.0, 6.0), (3.0, 7.0)];
        assert_eq!(line.points, steps);
    }
}
