//! What a run of a Takagi-Sugeno plant is measured by.

use nalgebra::SVector;
use runtime::command::Command;

use crate::base::table::Table;
use crate::sim::closed_loop::Observer;
use crate::sim::effort::Effort;
use crate::sim::events::EventCount;
use crate::sim::lyapunov::LyapunovMonitor;
use crate::sim::pointing::ErrorStatistics;
use crate::sim::profile::Profile;
use crate::sim::recorder::Recorder;

/// Metrics, certificate and trajectory of one run, for a padded state.
#[derive(Debug, Clone)]
pub struct StateLog<const N: usize, const M: usize> {
    states: usize,
    inputs: usize,
    /// Samples and messages.
    pub events: EventCount,
    /// Input.
    pub effort: Effort<M>,
    /// Norm of the state.
    pub error: ErrorStatistics,
    /// Integration steps.
    pub steps: u64,
    /// State at the start.
    pub start: SVector<f64, N>,
    /// State at the end of the last step.
    pub last: SVector<f64, N>,
    /// The certificate's claims along the run.
    pub lyapunov: LyapunovMonitor<N>,
    /// Norm of the state on a grid of times.
    pub profile: Profile,
    recorder: Option<Recorder>,
    input: SVector<f64, M>,
}

impl<const N: usize, const M: usize> StateLog<N, M> {
    /// Nothing yet, for `states` states and `inputs` inputs.
    pub fn new(
        (states, inputs): (usize, usize),
        settle_tolerance: f64,
        tail_from_s: f64,
        lyapunov: LyapunovMonitor<N>,
        interval_s: Option<f64>,
    ) -> Self {
        let numbered = |name: &str, count: usize| -> Vec<String> {
            (1..=count).map(|index| format!("{name}_{index}")).collect()
        };
        let mut columns = vec!["time_s".to_string()];
        columns.extend(numbered("state", states));
        columns.extend(numbered("input", inputs));
        let rest = ["state_norm", "sent", "lyapunov", "lyapunov_bound"];
        columns.extend(rest.map(str::to_string));
        Self {
            states,
            inputs,
            events: EventCount::default(),
            effort: Effort::new(),
            error: ErrorStatistics::new(settle_tolerance, tail_from_s),
            steps: 0,
            start: SVector::zeros(),
            last: SVector::zeros(),
            lyapunov,
            profile: Profile::new(&[], 1),
            recorder: interval_s.map(|interval| Recorder::new(columns, interval)),
            input: SVector::zeros(),
        }
    }

    /// The trajectory.
    pub fn into_table(self) -> Option<Table> {
        self.recorder.map(Recorder::into_table)
    }

    fn write(&mut self, time_s: f64, state: &SVector<f64, N>, sent: bool) {
        let Some(recorder) = &mut self.recorder else {
            return;
        };
        let mut row = vec![time_s];
        row.extend(state.iter().take(self.states));
        row.extend(self.input.iter().take(self.inputs));
        row.extend([
            state.norm(),
            f64::from(u8::from(sent)),
            self.lyapunov.level,
            self.lyapunov.bound(),
        ]);
        recorder.write(&row);
    }
}

impl<C, const N: usize, const M: usize> Observer<C, N, M, N> for StateLog<N, M> {
    fn start(&mut self, state: &SVector<f64, N>, disturbance: &SVector<f64, N>, _controller: &C) {
        self.start = *state;
        self.last = *state;
        self.error.start(state.norm_squared());
        self.lyapunov.start(state, disturbance.norm_squared());
        self.write(0.0, state, false);
        if self.profile.due(0.0) {
            self.profile.record(0.0, &[state.norm()]);
        }
    }

    fn sample(
        &mut self,
        time_s: f64,
        state: &SVector<f64, N>,
        command: &Command<M>,
        mismatch: Option<f64>,
        _controller: &C,
    ) {
        self.events.record(time_s, command, mismatch);
        if command.sent {
            self.write(time_s, state, true);
        }
    }

    fn hold(&mut self, time_s: f64, input: &SVector<f64, M>) {
        self.effort.begin(input);
        self.input = *input;
        let (first, inputs) = (1 + self.states, self.inputs);
        if let Some(row) = self.recorder.as_mut().and_then(|r| r.last_row_at(time_s)) {
            row[first..first + inputs].copy_from_slice(&input.as_slice()[..inputs]);
        }
    }

    fn held(&mut self, span_s: f64, input: &SVector<f64, M>) {
        self.effort.end(span_s, input);
    }

    fn step(
        &mut self,
        time_s: f64,
        step_s: f64,
        state: &SVector<f64, N>,
        disturbance: &SVector<f64, N>,
        _controller: &C,
    ) {
        self.steps += 1;
        let square = state.norm_squared();
        self.error.record(time_s, step_s, square, || square);
        self.lyapunov
            .step(time_s, step_s, state, disturbance.norm_squared());
        self.last = *state;
        if self.profile.due(time_s) {
            self.profile.record(time_s, &[state.norm()]);
        }
        if self
            .recorder
            .as_ref()
            .is_some_and(|recorder| recorder.due(time_s))
        {
            self.write(time_s, state, false);
        }
    }
}
