//! Time and memory against the number of vertices.

use std::time::Instant;

use synth::model::{LinearBound, Model, ModelFile, PlantFile, VerticesPlant};
use synth::solve::{Clarabel, Structured};
use synth::synthesis::{synthesize, Form, Outcome, Solvers};

use super::external::peak_memory_mb;
use super::{print_table, Row};

/// Whole syntheses (both solves and the check) for 16, 64 and 256 vertices, and 1024 unless quick.
pub fn run(quick: bool) {
    let parameters: &[u32] = if quick { &[4, 6] } else { &[4, 6, 8, 10] };
    print_rows(parameters);
}

/// One whole synthesis with each solver, for a number of vertices that is a power of two from 16 on.
pub fn run_one(vertices: u32) {
    assert!(vertices.is_power_of_two() && (16..=4096).contains(&vertices));
    print_rows(&[vertices.trailing_zeros()]);
}

fn print_rows(parameters: &[u32]) {
    let solvers = [
        Solvers::only(Structured::default(), Form::VertexRelaxed),
        Solvers::only(Clarabel::default(), Form::Chordal),
    ];
    for solvers in &solvers {
        let rows: Vec<Row> = parameters
            .iter()
            .map(|&count| synthesis_row(count, solvers))
            .collect();
        let title = format!(
            "growth: whole synthesis, {} (peak memory so far)",
            solvers.names()
        );
        print_table(&title, &rows);
    }
}

fn synthesis_row(parameters: u32, solvers: &Solvers) -> Row {
    let model = Model::new(model_file(parameters)).expect("a valid model");
    let start = Instant::now();
    let outcome = synthesize(&model, "", solvers, None);
    let seconds = start.elapsed().as_secs_f64();
    let what = format!("{} vertices", 1_u32 << parameters);
    match outcome {
        Ok(Outcome::Solved(design)) => Row {
            what,
            seconds: Some(seconds),
            gamma: Some(design.file.certificate.gamma),
            note: format!("{:?}, peak {} MB", design.report.verdict, peak_memory_mb()),
        },
        other => Row {
            what,
            seconds: Some(seconds),
            gamma: None,
            note: match other {
                Ok(_) => "no design".to_string(),
                Err(error) => error.to_string(),
            },
        },
    }
}

/// A spacecraft-like model whose state matrix depends on `parameters` parameters in [-1, 1]: three
/// rates, the scalar part, and small couplings made by a fixed recurrence.
pub fn model_file(parameters: u32) -> ModelFile {
    let moments = [350.0, 270.0, 190.0];
    let mut couplings = Couplings(1);
    let extra: Vec<[[f64; 6]; 6]> = (4..parameters).map(|_| couplings.next_matrix()).collect();
    let vertices = (0..1_u32 << parameters).map(|index| {
        let sign = |bit: usize| if index >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let mut a = vertex(
            &moments,
            [0.1 * sign(0), 0.1 * sign(1), 0.1 * sign(2)],
            0.875 + 0.125 * sign(3),
        );
        for (offset, matrix) in extra.iter().enumerate() {
            for (row, entries) in a.iter_mut().enumerate() {
                for (column, entry) in entries.iter_mut().enumerate() {
                    *entry += sign(4 + offset) * matrix[row][column];
                }
            }
        }
        a
    });
    let input = (0..6).map(|row| {
        let entry = |column: usize| {
            if row == column {
                1.0 / moments[column]
            } else {
                0.0
            }
        };
        (0..3).map(entry).collect()
    });
    let mut file = base_file();
    file.plant = PlantFile::Vertices(VerticesPlant {
        state_matrices: vertices.collect(),
        input_matrix: input.collect(),
        disturbance_matrix: None,
        output_matrix: None,
        input_limit: vec![2.5; 3],
        disturbance_bound: 0.01,
        region: (0..6).map(bound).collect(),
    });
    file
}

fn base_file() -> ModelFile {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("models/xu2020.json");
    let text = std::fs::read_to_string(path).expect("the model file");
    Model::from_json(&text).expect("a valid model").file
}

fn bound(state: usize) -> LinearBound {
    let mut row = vec![0.0; 6];
    row[state] = 1.0;
    LinearBound {
        row,
        bound: if state < 3 { 0.1 } else { 0.38 },
    }
}

fn vertex(moments: &[f64; 3], rate: [f64; 3], scalar_part: f64) -> Vec<Vec<f64>> {
    let spin = [
        [0.0, -rate[2], rate[1]],
        [rate[2], 0.0, -rate[0]],
        [-rate[1], rate[0], 0.0],
    ];
    let mut a = vec![vec![0.0; 6]; 6];
    for row in 0..3 {
        for column in 0..3 {
            a[row][column] = -spin[row][column] * moments[column] / moments[row];
            a[row + 3][column + 3] = -0.5 * spin[row][column];
        }
        a[row + 3][row] = 0.5 * scalar_part;
    }
    a
}

/// A linear congruential recurrence: the same small couplings in every run.
struct Couplings(u64);

impl Couplings {
    fn next_matrix(&mut self) -> [[f64; 6]; 6] {
        let mut out = [[0.0; 6]; 6];
        for entry in out.iter_mut().flatten() {
            self.0 = self
                .0
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            let unit = (self.0 >> 11) as f64 / (1_u64 << 53) as f64;
            *entry = 0.004 * (unit - 0.5);
        }
        out
    }
}
