//! `steadfast sweep FILE.json --vary key=lo:hi:n`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use serde_json::json;
use sha2::{Digest, Sha256};

use super::progress::PartsProgress;
use super::simulate::design_of;
use super::solver::SolverArg;
use super::{files, print, CliError};
use crate::harness::output::{create_folder, write};
use crate::harness::scenario::Scenario;
use crate::harness::simulation::check_design;
use crate::harness::sweep::axis::Axis;
use crate::harness::sweep::grid::Grid;
use crate::harness::sweep::outcome::PointOutcome;
use crate::harness::sweep::subject::Subject;
use crate::harness::sweep::{self, table, SweepError, Watch};

/// Name of the table.
const TABLE_FILE: &str = "sweep.csv";
/// Name of the file that says how the table came about.
const PROVENANCE_FILE: &str = "sweep.json";

/// Arguments of `sweep`.
#[derive(clap::Args)]
pub struct SweepArgs {
    /// Scenario or model file
    file: PathBuf,
    /// A number of the file and its values: key=lo:hi:n, key=lo:hi:n:log or key=a,b,c; several make a grid
    #[arg(
        long,
        required = true,
        value_name = "KEY=VALUES",
        allow_hyphen_values = true
    )]
    vary: Vec<String>,
    /// Folder for sweep.csv and sweep.json
    #[arg(short, long)]
    output: PathBuf,
    /// Design file, for scenarios whose controller is a design
    #[arg(long)]
    design: Option<PathBuf>,
    /// Solver, for models
    #[arg(long, default_value = "clarabel")]
    solver: SolverArg,
    /// Threads; one for each processor when left out
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    jobs: usize,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Runs every point and writes the table. 0: done, whatever the points' verdicts.
pub fn run(args: &SweepArgs) -> Result<ExitCode, CliError> {
    let text = files::text(&args.file)?;
    let axes = args.vary.iter().map(|text| Axis::parse(text));
    let axes = axes.collect::<Result<Vec<_>, _>>();
    let axes = axes.map_err(|error| CliError::Argument {
        argument: "--vary",
        reason: error.to_string(),
    })?;
    let subject = subject(args, &text)?;
    let grid = Grid::new(subject.file(), &axes)
        .map_err(|error| CliError::unsuitable(&args.file, error))?;
    create_folder(&args.output)?;
    let outcomes = swept(&subject, &grid, args.jobs)?;
    let csv = table::to_csv(&grid, &outcomes)
        .map_err(|error| CliError::unsuitable(&args.output, error))?;
    write(&args.output.join(TABLE_FILE), &csv)?;
    let provenance = provenance(args, &text, &subject, &grid);
    write(&args.output.join(PROVENANCE_FILE), &provenance)?;
    tell(args, &grid, &outcomes);
    Ok(ExitCode::SUCCESS)
}

fn subject(args: &SweepArgs, text: &str) -> Result<Subject, CliError> {
    let failed = |error| CliError::file(&args.file, error);
    if Subject::is_scenario(text) {
        let scenario = Scenario::from_json(text).map_err(failed)?;
        let design = design_of(&scenario, &args.file, args.design.as_deref())?;
        check_design(&scenario, design.as_ref())
            .map_err(|error| CliError::unsuitable(&args.file, error))?;
        return Subject::scenario(text, design.map(Box::new)).map_err(failed);
    }
    match &args.design {
        None => Subject::model(text, args.solver.choice()).map_err(failed),
        Some(_) => Err(CliError::Argument {
            argument: "--design",
            reason: "a design goes with a scenario; this file is none".to_string(),
        }),
    }
}

fn swept(subject: &Subject, grid: &Grid, jobs: usize) -> Result<Vec<PointOutcome>, CliError> {
    let progress = PartsProgress::start(grid.points(), "points");
    let watch = Watch {
        done: &|| progress.done(),
        stop: progress.stop(),
    };
    sweep::run(subject, grid, jobs, &watch).map_err(|error| match error {
        SweepError::Interrupted => CliError::Interrupted,
        SweepError::Threads(error) => CliError::Argument {
            argument: "--jobs",
            reason: error.to_string(),
        },
    })
}

/// How the table came about. Nothing in it depends on the clock or on the number of threads.
fn provenance(args: &SweepArgs, text: &str, subject: &Subject, grid: &Grid) -> String {
    let digest = Sha256::digest(text.as_bytes());
    let axes = grid.axes();
    let axes: Vec<_> = axes
        .map(|(name, values)| json!({ "name": name, "values": values }))
        .collect();
    let value = json!({
        "generator": concat!("steadfast ", env!("CARGO_PKG_VERSION")),
        "file": args.file.file_name().map(|name| name.to_string_lossy().into_owned()),
        "file_sha256": digest.iter().map(|byte| format!("{byte:02x}")).collect::<String>(),
        "kind": subject.kind().to_string(),
        "axes": axes,
        "points": grid.points(),
    });
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

fn tell(args: &SweepArgs, grid: &Grid, outcomes: &[PointOutcome]) {
    let mut verdicts = BTreeMap::<&str, usize>::new();
    for outcome in outcomes {
        *verdicts.entry(outcome.verdict.as_str()).or_default() += 1;
    }
    let path = args.output.join(TABLE_FILE);
    if args.json {
        let report = json!({
            "points": grid.points(),
            "varied": grid.names(),
            "verdicts": verdicts,
            "table": path_text(&path),
        });
        print(&report.to_string());
        return;
    }
    print(&format!("points: {}", grid.points()));
    for (verdict, count) in verdicts {
        print(&format!("  {verdict}: {count}"));
    }
    print(&format!("written: {}", path.display()));
}

fn path_text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
