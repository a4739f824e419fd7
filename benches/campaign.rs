//! Runs of a campaign per second on one and on two threads, and its memory: `cargo bench --bench campaign`.
//!
//! `cargo bench --bench campaign -- N` makes campaigns of N runs; 2000 when left out.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

const RUNS: u64 = 2000;
const PAIRS: usize = 3;

fn main() {
    let asked = std::env::args().skip(1).find_map(|text| text.parse().ok());
    let runs: u64 = asked.unwrap_or(RUNS);
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/wu2018-campaign.json");
    let mut best: Option<(Measured, Measured)> = None;
    for _ in 0..PAIRS {
        let (one, two) = (measure(&scenario, runs, 1), measure(&scenario, runs, 2));
        println!("1 thread: {one}; 2 threads: {two}");
        let sum = |pair: &(Measured, Measured)| pair.0.seconds + pair.1.seconds;
        let pair = (one, two);
        if best.as_ref().is_none_or(|best| sum(&pair) < sum(best)) {
            best = Some(pair);
        }
    }
    let Some((one, two)) = best else { return };
    println!(
        "{runs} runs of 1000 s of Wu 2018: {:.1} runs/s on one thread, {:.1} on two; parallel efficiency \
         {:.1} %; peak memory {:.1} MB",
        runs as f64 / one.seconds,
        runs as f64 / two.seconds,
        50.0 * one.seconds / two.seconds,
        two.peak_mb.max(one.peak_mb),
    );
    println!("a busy machine makes the efficiency smaller than it is; processor time tells: user seconds above");
}

struct Measured {
    seconds: f64,
    user_seconds: f64,
    peak_mb: f64,
}

impl std::fmt::Display for Measured {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            to,
            "{:.2} s ({:.2} s of user time, {:.1} MB)",
            self.seconds, self.user_seconds, self.peak_mb
        )
    }
}

/// The command as a process of its own, watched by GNU time where it is there.
fn measure(scenario: &Path, runs: u64, jobs: u64) -> Measured {
    let folder = tempfile::tempdir().expect("a folder");
    let program = env!("CARGO_BIN_EXE_steadfast");
    let timed = Command::new("time").arg("--version").output().is_ok();
    let mut command = match timed {
        true => {
            let mut command = Command::new("time");
            command.args(["-f", "%U %M", program]);
            command
        }
        false => Command::new(program),
    };
    command.arg("campaign").arg(scenario);
    command.args(["--runs", &runs.to_string(), "--jobs", &jobs.to_string()]);
    command
        .args(["--keep", "0", "-o"])
        .arg(folder.path().join("out"));
    let start = Instant::now();
    let output = command.output().expect("the command runs");
    let seconds = start.elapsed().as_secs_f64();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let numbers = said.lines().last().unwrap_or_default().split(' ');
    let numbers: Vec<f64> = numbers.filter_map(|text| text.parse().ok()).collect();
    let (user_seconds, kilobytes) = match numbers.as_slice() {
        [user, kilobytes] => (*user, *kilobytes),
        _ => (f64::NAN, f64::NAN),
    };
    Measured {
        seconds,
        user_seconds,
        peak_mb: kilobytes / 1000.0,
    }
}
