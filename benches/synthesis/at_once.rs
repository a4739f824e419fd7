//! One solve with all vertices at once: the same problem files for every solver, each in a process of its own.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use synth::lmi::Semidefinite;
use synth::model::Model;
use synth::solve::{Accuracy, Backend, Clarabel, Structured};
use synth::synthesis::{assemble, scaled_task, Form, Goal, FIRST_UNITS};

use super::external::{csdp, peak_memory_mb};
use super::growth::model_file;
use super::{print_table, Row};

/// The gap that is asked for: csdp's own.
const ACCURACY: Accuracy = Accuracy {
    relative_gap: 1e-8,
    objective_unit: 1.0,
};

/// Most vertices that Clarabel is given at once, and csdp in a quick run.
const FEW: u32 = 16;

/// 16, 256 and 1024 vertices.
pub fn run(folder: &Path, quick: bool) {
    for parameters in [4, 8, 10] {
        let vertices = 1_u32 << parameters;
        let model = Model::new(model_file(parameters)).expect("a valid model");
        let (_, task) = scaled_task(&model, &FIRST_UNITS);
        let file = |form: Form| {
            let name = form.name();
            let path = folder.join(format!("{name}-{vertices}.dat-s"));
            let problem = assemble(&task, form, Goal::SmallestGain).problem.lower();
            std::fs::write(&path, problem.to_sdpa(name)).expect("a writable temporary folder");
            path
        };
        let slack = file(Form::VertexRelaxed);
        let mut rows = Vec::new();
        if vertices <= FEW {
            rows.push(own("clarabel", &file(Form::Chordal), "Clarabel, reduced"));
            rows.push(own("clarabel", &slack, "Clarabel, slack"));
        }
        rows.push(own("structured", &slack, "structured, slack"));
        if vertices <= FEW || !quick {
            rows.push(csdp(&slack, "slack"));
        }
        let title = format!("{vertices} vertices at once, smallest gain (seconds: whole process)");
        print_table(&title, &rows);
    }
}

/// Solves a file with one of our own backends and prints what the parent shows.
pub fn child(solver: &str, file: &str) {
    let text = std::fs::read_to_string(file).expect("a problem file");
    let problem = Semidefinite::from_sdpa(&text).expect("an SDPA file");
    let backend: &dyn Backend = match solver {
        "clarabel" => &Clarabel::default(),
        _ => &Structured::default(),
    };
    let begin = Instant::now();
    let solution = backend
        .solve(&problem, ACCURACY, None)
        .expect("the backend accepts the problem");
    println!(
        "{} {:.3} s in {} iterations, {}, peak {} MB",
        solution.objective,
        begin.elapsed().as_secs_f64(),
        solution.iterations,
        solution.status_text,
        peak_memory_mb()
    );
}

fn own(solver: &str, file: &Path, what: &str) -> Row {
    let program = std::env::current_exe().expect("this program's path");
    let begin = Instant::now();
    let output = Command::new(program)
        .args(["--child-file", solver])
        .arg(file)
        .output();
    let seconds = begin.elapsed().as_secs_f64();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let text = text.unwrap_or_default();
    let (gamma, note) = text.trim().split_once(' ').unwrap_or(("", "no answer"));
    Row {
        what: what.to_string(),
        seconds: Some(seconds),
        gamma: gamma.parse().ok(),
        note: format!("solve {note}"),
    }
}
