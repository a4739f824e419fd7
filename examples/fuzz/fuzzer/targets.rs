//! What the program does with a file: reading, checking and deciding, in this process.

use std::io::Write;
use std::sync::Arc;

use steadfast::base::table::Table;
use steadfast::batch::campaign::plan::Plan;
use steadfast::batch::campaign::record::CampaignFile;
use steadfast::batch::campaign::table::{column_f64, column_names, column_text};
use steadfast::batch::tune::file::Requirements;
use steadfast::batch::variation::axis::Axis;
use steadfast::batch::variation::grid::Grid;
use steadfast::export::design::DesignData;
use steadfast::export::{c_header, csv, mat};
use steadfast::report::pages::run::page;
use steadfast::run::check_design;
use steadfast::run::design::Design;
use steadfast::run::summary::Summary;
use steadfast::scenario::{design_check, Scenario};
use synth::certify::{ExactReport, Verdict};
use synth::design::DesignFile;
use synth::feasibility::InfeasibilityFile;
use synth::held_command::HeldCommandDesignFile;
use synth::lmi::{SdpaForm, Semidefinite};
use synth::model::{kind_of, FileError, GainsFile, Kind, Model};
use synth::problem::{Problem, ProblemDesignFile};
use synth::requirements::{stated, Facts, Recipe};
use synth::solve::{Accuracy, Attempt, Outcome, Progress, Solver};

use super::corpus::Reader;

/// What came of a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Effect {
    /// It was read and its values are allowed.
    pub accepted: bool,
    /// Its proof was decided in interval arithmetic.
    pub decided: bool,
    /// It was proved, or solved.
    pub proved: bool,
    /// It was decided once more exactly.
    pub exact: bool,
    /// An answer that is wrong.
    pub wrong: Option<String>,
}

impl Effect {
    fn accepted(accepted: bool) -> Self {
        Effect {
            accepted,
            ..Effect::default()
        }
    }
}

/// Reads a text as the verbs do. `deep`: also what takes longer than reading (proofs, exports, plans, small solves).
pub fn attempt(reader: Reader, bytes: &[u8], deep: bool) -> Effect {
    let text = &String::from_utf8_lossy(bytes);
    match reader {
        Reader::Table => Effect::accepted(table(bytes)),
        Reader::Json => by_kind(text, deep),
        Reader::Summary => {
            Effect::accepted(Summary::from_json(text).is_ok_and(|own| shown(&own, deep)))
        }
        Reader::Campaign => Effect::accepted(serde_json::from_str::<CampaignFile>(text).is_ok()),
        Reader::Trajectory => Effect::accepted(Table::from_csv(text).is_ok()),
        Reader::Sdpa => semidefinite(text, SdpaForm::Sparse, deep),
        Reader::SdpaDense => semidefinite(text, SdpaForm::Dense, deep),
        Reader::Axis => Effect::accepted(axis(text)),
    }
}

/// As `check` and `verify`.
fn by_kind(text: &str, deep: bool) -> Effect {
    match kind_of(text).unwrap_or(Kind::Model) {
        Kind::Model => Effect::accepted(Model::from_json(text).is_ok_and(|model| {
            let plant = model.plant.takagi_sugeno();
            plant.states() > 0
        })),
        Kind::Facts => Effect::accepted(Facts::from_json(text).is_ok_and(|facts| {
            let ways = Recipe::ways(&facts).into_iter();
            let mut models = ways.map(|recipe| Model::new(stated(&facts, recipe).model));
            models.any(|model| model.is_ok())
        })),
        Kind::Problem => Effect::accepted(Problem::from_json(text).is_ok()),
        Kind::Gains => Effect::accepted(GainsFile::from_json(text).is_ok()),
        Kind::Requirements => Effect::accepted(Requirements::from_json(text).is_ok()),
        Kind::Scenario => scenario(text, deep),
        Kind::Design => design(text, deep),
        Kind::ProblemDesign => problem_design(text, deep),
        Kind::HeldCommandDesign => held_command_design(text, deep),
        Kind::Infeasibility => infeasibility(text, deep),
        Kind::Summary => {
            Effect::accepted(Summary::from_json(text).is_ok_and(|own| shown(&own, deep)))
        }
    }
}

/// A scenario: its controller's conditions, whether it needs a design, its campaign's first runs, a sweep of it.
fn scenario(text: &str, deep: bool) -> Effect {
    let Ok(scenario) = Scenario::from_json(text) else {
        return Effect::accepted(false);
    };
    let _ = design_check(&scenario);
    let _ = check_design(&scenario, None);
    if deep {
        if let Ok(plan) = Plan::new(text, None, Some(1), 8) {
            (0..8).for_each(|run| drop(plan.resolve(run)));
        }
        if let Ok(value) = serde_json::from_str(text) {
            let axes: Vec<Axis> = Axis::parse("duration_s=1:9:3").into_iter().collect();
            if let Ok(grid) = Grid::new(&value, &axes) {
                let _ = grid.apply(&value, &grid.point(0));
            }
        }
    }
    Effect::accepted(true)
}

/// The page of a run, with its summary's numbers.
fn shown(summary: &Summary, deep: bool) -> bool {
    if deep {
        let table = Table::from_csv("t,x0\n0,1\n1,0\n");
        let _ = table.map(|table| page(summary, &table).map(drop));
    }
    true
}

fn axis(text: &str) -> bool {
    Axis::parse(text).is_ok_and(|axis| axis.values.len() > 1)
}

