//! Independent semidefinite programming solvers, used where they are installed.

use std::path::Path;
use std::process::Command;

/// The two ends of the bracket in which a solver's optimum lies.
#[derive(Debug, Clone, Copy)]
pub struct Optimum {
    pub primal: f64,
    pub dual: f64,
}

/// Whether a command is on the search path.
fn installed(command: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(command).is_file())
}

/// The optimum that CSDP (Borchers) finds, `None` when it is not installed.
#[track_caller]
pub fn csdp(problem: &Path) -> Option<Optimum> {
    if !installed("csdp") {
        eprintln!("SKIPPED: csdp is not installed; nothing was compared");
        return None;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = Command::new("csdp")
        .arg(problem)
        .arg("solution")
        .current_dir(folder.path())
        .output();
    let output = run.expect("csdp runs");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    // 3 is "solved with reduced accuracy"; the caller judges the numbers.
    let solved = matches!(output.status.code(), Some(0 | 3));
    assert!(solved, "csdp: {text}");
    Some(Optimum {
        primal: value_after(&text, "Primal objective value:"),
        dual: value_after(&text, "Dual objective value:"),
    })
}

/// The optimum that SDPA (Yamashita and others) finds, `None` when it is not installed.
#[track_caller]
pub fn sdpa(problem: &Path) -> Option<Optimum> {
    if !installed("sdpa") {
        eprintln!("SKIPPED: sdpa is not installed; nothing was compared");
        return None;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let run = Command::new("sdpa")
        .arg("-ds")
        .arg(problem)
        .args(["-o", "solution"])
        .current_dir(folder.path())
        .output();
    assert!(run.expect("sdpa runs").status.success());
    let text = std::fs::read_to_string(folder.path().join("solution")).expect("a solution");
    Some(Optimum {
        primal: value_after(&text, "objValPrimal ="),
        dual: value_after(&text, "objValDual   ="),
    })
}

#[track_caller]
fn value_after(text: &str, label: &str) -> f64 {
    let rest = text
        .split(label)
        .nth(1)
        .unwrap_or_else(|| panic!("no '{label}' in {text}"));
    let word = rest.split_whitespace().next().expect("a value");
    word.parse().expect("a number")
}
