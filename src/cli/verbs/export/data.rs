//! Designs and trajectories in the formats of other programs.

use std::path::Path;

use clap::ValueEnum;
use synth::model::{kind_of, Kind};
use synth::problem::ProblemDesignFile;

use crate::base::provenance::sha256_of;
use crate::cli::contents::{Contents, DESIGN_TABLE};
use crate::cli::error::CliError;
use crate::cli::files;
use crate::export::design::DesignData;
use crate::export::trajectory::TrajectoryData;
use crate::export::{c_header, csv, mat};
use crate::run::design::Design;
use crate::run::files::{read_summary, read_trajectory, SUMMARY_FILE, TRAJECTORY_FILE};

/// Formats.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FormatArg {
    /// SDPA sparse text (.dat-s): the first problem that synthesis solves, in its scaled units; the
    /// first line says what its optimum is
    Sdpa,
    /// Comma-separated values, of a design or a trajectory
    Csv,
    /// Apache Parquet, of a trajectory
    Parquet,
    /// MAT-file for MATLAB, Octave and scipy, of a design or a trajectory
    Mat,
    /// C header of static const tables, of a design
    C,
    /// Folder with a controller that runs, in C99 with its test, of a design or of a scenario
    C99,
    /// Python file with a module for the Basilisk simulator, of a design or of a scenario
    Basilisk,
    /// Functional mock-up unit: FMI 2.0 for co-simulation, as sources, of a design or of a scenario
    Fmu,
}

impl FormatArg {
    /// As on the command line.
    pub fn name(self) -> String {
        let value = self.to_possible_value();
        value.map_or(String::new(), |value| value.get_name().to_string())
    }
}

impl FormatArg {
    /// What a file of this format holds, of a trajectory or of something else.
    pub fn contents(self, of_trajectory: bool) -> Contents {
        match self {
            FormatArg::Sdpa => Contents::Sdpa,
            FormatArg::Csv if of_trajectory => Contents::Trajectory,
            FormatArg::Csv => DESIGN_TABLE,
            FormatArg::Parquet => Contents::Parquet,
            FormatArg::Mat => Contents::Mat,
            FormatArg::C => Contents::Header,
            FormatArg::C99 => Contents::FlightCode,
            FormatArg::Basilisk => Contents::Basilisk,
            FormatArg::Fmu => Contents::Unit,
        }
    }
}

/// What was put together: the bytes, and why the answer is no where it is.
pub struct Exported {
    /// The file.
    pub bytes: Vec<u8>,
    /// What is not proved.
    pub not_proved: Option<String>,
}

/// A design file, proved again from its numbers.
pub fn design(path: &Path, format: FormatArg) -> Result<Exported, CliError> {
    let text = files::text(path)?;
    let data = match kind_of(&text) {
        Some(Kind::ProblemDesign) => {
            let (file, problem) = files::parse(path, &text, ProblemDesignFile::from_json)?;
            let report = file.verify(&problem);
            let report = report.map_err(|fault| CliError::value(path, fault))?;
            DesignData::of_problem(&file, &problem, &report, &text)
        }
        Some(Kind::Design) | None => {
            let design = files::parse(path, &text, Design::from_json)?;
            usable(path, design.law_gains())?;
            DesignData::of_design(&design)
        }
        Some(other) => {
            let more = match format {
                FormatArg::C => "",
                _ => " and trajectories",
            };
            let name = format.name();
            let reason = format!(
                "this is {} file; {name} is for design files{more}",
                other.with_article()
            );
            return Err(CliError::unsuitable(path, reason));
        }
    };
    let bytes = match format {
        FormatArg::Csv => usable(path, csv::design(&data))?.into_bytes(),
        FormatArg::Mat => usable(path, mat::design(&data))?,
        FormatArg::C => c_header::design(&data).into_bytes(),
        FormatArg::Parquet
        | FormatArg::Sdpa
        | FormatArg::C99
        | FormatArg::Basilisk
        | FormatArg::Fmu => {
            let reason =
                "this is a design, a few matrices; parquet is for trajectories, use csv, mat or c";
            return Err(CliError::unsuitable(path, reason));
        }
    };
    let not_proved = (!data.proved).then(|| {
        let count = data.failed.len();
        format!("NOT PROVED ({count} conditions); the export says so")
    });
    Ok(Exported { bytes, not_proved })
}

/// A trajectory with the summary beside it.
pub fn trajectory(path: &Path, format: FormatArg) -> Result<Exported, CliError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    if !path.exists() && folder.is_dir() {
        return Err(CliError::unsuitable(folder, no_trajectory(folder)));
    }
    if matches!(
        format,
        FormatArg::C | FormatArg::C99 | FormatArg::Basilisk | FormatArg::Fmu
    ) {
        let name = format.name();
        let reason =
            format!("this is a trajectory; {name} is for design files, use csv, parquet or mat");
        return Err(CliError::unsuitable(path, reason));
    }
    let (text, table) = read_trajectory(path)?;
    let summary = folder.join(SUMMARY_FILE);
    let beside = path.file_name() == Some(TRAJECTORY_FILE.as_ref()) && summary.exists();
    let summary = beside.then(|| read_summary(&summary)).transpose()?;
    let data = TrajectoryData::new(table, summary.as_ref(), sha256_of(&text));
    let bytes = match format {
        FormatArg::Parquet => usable(path, data.to_parquet())?,
        FormatArg::Mat => usable(path, data.to_mat())?,
        _ => data.table.to_csv().into_bytes(),
    };
    Ok(Exported {
        bytes,
        not_proved: None,
    })
}

/// What was made of a file, or why it is not suitable.
pub fn usable<T, E: std::fmt::Display>(path: &Path, made: Result<T, E>) -> Result<T, CliError> {
    made.map_err(|fault| CliError::unsuitable(path, fault))
}

/// What to say of a folder without a trajectory.
fn no_trajectory(folder: &Path) -> String {
    if folder.join("campaign.json").exists() {
        return "this is a campaign's folder, whose tables are Parquet already; name the folder of one \
                run, such as those in its folder failed"
            .to_string();
    }
    "holds no trajectory.csv; a folder written by `simulate -o` is needed".to_string()
}
