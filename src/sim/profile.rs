//! A few quantities of a run on a grid of times: what is left of its trajectory in a campaign.

/// Values at the end of the first integration step at or after each time of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    times_s: Vec<f64>,
    next: usize,
    due_s: f64,
    last: Vec<f32>,
    values: Vec<f32>,
}

impl Profile {
    /// A profile of `quantities` quantities at these times, increasing; of nothing without times.
    pub fn new(times_s: &[f64], quantities: usize) -> Self {
        Profile {
            times_s: times_s.to_vec(),
            next: 0,
            due_s: times_s.first().copied().unwrap_or(f64::INFINITY),
            last: Vec::new(),
            values: vec![f32::NAN; times_s.len() * quantities],
        }
    }

    /// Whether a value is wanted at this time.
    #[inline(always)]
    pub fn due(&self, time_s: f64) -> bool {
        time_s >= self.due_s
    }

    /// The quantities at this time.
    pub fn record(&mut self, time_s: f64, quantities: &[f64]) {
        self.last.clear();
        self.last
            .extend(quantities.iter().map(|&value| value as f32));
        while self.due(time_s) {
            self.write();
        }
    }

    fn write(&mut self) {
        let count = self.times_s.len();
        for (quantity, value) in self.last.iter().enumerate() {
            if let Some(place) = self.values.get_mut(quantity * count + self.next) {
                *place = *value;
            }
        }
        self.next += 1;
        self.due_s = self
            .times_s
            .get(self.next)
            .copied()
            .unwrap_or(f64::INFINITY);
    }

    /// The values, one quantity after the other. A time that rounding puts after the end of a run that was
    /// `completed` has the last value; what a run did not reach is not a number.
    pub fn into_values(mut self, completed: bool, quantities: &[f64]) -> Vec<f32> {
        if completed {
            self.record(f64::NEG_INFINITY, quantities);
            while self.next < self.times_s.len() {
                self.write();
            }
        }
        self.values
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_has_the_value_of_the_first_step_at_or_after_each_time() {
        let mut profile = Profile::new(&[0.0, 1.0, 2.0, 3.0], 2);
        for time in [0.0, 0.6, 1.2, 1.8, 2.4] {
            if profile.due(time) {
                profile.record(time, &[time, -time]);
            }
        }
        let completed = profile.clone().into_values(true, &[9.0, 8.0]);
        assert_eq!(completed, [0.0, 1.2, 2.4, 9.0, 0.0, -1.2, -2.4, 8.0]);
        let ended = profile.into_values(false, &[9.0, 8.0]);
        assert_eq!(ended[..3], [0.0, 1.2, 2.4]);
        assert!(ended[3].is_nan() && ended[7].is_nan());
    }
}
