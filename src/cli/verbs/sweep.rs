//! `steadfast sweep FILE.json --vary key=lo:hi:n`

use std::path::{Path, PathBuf};

use synth::model::Model;
use synth::synthesis::solver_order;

use crate::base::files::create_folder;
use crate::batch::engine::Interrupted;
use crate::batch::sweep;
use crate::batch::sweep::finished::{Finished, CSV_FILE, PAGE_FILE, PARQUET_FILE, PROVENANCE_FILE};
use crate::batch::sweep::outcome::PointOutcome;
use crate::batch::sweep::points::{PointStore, SweepIdentity, JOURNAL_FILE};
use crate::batch::sweep::subject::Subject;
use crate::batch::sweep::SweepError;
use crate::batch::variation::axis::Axis;
use crate::batch::variation::grid::Grid;
use crate::cli::answer::Answer;
use crate::cli::contents::{Contents, SWEEP, SWEEP_TABLE};
use crate::cli::design::design_of;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::cli::physics::{of_model, of_scenario, warn};
use crate::cli::progress::{threads, PartsProgress};
use crate::cli::show;
use crate::cli::solver::SolverArg;
use crate::cli::target::Targets;
use crate::report::html::PageKind;
use crate::report::pages::files::write_sweep;
use crate::run::check_design;
use crate::scenario::Scenario;

/// Arguments of `sweep`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
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
    /// Folder for the results; a sweep that was ended goes on where its points are
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// Design file, for scenarios whose controller is a design
    #[arg(long)]
    design: Option<PathBuf>,
    /// Which solvers may be asked, for models; auto when left out
    #[arg(long)]
    solver: Option<SolverArg>,
    /// Threads; one for each processor when left out
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Throw away the points in the folder and begin again
    #[arg(long)]
    restart: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// The files of a sweep beside its points.
const FILES: [(&str, Contents); 4] = [
    (CSV_FILE, SWEEP_TABLE),
    (PARQUET_FILE, Contents::Parquet),
    (PAGE_FILE, Contents::Page(PageKind::Sweep)),
    (PROVENANCE_FILE, SWEEP),
];

/// Runs every point and writes the table. 0: done, whatever the points' verdicts.
pub fn run(args: &SweepArgs) -> Result<Answer, CliError> {
    let text = files::text(&args.file)?;
    let inputs = std::iter::once(&args.file).chain(&args.design);
    let inputs: Vec<&Path> = inputs.map(PathBuf::as_path).collect();
    let targets = Targets {
        inputs: &inputs,
        force: args.force,
    };
    // Where points of a sweep are kept, they say what the folder is.
    let begun = Contents::Journal.stands_in(&args.output.join(JOURNAL_FILE));
    let files: &[(&str, Contents)] = if begun { &[] } else { &FILES };
    targets.check_folder(Some(&args.output), files)?;
    let axes = args.vary.iter().map(|text| Axis::parse(text));
    let axes = axes.collect::<Result<Vec<_>, _>>();
    let axes = axes.map_err(|error| CliError::Argument {
        argument: "--vary",
        reason: error.to_string(),
    })?;
    let mut subject = subject(args, &text)?;
    let grid =
        Grid::new(&subject.file, &axes).map_err(|error| CliError::unsuitable(&args.file, error))?;
    create_folder(&args.output)?;
    let identity = SweepIdentity::new(&text, &subject, &grid);
    let store = PointStore::open(&args.output, &identity, &grid, args.restart)?;
    let resumed = store.done();
    let outcomes = swept(args, &mut subject, &grid, &store)?;
    let name = args.file.file_name().map(|name| name.to_string_lossy());
    let finished = Finished {
        subject: &subject,
        grid: &grid,
        outcomes: &outcomes,
        identity: &identity,
        file: &name.unwrap_or_default(),
    };
    write_sweep(&args.output, &finished)?;
    store.sort(&outcomes)?;
    Ok(show::sweep::answer(&finished, resumed, &args.output))
}

fn subject(args: &SweepArgs, text: &str) -> Result<Subject, CliError> {
    let failed = |error| CliError::file(&args.file, error);
    if Subject::is_scenario(text) {
        if args.solver.is_some() {
            return Err(CliError::Argument {
                argument: "--solver",
                reason: "a solver goes with a model; this file is a scenario".to_string(),
            });
        }
        let (file, sha256) = Scenario::read(text).map_err(failed)?;
        let scenario = Scenario::from_file(&file, sha256);
        let scenario = scenario.map_err(|error| CliError::value(&args.file, error))?;
        let design = design_of(&scenario, &args.file, args.design.as_deref())?;
        warn(&of_scenario(&scenario, text));
        check_design(&scenario, design.as_ref())
            .map_err(|error| CliError::unsuitable(&args.file, error))?;
        return Ok(Subject::scenario(&file, design.map(Box::new)));
    }
    match &args.design {
        None => {
            let solver = args.solver.unwrap_or(SolverArg::Auto);
            let model = files::parse(&args.file, text, Model::from_json)?;
            warn(&of_model(&model, text));
            let solvers = solver.solvers(solver_order(&model), None);
            Ok(Subject::model(&model, solvers))
        }
        Some(_) => Err(CliError::Argument {
            argument: "--design",
            reason: "a design goes with a scenario; this file is none".to_string(),
        }),
    }
}

fn swept(
    args: &SweepArgs,
    subject: &mut Subject,
    grid: &Grid,
    store: &PointStore,
) -> Result<Vec<PointOutcome>, CliError> {
    let done = store.done();
    let progress = PartsProgress::resume(done, grid.points(), "points");
    let threads = threads(args.jobs)?;
    let done_one = || progress.done();
    let control = progress.control(&done_one);
    if done < grid.points() {
        subject.prepare(&control.stop);
    }
    let outcomes = sweep::run(subject, grid, &threads, store, &control);
    outcomes.map_err(|error| match error {
        SweepError::Interrupted(Interrupted) => CliError::Resumable {
            done: store.done(),
            points: grid.points(),
            folder: args.output.clone(),
        },
        SweepError::Journal(error) => error.into(),
    })
}
