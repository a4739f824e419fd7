//! What a run leaves: metrics, the certificate's claims, the profile and the trajectory.

use nalgebra::SVector;
use runtime::command::Command;
use runtime::lei2022::SwitchCount;

use super::design::Design;
use super::imperfections::Flown;
use super::inner::InnerMonitor;
use super::outcome::Recording;
use crate::base::table::Table;
use crate::scenario::Scenario;
use crate::sim::bench::Gauge;
use crate::sim::bound_utilisation::BoundUtilisation;
use crate::sim::closed_loop::Observer;
use crate::sim::controller::Controller;
use crate::sim::effort::Effort;
use crate::sim::events::EventCount;
use crate::sim::link::LinkOutcome;
use crate::sim::lyapunov::LyapunovMonitor;
use crate::sim::metrics::Measured;
use crate::sim::network::NetworkOutcome;
use crate::sim::pointing::ErrorStatistics;
use crate::sim::profile::Profile;
use crate::sim::recorder::Recorder;

/// Most samples of a run whose trajectory has a row for each.
const MOST_SAMPLE_ROWS: f64 = 1e6;

/// Whether the trajectory of a scenario has a row for each sample. One with more samples than a table should have rows
/// has those at which a message was sent.
pub(crate) fn has_every_sample(scenario: &Scenario) -> bool {
    let expected = scenario.instants.expected_samples(scenario.duration_s);
    expected.is_none_or(|samples| samples <= MOST_SAMPLE_ROWS)
}

/// Metrics, certificate, profile and trajectory of one run of a plant.
#[derive(Debug, Clone)]
pub(crate) struct Log<G, const N: usize, const M: usize, const D: usize, const L: usize>
where
    G: Gauge<N, M, D, L>,
{
    /// What the state is measured by.
    pub gauge: G,
    /// Samples and messages.
    pub events: EventCount,
    /// What acts.
    pub effort: Effort<M>,
    /// The error.
    pub error: ErrorStatistics,
    /// Integration steps.
    pub steps: u64,
    /// What was seen at the start.
    pub start: Option<G::Seen>,
    /// What was seen at the end of the last step.
    pub last: Option<G::Seen>,
    /// A certificate's claims along the run.
    pub lyapunov: Option<LyapunovMonitor<L>>,
    /// Those of the inner one, where there are two.
    pub inner: Option<InnerMonitor<L>>,
    /// What the link carried, where there is one.
    pub link: Option<LinkOutcome>,
    /// What the network did, where there is one.
    pub network: Option<NetworkOutcome>,
    /// The largest errors of the sensor.
    pub measurement_errors: Vec<f64>,
    /// Use of the controller's prescribed bounds.
    pub funnel: Option<BoundUtilisation>,
    /// Use of its trigger's threshold.
    pub threshold: Option<BoundUtilisation>,
    /// How often it switched the actuators.
    pub switches: Option<SwitchCount>,
    profile: Profile,
    recorder: Option<Recorder>,
    every_sample: bool,
    row: Vec<f64>,
    link_steps: Option<[f64; M]>,
    input: SVector<f64, M>,
    disturbance: SVector<f64, D>,
}

