//! Side by side, in one run: Clarabel and the structured solver, csdp and sdpa on the exports of all forms, and cvxpy +
//! Clarabel on the full form, for models/xu2020.json; then single solves with 16, 256 and 1024 vertices at once, and whole
//! syntheses against the number of vertices. Other solvers are left out, and named, when they are not installed.
//!
//! `cargo bench --bench synthesis` runs everything; `-- --quick` leaves out what takes minutes;
//! `-- --growth 1024` runs one model with that many vertices and nothing else.

#[path = "synthesis/at_once.rs"]
mod at_once;
#[path = "synthesis/external.rs"]
mod external;
#[path = "synthesis/growth.rs"]
mod growth;

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use synth::lmi::Semidefinite;
use synth::model::Model;
use synth::solve::{Accuracy, Backend, Clarabel, DenseColumns, Solution, Structured};
use synth::synthesis::{assemble, scaled_task, Form, Goal, FIRST_UNITS};

/// One line of the table.
pub struct Row {
    what: String,
    seconds: Option<f64>,
    gamma: Option<f64>,
    note: String,
}

fn main() {
    // Child mode: one solve in a process of its own, so that its peak memory is its own.
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(position) = arguments.iter().position(|a| a == "--child") {
        child(&arguments[position + 1], &arguments[position + 2]);
        return;
    }
    if let Some(position) = arguments.iter().position(|a| a == "--child-file") {
        at_once::child(&arguments[position + 1], &arguments[position + 2]);
        return;
    }
    if let Some(position) = arguments.iter().position(|a| a == "--growth") {
        let vertices = arguments
            .get(position + 1)
            .and_then(|count| count.parse().ok());
        growth::run_one(vertices.expect("a number of vertices, 16 to 4096"));
        return;
    }
    let quick = arguments.iter().any(|argument| argument == "--quick");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let rows = side_by_side(folder.path(), quick);
    print_table("models/xu2020.json, smallest gain", &rows);
    at_once::run(folder.path(), quick);
    growth::run(quick);
}

/// The problem of models/xu2020.json.
fn problem(form: Form) -> (Semidefinite, Accuracy) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("models/xu2020.json");
    let text = std::fs::read_to_string(path).expect("the model file");
    let model = Model::from_json(&text).expect("a valid model");
    let (_, task) = scaled_task(&model, &FIRST_UNITS);
    let problem = assemble(&task, form, Goal::SmallestGain).problem.lower();
    (problem, Goal::SmallestGain.accuracy(&task))
}

fn clarabel(dense_columns: DenseColumns) -> Clarabel {
    Clarabel { dense_columns }
}

fn solve((problem, accuracy): &(Semidefinite, Accuracy), backend: &dyn Backend) -> (Solution, f64) {
    let start = Instant::now();
    let solution = backend
        .solve(problem, *accuracy, None)
        .expect("the backend accepts the problem");
    (solution, start.elapsed().as_secs_f64())
}

fn child(form: &str, padding: &str) {
    let form = Form::named(form).unwrap_or(Form::Chordal);
    let (solution, seconds) = match padding {
        "padded" => solve(&problem(form), &clarabel(DenseColumns::default())),
        "unpadded" => solve(&problem(form), &clarabel(DenseColumns::None)),
        _ => solve(&problem(form), &Structured::default()),
    };
    println!(
        "{seconds} {} {} {}",
        solution.objective,
        solution.status_text.split(':').next().unwrap_or_default(),
        external::peak_memory_mb()
    );
}

fn own_row(form: &str, padding: &str) -> Row {
    let program = std::env::current_exe().expect("this program's path");
    let output = Command::new(program)
        .args(["--child", form, padding])
        .output();
    let text = output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned());
    let text = text.unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    let number = |index: usize| words.get(index).and_then(|word| word.parse().ok());
    Row {
        what: match padding {
            "structured" => format!("structured, {form}"),
            _ => format!("Clarabel, {form}, {padding}"),
        },
        seconds: number(0),
        gamma: number(1),
        note: format!(
            "{}, peak {} MB",
            words.get(2).unwrap_or(&"no answer"),
            words.get(3).unwrap_or(&"?")
        ),
    }
}

fn side_by_side(folder: &Path, quick: bool) -> Vec<Row> {
    let mut rows = vec![
        own_row("reduced", "padded"),
        own_row("reduced", "unpadded"),
        own_row("slack", "structured"),
        own_row("reduced", "structured"),
    ];
    if !quick {
        rows.push(own_row("full", "unpadded"));
        rows.push(own_row("full", "padded"));
    }
    for form in [Form::Chordal, Form::VertexRelaxed, Form::Full] {
        let name = form.name();
        let file = folder.join(format!("{name}.dat-s"));
        std::fs::write(&file, problem(form).0.to_sdpa(name)).expect("a writable temporary folder");
        rows.push(external::csdp(&file, name));
        rows.push(external::sdpa(&file, name));
    }
    if !quick {
        rows.push(external::cvxpy(&folder.join("full.dat-s")));
    }
    rows
}

/// Prints rows with their times relative to the first one.
pub fn print_table(title: &str, rows: &[Row]) {
    println!("\n{title}");
    println!(
        "{:34} {:>9} {:>9} {:>12}  note",
        "", "seconds", "ratio", "gamma"
    );
    let base = rows.first().and_then(|row| row.seconds);
    for row in rows {
        let show = |value: Option<f64>, digits: usize| {
            value.map_or("-".to_string(), |value| format!("{value:.digits$}"))
        };
        let ratio = base.zip(row.seconds).map(|(base, seconds)| seconds / base);
        println!(
            "{:34} {:>9} {:>9} {:>12}  {}",
            row.what,
            show(row.seconds, 3),
            show(ratio, 2),
            show(row.gamma, 7),
            row.note
        );
    }
}
