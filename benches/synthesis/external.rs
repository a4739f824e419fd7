//! Other solvers as processes of their own.

use std::path::Path;
use std::process::{Command, Output};
use std::time::Instant;

use super::Row;

/// Peak resident memory of this process so far [MB]; 0 where the system does not tell.
pub fn peak_memory_mb() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok());
    kilobytes.unwrap_or(0) / 1024
}

fn timed(command: &mut Command) -> Option<(Output, f64)> {
    let start = Instant::now();
    let output = command.output().ok()?;
    Some((output, start.elapsed().as_secs_f64()))
}

fn missing(what: String, program: &str) -> Row {
    Row {
        what,
        seconds: None,
        gamma: None,
        note: format!("{program} is not installed: skipped"),
    }
}

/// The number after `label` and a separator.
fn number_after(text: &str, label: &str) -> Option<f64> {
    let rest = &text[text.find(label)? + label.len()..];
    let word = rest
        .trim_start_matches([' ', ':', '='])
        .split_whitespace()
        .next()?;
    word.parse().ok()
}

fn report(what: String, program: &str, run: Option<(Output, f64)>, label: &str) -> Row {
    let Some((output, seconds)) = run else {
        return missing(what, program);
    };
    let text = String::from_utf8_lossy(&output.stdout);
    Row {
        what,
        seconds: Some(seconds),
        gamma: number_after(&text, label),
        note: "whole process".to_string(),
    }
}

/// csdp on an SDPA sparse file. Its dual objective is the value of our minimisation.
pub fn csdp(file: &Path, name: &str) -> Row {
    let solution = file.with_extension("csdp");
    let run = timed(Command::new("csdp").arg(file).arg(solution));
    report(
        format!("csdp, {name}"),
        "csdp",
        run,
        "Dual objective value:",
    )
}

/// sdpa on an SDPA sparse file.
pub fn sdpa(file: &Path, name: &str) -> Row {
    let solution = file.with_extension("sdpa");
    let run = timed(
        Command::new("sdpa")
            .arg("-ds")
            .arg(file)
            .arg("-o")
            .arg(solution),
    );
    report(format!("sdpa, {name}"), "sdpa", run, "objValPrimal")
}

/// cvxpy with Clarabel on an SDPA sparse file, as a user of Python would write it.
pub fn cvxpy(file: &Path) -> Row {
    let what = "cvxpy + Clarabel, full".to_string();
    let probe = Command::new("python3")
        .args(["-c", "import cvxpy"])
        .output();
    if !probe.is_ok_and(|output| output.status.success()) {
        return missing(what, "cvxpy");
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/synthesis/solve_sdpa.py");
    let run = timed(Command::new("python3").arg(script).arg(file));
    let mut row = report(what, "cvxpy", run, "objective");
    row.note = "whole process, modelling included".to_string();
    row
}
