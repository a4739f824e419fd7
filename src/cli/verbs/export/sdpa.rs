//! `steadfast export FILE --format sdpa`

use std::path::Path;

use synth::design::DesignFile;
use synth::lmi::Semidefinite;
use synth::model::{kind_of, Kind, Model, Objective};
use synth::problem::{first_program, Problem, ProblemDesignFile};
use synth::programs::Optimum;
use synth::synthesis::{
    assemble, coupled_problem, scaled_task, with_chosen_form, CouplingChoice, Form, Goal, Solvers,
    FIRST_UNITS,
};

use crate::base::provenance::GENERATOR;
use crate::cli::error::CliError;
use crate::cli::files;

/// The semidefinite program of a model, of a problem, or of what is inside a design, as SDPA sparse text:
/// the first problem that synthesis solves, in its scaled units; the first line says what its optimum is.
pub fn export(path: &Path, form: Option<Form>) -> Result<String, CliError> {
    let text = files::text(path)?;
    let (program, what) = match kind_of(&text) {
        Some(Kind::Problem) => {
            let problem = files::parse(path, &text, Problem::from_json)?;
            problem_program(path, form, &problem)?
        }
        Some(Kind::ProblemDesign) => {
            let (_, problem) = files::parse(path, &text, ProblemDesignFile::from_json)?;
            problem_program(path, form, &problem)?
        }
        Some(Kind::Design) => {
            let (design, model) = files::parse(path, &text, DesignFile::from_json)?;
            model_program(path, form, &model, Some(&design))?
        }
        _ => {
            let model = files::parse(path, &text, Model::from_json)?;
            // The form of the gyroscopic torque that synthesis chooses.
            let model = with_chosen_form(&model, &Solvers::suited_to(&model), None)
                .map_err(|error| CliError::synthesis(path, error))?;
            model_program(path, form, &model, None)?
        }
    };
    Ok(program.to_sdpa(&format!("{what}, by {GENERATOR}")))
}

/// The program of a model, or of a design with the form and the units that it was found with, and its name.
fn model_program(
    path: &Path,
    form: Option<Form>,
    model: &Model,
    design: Option<&DesignFile>,
) -> Result<(Semidefinite, String), CliError> {
    let own_form = design.and_then(|design| Form::named(&design.provenance.form));
    let form = form.or(own_form).unwrap_or(Form::Chordal);
    let choice = match design {
        Some(design) => coupling(path, design)?,
        None => None,
    };
    let two = match design {
        Some(_) => choice.is_some(),
        None => model.file.specs.objective == Objective::Both,
    };
    let (problem, goal, optimum) = match two {
        true => {
            let problem = coupled_problem(model, form, choice);
            let problem = problem.map_err(|error| CliError::value(path, error))?;
            (
                problem,
                "smallest inner gain with two certificates",
                Optimum::Gamma,
            )
        }
        false => {
            let units = design.map_or(FIRST_UNITS, |design| design.provenance.problem.clone());
            let (_, task) = scaled_task(model, &units);
            let problem = assemble(&task, form, Goal::SmallestGain).problem;
            (problem, "smallest gain", Optimum::of(model))
        }
    };
    let (name, form, optimum) = (&model.file.name, form.name(), optimum.as_text());
    let what = format!("{name}, {form} form, {goal}, {optimum}");
    Ok((problem.lower(), what))
}

/// How the two certificates of a design were coupled; `None` for a design with one.
fn coupling(path: &Path, design: &DesignFile) -> Result<Option<CouplingChoice>, CliError> {
    let coupling = design.provenance.coupling;
    let Some(coupling) = coupling.filter(|_| design.outer.is_some()) else {
        return Ok(None);
    };
    let usable = |value: f64| value.is_finite() && value > 0.0;
    let numbers = [coupling.inner_scale, coupling.trigger_multiple];
    if !numbers.into_iter().all(usable) {
        let reason = "field 'provenance.coupling': its numbers must be above 0";
        return Err(CliError::unsuitable(path, reason));
    }
    Ok(Some(CouplingChoice {
        containment_weight: design.provenance.problem.containment_weight,
        coupling,
    }))
}

fn problem_program(
    path: &Path,
    form: Option<Form>,
    problem: &Problem,
) -> Result<(Semidefinite, String), CliError> {
    if form.is_some() {
        let reason = "this file asks for a design problem, for which --form has no meaning";
        return Err(CliError::unsuitable(path, reason));
    }
    let (name, task) = (&problem.file.name, problem.task.name());
    let optimum = problem.task.objective();
    let what = format!("{name}, {task}, optimum {optimum} in the file's units");
    Ok((first_program(problem), what))
}
