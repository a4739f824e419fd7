//! From a model to a design that is proved, and proved again from the text of its file.
//!
//!     cargo run --release --example model_to_proof -- models/double-integrator.json
//!
//! Without an argument it takes the model that stands in the repository.

use std::error::Error;

use synth::certify::Verdict;
use synth::design::DesignFile;
use synth::model::Model;
use synth::synthesis::{synthesize, Outcome, Solvers};

const MODEL: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../models/double-integrator.json"
);

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| MODEL.to_string());
    let text = std::fs::read_to_string(&path)?;
    let model = Model::from_json(&text)?;
    let solvers = Solvers::suited_to(&model);
    let outcome = synthesize(&model, &text, &solvers, None)?;
    let Outcome::Solved(design) = outcome else {
        return Err(format!("{path}: no design").into());
    };
    // The file is what counts: whoever reads its text can prove it without the solver.
    let (file, model) = DesignFile::from_json(&design.file.to_json())?;
    let report = file.verify(&model)?;
    if report.verdict != Verdict::Proved {
        return Err(format!("{path}: not proved").into());
    }
    println!("{}: PROVED", file.name);
    println!("gains (inputs x states): {:?}", file.controller.gains);
    println!("gamma: {:.6}", file.certificate.gamma);
    for assumption in &report.not_covered {
        println!("the proof assumes: {assumption}");
    }
    Ok(())
}
