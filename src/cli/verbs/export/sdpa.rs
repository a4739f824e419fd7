//! `steadfast export FILE --format sdpa`

use synth::design::ProblemUnits;
use synth::lmi::Semidefinite;
use synth::model::{kind_of, Kind, Model, Objective};
use synth::problem::{first_program, Problem};
use synth::synthesis::{
    assemble, coupled_problem, scaled_task, CouplingChoice, Form, Goal, FIRST_UNITS,
};

use super::args::ExportArgs;
use crate::base::provenance::GENERATOR;
use crate::cli::error::CliError;
use crate::cli::files;

/// The semidefinite program of a model, of a problem, or of what is inside a design, as SDPA sparse text:
/// the first problem that synthesis solves, in its scaled units; the optimum is gamma.
pub fn export(args: &ExportArgs) -> Result<String, CliError> {
    let (program, what) = program(args)?;
    let title = format!("{what}, by {GENERATOR}");
    Ok(program.to_sdpa(&title))
}

/// The program and its name.
fn program(args: &ExportArgs) -> Result<(Semidefinite, String), CliError> {
    let text = files::text(&args.file)?;
    let (model, units, own_form) = match kind_of(&text) {
        Some(Kind::Problem) => {
            return problem_program(args, &files::problem_of(&args.file, &text)?);
        }
        Some(Kind::ProblemDesign) => {
            return problem_program(args, &files::problem_design_of(&args.file, &text)?.1);
        }
        Some(Kind::Design) => of_design(args, &text)?,
        _ => {
            let model = files::model_of(&args.file, &text)?;
            (model, FIRST_UNITS, Form::Chordal)
        }
    };
    if let Some(found) = both_program(args, &text)? {
        return Ok(found);
    }
    let form = args.form.map_or(own_form, Form::from);
    let (_, task) = scaled_task(&model, units);
    let problem = assemble(&task, form, Goal::SmallestGain).problem.lower();
    let what = format!("{}, {} form, smallest gain", model.file.name, form.name());
    Ok((problem, what))
}

/// The program of a design with two certificates, or of a model that asks for one.
fn both_program(args: &ExportArgs, text: &str) -> Result<Option<(Semidefinite, String)>, CliError> {
    let (model, choice, own_form) = match kind_of(text) {
        Some(Kind::Design) => {
            let (design, model) = files::design_of(&args.file, text)?;
            let Some(coupling) = design
                .provenance
                .coupling
                .filter(|_| design.outer.is_some())
            else {
                return Ok(None);
            };
            let usable = |value: f64| value.is_finite() && value > 0.0;
            if !usable(coupling.inner_scale) || !usable(coupling.trigger_multiple) {
                let reason = "field 'provenance.coupling': its numbers must be above 0";
                return Err(CliError::unsuitable(&args.file, reason));
            }
            let containment_weight = design.provenance.problem.containment_weight;
            let choice = CouplingChoice {
                containment_weight,
                coupling,
            };
            (model, Some(choice), Form::named(&design.provenance.form))
        }
        _ => {
            let model = files::model_of(&args.file, text)?;
            if model.file.specs.objective != Objective::Both {
                return Ok(None);
            }
            (model, None, None)
        }
    };
    let form = args.form.map(Form::from).or(own_form);
    let form = form.unwrap_or(Form::Chordal);
    let problem = coupled_problem(&model, form, choice);
    let problem = problem.map_err(|error| CliError::value(&args.file, error))?;
    let what = format!(
        "{}, {} form, smallest inner gain with two certificates",
        model.file.name,
        form.name()
    );
    Ok(Some((problem.lower(), what)))
}

fn problem_program(
    args: &ExportArgs,
    problem: &Problem,
) -> Result<(Semidefinite, String), CliError> {
    if args.form.is_some() {
        let reason = "this file asks for a design problem, for which --form has no meaning";
        return Err(CliError::unsuitable(&args.file, reason));
    }
    let what = format!("{}, {}", problem.file.name, problem.task.name());
    Ok((first_program(problem), what))
}

fn of_design(args: &ExportArgs, text: &str) -> Result<(Model, ProblemUnits, Form), CliError> {
    let (design, model) = files::design_of(&args.file, text)?;
    let form = Form::named(&design.provenance.form).unwrap_or(Form::Chordal);
    Ok((model, design.provenance.problem, form))
}
