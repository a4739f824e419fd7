//! One run of a plant in its surroundings, with any controller.

use nalgebra::SMatrix;

use super::design::Design;
use super::judge::{self, About};
use super::log::Log;
use super::outcome::{Recording, RunOutcome};
use super::summary::Summary;
use crate::scenario::{has_worst, Scenario};
use crate::sim::bench::{Bench, Gauge};
use crate::sim::closed_loop::{ClosedLoop, End};
use crate::sim::controller::{Controller, Use};
use crate::sim::input_gradient::InputGradient;
use crate::sim::link::Link;
use crate::sim::network::Network;
use crate::sim::plant::Plant;
use crate::sim::sampling::Sampling;
use crate::sim::sensor::Sensor;

/// A run that waits for its controller, of a plant whose certificates are about `L` states.
pub(crate) struct Flight<
    'a,
    P,
    S,
    G,
    const N: usize,
    const M: usize,
    const D: usize,
    const L: usize,
> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// Its plant.
    pub bench: Bench<P, S, G, N, M, D>,
    /// The design that the controller is from, where it is from one.
    pub design: Option<&'a Design>,
    /// What is between the controller and the actuators.
    pub link: Option<Link<M>>,
    /// What is recorded.
    pub recording: &'a Recording<'a>,
}

impl<P, S, G, const N: usize, const M: usize, const D: usize, const L: usize> Use<S::Measurement, M>
    for Flight<'_, P, S, G, N, M, D, L>
where
    P: Plant<N, M, D>,
    S: Sensor<N>,
    G: Gauge<N, M, D, L, Seen = S::Measurement> + Clone,
{
    type Output = (End, Log<G, N, M, D, L>);

    fn with<C: Controller<S::Measurement, M>>(self, controller: C) -> Self::Output {
        let Flight {
            scenario,
            bench,
            design,
            mut link,
            recording,
        } = self;
        let repeats = design.map_or(0, Design::repeats);
        let network = scenario
            .network
            .as_ref()
            .map(|network| network.data(repeats));
        let mut network = network.map(|data| Network::new(&data, scenario.seed));
        let worst = has_worst(&scenario.system, scenario.network.as_ref());
        let against = design.map(|design| design.worst_case::<L, M, D>());
        let gradient = against.as_ref().filter(|_| worst);
        let gradient =
            gradient.map(|against| along::<G, N, M, D, L, M>(&bench.gauge, against.by_input));
        let push = against.filter(|_| bench.disturbance.worst > 0.0);
        let disturbance_gradient =
            push.map(|against| along::<G, N, M, D, L, D>(&bench.gauge, against.by_disturbance));
        let breakpoints_s = bench.discontinuities_s(scenario.duration_s);
        let columns = (controller.signal_names(), link.is_some());
        let jumps_s = bench.reference_jumps_s.clone();
        let mut log = Log::new(bench.gauge, scenario, design, recording, columns, jumps_s);
        let closed_loop = ClosedLoop {
            plant: &bench.plant,
            disturbance: &bench.disturbance,
            sensor: bench.sensor,
            controller,
            link: link.as_mut(),
            network: network.as_mut(),
            gradient,
            disturbance_gradient,
            sampling: Sampling::new(
                scenario.instants,
                scenario.dropout_probability,
                scenario.seed,
            ),
            actuators: &bench.actuators,
            breakpoints_s,
            method: scenario.method,
            duration_s: scenario.duration_s,
            seed: scenario.seed,
        };
        let end = closed_loop.run(&bench.initial, &mut log);
        log.link = link.map(|link| link.outcome());
        let until_s = match end {
            End::Completed => scenario.duration_s,
            End::Diverged { time_s } => time_s,
        };
        log.network = network.map(|mut network| network.outcome(until_s));
        (end, log)
    }
}

/// How x'Ux grows along a matrix times the certificate's state.
fn along<'a, G, const N: usize, const M: usize, const D: usize, const L: usize, const K: usize>(
    gauge: &G,
    matrix: SMatrix<f64, K, L>,
) -> InputGradient<'a, N, K>
where
    G: Gauge<N, M, D, L> + Clone + 'a,
{
    let gauge = gauge.clone();
    InputGradient::new(move |time_s, state| {
        let seen = gauge.see(time_s, state);
        matrix * gauge.certified(&seen)
    })
}

/// A controller without a trigger of its own sends what the encoder behind it sends.
fn messages_on_the_link(summary: &mut Summary) {
    let Some(link) = &summary.link else {
        return;
    };
    summary.measured.triggers = link.messages;
    summary.measured.bits = link.bits;
    summary.measured.bytes = link.bytes;
    summary.shortest_interval_s = link.shortest_interval_s;
    summary.mean_interval_s = link.mean_interval_s;
}

/// The outcome of a run.
pub(crate) fn finish<G, const N: usize, const M: usize, const D: usize, const L: usize>(
    scenario: &Scenario,
    design: Option<&Design>,
    (end, log): (End, Log<G, N, M, D, L>),
    about: About,
) -> RunOutcome
where
    G: Gauge<N, M, D, L>,
{
    let start = log.start.as_ref().map(|start| log.gauge.certified(start));
    let from_rest = start.is_some_and(|start| start.norm() == 0.0);
    let certificate = design.zip(log.lyapunov.as_ref());
    let certificate = certificate.map(|(design, monitor)| {
        let monitors = (monitor, log.inner.as_ref());
        let flown = log.imperfections();
        judge::certificate(scenario, design, monitors, (&log.events, &flown), from_rest)
    });
    let sends_by_link = about.sends_by_link;
    let mut summary = judge::summary(scenario, design, &log, (about, end), certificate);
    if sends_by_link {
        messages_on_the_link(&mut summary);
    }
    judge::conclude(scenario, &mut summary, end);
    let (profile, trajectory) = log.into_records(end == End::Completed);
    RunOutcome {
        summary,
        trajectory,
        profile,
    }
}
