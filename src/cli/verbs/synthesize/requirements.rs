//! What `synthesize` does for a spacecraft with requirements.

use std::path::Path;
use std::time::Instant;

use synth::model::Model;
use synth::requirements::{best, suggestions, Candidate, Facts, Standing};
use synth::solve::Solver;

use super::conclude::keep_design;
use crate::cli::answer::{Answer, Exit};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{self, warn};
use crate::cli::progress::{solve, solve_in_parts};
use crate::cli::show::design::SynthesisReport;
use crate::cli::show::facts::{design_written, NOTHING};
use crate::cli::show::requirements::{lines, MissedReport, RequirementsReport};
use crate::cli::solver::SolverArg;

/// Finds what the file leaves open, designs, writes and proves. 0: every requirement is proved; 2: not. `unused` is an
/// option given that says nothing about such a file.
pub fn synthesize(
    path: &Path,
    text: &str,
    (output, solver): (Option<&Path>, SolverArg),
    unused: Option<&str>,
) -> Result<Answer, CliError> {
    let facts = files::parse(path, text, Facts::from_json)?;
    if let Some(option) = unused {
        let reason = format!("{option} has no meaning for a file with requirements");
        return Err(CliError::unsuitable(path, reason));
    }
    warn(&physics::of_facts(&facts, text));
    let solvers = solver.solvers([Solver::Structured, Solver::Clarabel], None);
    let started = Instant::now();
    let found = solve_in_parts(path, |observer, stands| {
        let watch = |standing| stands(in_words(standing, started.elapsed().as_secs_f64()));
        best(&facts, text, &solvers, observer, &watch)
    })?;
    let candidate = found.candidate.as_ref();
    if let Some(candidate) = candidate.filter(|found| found.meets_all()) {
        return written(path, candidate, output);
    }
    let changes = match found.stopped {
        true => Vec::new(),
        false => solve(path, "looking for a change that helps", |observer| {
            suggestions(&facts, &found, &solvers, observer)
        })?,
    };
    let report = MissedReport::new(&facts, &found, &changes);
    let mut said = report.lines(path);
    said.push(NOTHING.to_string());
    Ok(Answer::new(Exit::No, &report, &said))
}

/// How far the search has come after so many seconds, and how long it may last.
fn in_words(standing: Standing, elapsed_s: f64) -> String {
    let best = standing.fraction.map_or(String::new(), |fraction| {
        let percent = (100.0 * fraction).floor();
        format!(", the best so far meets {percent} % of the hardest requirement")
    });
    let left = match standing.tried {
        0 => String::new(),
        tried => {
            let each = elapsed_s / tried as f64;
            format!(
                ", about {:.0} s left at most",
                each * (standing.recipes - tried) as f64
            )
        }
    };
    format!(
        "way {} of {}{best}{left}",
        standing.tried + 1,
        standing.recipes
    )
}

/// Writes a design that meets every requirement, and answers.
fn written(path: &Path, found: &Candidate, output: Option<&Path>) -> Result<Answer, CliError> {
    let design = &found.design;
    let model = Model::new(design.file.model.clone());
    let model = model.map_err(|error| CliError::value(path, error))?;
    let (kept, checked) = keep_design(output, design)?;
    let report = RequirementsReport {
        requirements: &found.answered,
        design: SynthesisReport::new(design, &model, &checked, None),
    };
    let mut said = lines(&found.answered);
    said.extend(report.design.lines(&design.file.name));
    said.push(design_written(kept, checked.verdict));
    Ok(Answer::new(Exit::from(checked.verdict), &report, &said))
}