impl<G, const N: usize, const M: usize, const D: usize, const L: usize> Log<G, N, M, D, L>
where
    G: Gauge<N, M, D, L>,
{
    /// Nothing yet. The controller's `signals` are columns of the trajectory, as are the steps on the link
    /// where there is one. `reference_jumps_s`: when the error jumps.
    pub fn new(
        gauge: G,
        scenario: &Scenario,
        design: Option<&Design>,
        recording: &Recording,
        (signals, linked): (&[&str], bool),
        reference_jumps_s: Vec<f64>,
    ) -> Self {
        let lyapunov = design.map(|design| LyapunovMonitor::new(design.claims()));
        let inner = design.and_then(|design| {
            let claims = design.inner_claims()?;
            Some(InnerMonitor::new(claims, design.hand_over()))
        });
        let mut columns = vec!["time_s".to_string()];
        columns.extend(gauge.columns());
        let mut add = |names: &[&str]| columns.extend(names.iter().map(|name| name.to_string()));
        add(&["sample", "sent"]);
        if lyapunov.is_some() {
            add(&["lyapunov", "lyapunov_bound"]);
        }
        if inner.is_some() {
            add(&["inner_lyapunov", "inner_lyapunov_bound"]);
        }
        add(signals);
        if linked {
            columns.extend((1..=M).map(|axis| format!("link_step_{axis}")));
        }
        let tail_from_s = scenario.duration_s - scenario.tail_s;
        Self {
            error: ErrorStatistics::new(gauge.settle_tolerance(), tail_from_s)
                .with_jumps(reference_jumps_s),
            gauge,
            events: EventCount::default(),
            effort: Effort::new(),
            steps: 0,
            start: None,
            last: None,
            lyapunov,
            inner,
            link: None,
            network: None,
            measurement_errors: Vec::new(),
            funnel: None,
            threshold: None,
            switches: None,
            profile: Profile::new(recording.profile_times_s, G::QUANTITIES.len()),
            row: Vec::with_capacity(columns.len()),
            every_sample: has_every_sample(scenario),
            link_steps: linked.then_some([0.0; M]),
            recorder: recording
                .trajectory
                .then(|| Recorder::new(columns, scenario.output_interval_s)),
            input: SVector::zeros(),
            disturbance: SVector::zeros(),
        }
    }

    /// What the run had of what a design's model may allow.
    pub fn imperfections(&self) -> Flown {
        Flown {
            measurement: self.measurement_errors.clone(),
            network: self.network.clone(),
            momentum: self.gauge.momentum_peaks(),
        }
    }

    /// What was measured in a run of `duration_s` seconds, but for violations.
    pub fn measured(&self, duration_s: f64) -> Measured {
        let mut measured = Measured {
            settle_seconds: self.error.settle_seconds(),
            settle_crossing_s: self.error.settle_crossing_s(),
            turn_ons: self.switches.map(|count| u64::from(count.on)),
            turn_offs: self.switches.map(|count| u64::from(count.off)),
            ..Measured::of(&self.events, &self.effort, duration_s)
        };
        if let Some(last) = &self.last {
            self.gauge.measure(&self.error, last, &mut measured);
        }
        measured
    }

    /// The profile of a run that was `completed` or diverged, and the trajectory.
    pub fn into_records(self, completed: bool) -> (Vec<f32>, Option<Table>) {
        let last = self.last.as_ref().map(|last| self.gauge.quantities(last));
        let last = last.unwrap_or_default();
        let profile = self.profile.into_values(completed, &last);
        (profile, self.recorder.map(Recorder::into_table))
    }

    /// A row at `time_s`: whether a sample reached the controller there, and whether a message was sent.
    fn write<C: Controller<G::Seen, M>>(
        &mut self,
        time_s: f64,
        seen: &G::Seen,
        [sample, sent]: [bool; 2],
        controller: &C,
    ) {
        let Some(recorder) = &mut self.recorder else {
            return;
        };
        let row = &mut self.row;
        row.clear();
        row.push(time_s);
        self.gauge.write(seen, &self.input, &self.disturbance, row);
        row.extend([sample, sent].map(|flag| f64::from(u8::from(flag))));
        if let Some(monitor) = &self.lyapunov {
            row.extend([monitor.level, monitor.bound()]);
        }
        if let Some(inner) = &self.inner {
            row.extend(inner.columns());
        }
        let first = row.len();
        row.resize(first + controller.signal_names().len(), 0.0);
        controller.signals(time_s, seen, &mut row[first..]);
        if let Some(steps) = &self.link_steps {
            row.extend(if sent { *steps } else { [0.0; M] });
        }
        recorder.write(row);
    }

    /// What is watched at the start and at the end of each step.
    #[inline(always)]
    fn watch<C: Controller<G::Seen, M>>(
        &mut self,
        time_s: f64,
        state: &SVector<f64, N>,
        seen: &G::Seen,
        controller: &C,
    ) {
        self.gauge.watch(state);
        let funnel = controller.funnel_ratio(time_s, seen);
        BoundUtilisation::record(&mut self.funnel, time_s, funnel);
        let threshold = controller.threshold_ratio(time_s, seen);
        BoundUtilisation::record(&mut self.threshold, time_s, threshold);
        if self.profile.due(time_s) {
            self.profile.record(time_s, &self.gauge.quantities(seen));
        }
    }
}

impl<C, G, const N: usize, const M: usize, const D: usize, const L: usize> Observer<C, N, M, D>
    for Log<G, N, M, D, L>