/// Every column of a campaign's table, which is read from a file.
fn table(bytes: &[u8]) -> bool {
    let Ok(mut file) = tempfile::NamedTempFile::new() else {
        return false;
    };
    if file.write_all(bytes).is_err() {
        return false;
    }
    let Ok(names) = column_names(file.path()) else {
        return false;
    };
    let read = |name: &String| {
        column_f64(file.path(), name).is_ok() || column_text(file.path(), name).is_ok()
    };
    names.iter().all(read)
}

/// Conditions of a proof that is decided once more exactly: with more of them that takes seconds.
const MOST_CONDITIONS: usize = 16;

/// What both checks say of one file.
fn compared<E>(decided: Result<(Verdict, Result<Option<ExactReport>, E>), FileError>) -> Effect {
    let Ok((verdict, exact)) = decided else {
        return Effect::accepted(true);
    };
    let proved = verdict == Verdict::Proved;
    let decided_exactly = matches!(exact, Ok(Some(_)));
    let wrong = match (proved, exact) {
        (true, Ok(Some(exact))) if exact.verdict != Verdict::Proved => Some(format!(
            "PROVED, and the exact check denies {:?}",
            exact.failed
        )),
        (true, Err(_)) => Some("PROVED, and the exact check cannot be made".to_string()),
        _ => None,
    };
    Effect {
        accepted: true,
        decided: true,
        proved,
        exact: decided_exactly,
        wrong,
    }
}

fn design(text: &str, deep: bool) -> Effect {
    let Ok((file, model)) = DesignFile::from_json(text) else {
        return Effect::accepted(false);
    };
    if !deep {
        return Effect::accepted(true);
    }
    let decided = file.verify(&model).map_err(FileError::Value).map(|report| {
        let short = report.conditions.len() <= MOST_CONDITIONS;
        let exact = report.verdict == Verdict::Proved && short;
        let exact = exact.then(|| file.verify_exactly(&model)).transpose();
        (report.verdict, exact)
    });
    let effect = compared(decided);
    if let (true, Ok(flown)) = (effect.proved, Design::from_json(text)) {
        let data = DesignData::of_design(&flown);
        let _ = csv::design(&data);
        let _ = mat::design(&data);
        let _ = c_header::design(&data);
        let _ = flown.law_gains();
    }
    effect
}

fn problem_design(text: &str, deep: bool) -> Effect {
    let Ok((file, problem)) = ProblemDesignFile::from_json(text) else {
        return Effect::accepted(false);
    };
    if !deep {
        return Effect::accepted(true);
    }
    compared(
        file.verify(&problem)
            .map_err(FileError::Value)
            .map(|report| {
                let proved = report.verdict == Verdict::Proved;
                let exact = proved.then(|| file.verify_exactly(&problem)).transpose();
                (report.verdict, exact)
            }),
    )
}

/// As many conditions as these take seconds to decide exactly.
fn held_command_design(text: &str, deep: bool) -> Effect {
    let Ok((_, proof)) = HeldCommandDesignFile::from_json(text) else {
        return Effect::accepted(false);
    };
    match deep {
        false => Effect::accepted(true),
        true => compared(Ok::<_, FileError>((
            proof.verify().verdict,
            Ok::<_, FileError>(None),
        ))),
    }
}

fn infeasibility(text: &str, deep: bool) -> Effect {
    let Ok((file, model)) = InfeasibilityFile::from_json(text) else {
        return Effect::accepted(false);
    };
    if !deep {
        return Effect::accepted(true);
    }
    compared(file.verify(&model).map_err(FileError::Value).map(|found| {
        let proved = found.iter().all(|one| one.proved);
        let exact = proved
            .then(|| file.verify_exactly(&model, &found))
            .transpose();
        let verdict = if proved {
            Verdict::Proved
        } else {
            Verdict::NotProved
        };
        (verdict, exact)
    }))
}

/// Unknowns and widest cone of programs that are solved here.
const SMALL: usize = 12;

/// Most iterations of a solve here.
const ITERATIONS: u32 = 200;

/// Both solvers, whose answers must not contradict each other.
fn semidefinite(text: &str, form: SdpaForm, deep: bool) -> Effect {
    let Ok(problem) = Semidefinite::from_sdpa_form(text, form) else {
        return Effect::accepted(false);
    };
    if !deep
        || problem.cost.len() > SMALL
        || problem.widest() > SMALL
        || problem.cones.len() > SMALL
    {
        return Effect::accepted(true);
    }
    let accuracy = Accuracy {
        relative_gap: 1e-8,
        objective_unit: 1.0,
    };
    let answers = [Solver::Structured, Solver::Clarabel].map(|solver| {
        let observer = Arc::new(|progress: &Progress| progress.iteration < ITERATIONS);
        let attempt = Attempt::run(solver, &problem, accuracy, Some(observer));
        attempt.found.ok().map(|found| {
            let objective = found.judgement.residuals.map(|own| own.objective);
            (found.judgement.outcome, objective)
        })
    });
    let [Some((first, one)), Some((second, other))] = answers else {
        return Effect::accepted(true);
    };
    let differ =
        |one: f64, other: f64| (one - other).abs() > 1e-4 * (1.0 + one.abs() + other.abs());
    let wrong = match (first, second) {
        (Outcome::Solved, Outcome::Solved) => one
            .zip(other)
            .is_some_and(|(one, other)| differ(one, other)),
        (Outcome::Solved, Outcome::Infeasible | Outcome::Unbounded)
        | (Outcome::Infeasible | Outcome::Unbounded, Outcome::Solved) => true,
        _ => false,
    };
    Effect {
        accepted: true,
        decided: true,
        proved: first == Outcome::Solved,
        exact: false,
        wrong: wrong
            .then(|| format!("structured: {first:?} {one:?}, clarabel: {second:?} {other:?}")),
    }
}
