//! Closed-loop steps per second and allocations: `cargo bench --bench simulate`.
//!
//! Everything is in: law, trigger, disturbance, metrics and, for the design, the certificate's
//! bookkeeping. The Wu 2018 scenario is also run by scipy's `solve_ivp`, one call per held segment,
//! where python3 has scipy.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use steadfast::run::design::Design;
use steadfast::run::simulate;
use steadfast::scenario::Scenario;
use synth::model::Model;
use synth::solve::Solver;
use synth::synthesis::{synthesize, Outcome, Solvers};

const REPEATS: usize = 5;
/// Long enough that the start of a run does not count, s.
const DURATION_S: f64 = 20_000.0;
/// What `solve_ivp` needs patience for, s.
const SCIPY_DURATION_S: f64 = 100.0;

fn main() {
    let wu = scenario("wu2018.json");
    let wu_seconds_per_step = report("Wu 2018", &wu, None);
    report(
        "Wu 2018, paper's noise",
        &scenario("wu2018-noise.json"),
        None,
    );
    report(
        "Xu 2020, published, 7 rules",
        &scenario("xu2020-published.json"),
        None,
    );
    match design() {
        Some(design) => {
            let xu = scenario("xu2020-closed-loop.json");
            report("Xu 2020, design and certificate", &xu, Some(&design));
        }
        None => println!("Xu 2020, design: skipped, no design was found"),
    }
    against_scipy(wu_seconds_per_step);
}

fn models() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/models"))
}

fn scenario(name: &str) -> Scenario {
    let text = std::fs::read_to_string(models().join(name)).expect("the file is there");
    let mut scenario = Scenario::from_json(&text).expect("the file is valid");
    scenario.duration_s = DURATION_S;
    scenario.tail_s = 0.2 * DURATION_S;
    scenario
}

fn design() -> Option<Design> {
    let text = std::fs::read_to_string(models().join("xu2020.json")).ok()?;
    let model = Model::from_json(&text).ok()?;
    match synthesize(
        &model,
        &text,
        &Solvers::both([Solver::Clarabel, Solver::Structured]),
        None,
    )
    .ok()?
    {
        Outcome::Solved(design) => Design::from_json(&design.file.to_json()).ok(),
        _ => None,
    }
}

/// The best of a few runs; returns seconds per step.
fn report(name: &str, scenario: &Scenario, design: Option<&Design>) -> f64 {
    let run = || {
        simulate(scenario, design, false)
            .expect("the scenario runs")
            .summary
    };
    let summary = run();
    let steps = summary.steps as f64;
    let best = (0..REPEATS)
        .map(|_| {
            let start = Instant::now();
            std::hint::black_box(run());
            start.elapsed().as_secs_f64() / steps
        })
        .fold(f64::INFINITY, f64::min);
    let allocations = |duration: f64| {
        let scenario = Scenario {
            duration_s: duration,
            ..scenario.clone()
        };
        let count = allocation_counter::measure(|| {
            std::hint::black_box(simulate(&scenario, design, false).ok());
        });
        count.count_total
    };
    let (short, long) = (allocations(0.1 * DURATION_S), allocations(DURATION_S));
    println!(
        "{name:<34} {:>6.2} million steps/s, {:>6.1} ns per step, {:.2} samples per step, \
         {} allocations per run, {} more in a run ten times as long",
        1e-6 / best,
        1e9 * best,
        summary.samples as f64 / steps,
        short,
        long.saturating_sub(short),
    );
    best
}

fn against_scipy(seconds_per_step: f64) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/wu2018_scipy.py");
    let output = Command::new("python3")
        .arg(script)
        .arg(SCIPY_DURATION_S.to_string())
        .output();
    let seconds = output
        .ok()
        .filter(|output| output.status.success())
        .and_then(|output| {
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            text.trim().parse::<f64>().ok()
        });
    match seconds {
        None => println!("scipy solve_ivp: skipped, python3 has no scipy"),
        Some(per_segment) => println!(
            "scipy solve_ivp, one call per held segment (1/32 s): {:.1} microseconds per segment, \
             {:.0} times as long as one step here",
            1e6 * per_segment,
            per_segment / seconds_per_step
        ),
    }
}