where
    C: Controller<G::Seen, M>,
    G: Gauge<N, M, D, L>,
{
    fn start(&mut self, state: &SVector<f64, N>, disturbance: &SVector<f64, D>, controller: &C) {
        let seen = self.gauge.see(0.0, state);
        (self.start, self.last) = (Some(seen), Some(seen));
        self.disturbance = *disturbance;
        self.error.start(self.gauge.settling_square(&seen));
        let none = SVector::zeros();
        let square = self
            .gauge
            .acting_disturbance(state, &none, disturbance)
            .norm_squared();
        if let Some(monitor) = &mut self.lyapunov {
            monitor.start(&self.gauge.certified(&seen), square);
        }
        if let Some(inner) = &mut self.inner {
            inner.start(&self.gauge.certified(&seen), square);
        }
        self.watch(0.0, state, &seen, controller);
        self.write(0.0, &seen, [false; 2], controller);
    }

    #[inline]
    fn sample(
        &mut self,
        time_s: f64,
        state: &SVector<f64, N>,
        command: &Command<M>,
        mismatch: Option<f64>,
        controller: &C,
    ) {
        self.events.record(time_s, command, mismatch);
        self.switches = controller.switch_count();
        if let Some(inner) = &mut self.inner {
            let seen = self.gauge.see(time_s, state);
            inner.sample(time_s, &self.gauge.certified(&seen), command.sent);
        }
        let row = self.recorder.as_mut();
        if let Some(due) = row.map(|recorder| recorder.last_row_at(time_s).is_some()) {
            // Every sample has its row, so that the controller's columns are those after the sample, and what was
            // sampled when can be replayed.
            let transmitted = self.link_steps.iter().flatten().any(|&step| step != 0.0);
            let sent = command.sent || transmitted;
            if sent || due || self.every_sample {
                let seen = self.gauge.see(time_s, state);
                self.write(time_s, &seen, [true, sent], controller);
            }
        }
    }

    fn measured(&mut self, largest_errors: &[f64]) {
        self.measurement_errors.clear();
        self.measurement_errors.extend_from_slice(largest_errors);
    }

    fn in_force(&mut self, time_s: f64) {
        if let Some(monitor) = &mut self.lyapunov {
            monitor.in_force(time_s);
        }
        if let Some(inner) = &mut self.inner {
            inner.monitor.in_force(time_s);
        }
    }

    fn transmitted(&mut self, steps: &[f64; M]) {
        self.link_steps = Some(*steps);
    }

    #[inline]
    fn hold(
        &mut self,
        time_s: f64,
        input: &SVector<f64, M>,
        disturbance: &SVector<f64, D>,
        controller: &C,
    ) {
        self.effort.begin(input);
        let jumps = (self.input, self.disturbance) != (*input, *disturbance);
        (self.input, self.disturbance) = (*input, *disturbance);
        let Some(recorder) = &mut self.recorder else {
            return;
        };
        match (recorder.last_row_at(time_s), self.last) {
            // The time is in front of the plant's columns.
            (Some(row), _) => {
                let columns = [
                    (self.gauge.inputs(), input.as_slice()),
                    (self.gauge.disturbances(), disturbance.as_slice()),
                ];
                for (range, values) in columns {
                    let count = range.len();
                    row[1 + range.start..1 + range.end].copy_from_slice(&values[..count]);
                }
            }
            (None, Some(seen)) if jumps => self.write(time_s, &seen, [false; 2], controller),
            (None, _) => {}
        }
    }

    #[inline]
    fn held(&mut self, span_s: f64, input: &SVector<f64, M>) {
        self.effort.end(span_s, input);
    }

    #[inline(always)]
    fn step(
        &mut self,
        time_s: f64,
        step_s: f64,
        state: &SVector<f64, N>,
        disturbance: &SVector<f64, D>,
        controller: &C,
    ) {
        self.steps += 1;
        let seen = self.gauge.see(time_s, state);
        let gauge = &self.gauge;
        let magnitude = gauge.settling_square(&seen);
        self.error
            .record(time_s, step_s, magnitude, || gauge.tail_square(&seen));
        let acting = gauge.acting_disturbance(state, &self.input, disturbance);
        if let Some(monitor) = &mut self.lyapunov {
            let square = acting.norm_squared();
            monitor.step(time_s, step_s, &gauge.certified(&seen), square);
        }
        if let Some(inner) = &mut self.inner {
            let square = acting.norm_squared();
            inner.step(time_s, step_s, &gauge.certified(&seen), square);
        }
        self.watch(time_s, state, &seen, controller);
        self.last = Some(seen);
        self.disturbance = *disturbance;
        if self
            .recorder
            .as_ref()
            .is_some_and(|recorder| recorder.due(time_s))
        {
            self.write(time_s, &seen, [false; 2], controller);
        }
    }
}
