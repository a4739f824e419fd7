//! Designs and trajectories in the formats of other programs.

use std::path::Path;

use synth::model::{kind_of, Kind};

use super::args::{Exported, FormatArg};
use crate::base::provenance::sha256_of;
use crate::cli::error::CliError;
use crate::cli::files;
use crate::export::design::DesignData;
use crate::export::trajectory::TrajectoryData;
use crate::export::{c_header, csv, mat};
use crate::run::design::Design;
use crate::run::files::{read_summary, read_trajectory, SUMMARY_FILE, TRAJECTORY_FILE};

/// A design file, proved again from its numbers.
pub fn design(path: &Path, format: FormatArg) -> Result<Exported, CliError> {
    let text = files::text(path)?;
    let data = match kind_of(&text) {
        Some(Kind::ProblemDesign) => {
            let (file, problem) = files::problem_design_of(path, &text)?;
            let report = file
                .verify(&problem)
                .map_err(|fault| CliError::value(path, fault))?;
            DesignData::of_problem(&file, &problem, &report, &text)
        }
        Some(Kind::Design) | None => {
            let design = Design::from_json(&text).map_err(|fault| CliError::file(path, fault))?;
            design
                .law_gains()
                .map_err(|fault| CliError::unsuitable(path, fault))?;
            DesignData::of_design(&design)
        }
        Some(other) => {
            let reason = format!(
                "this is a {other} file; {} is for design files{}",
                format.name(),
                if format == FormatArg::C {
                    ""
                } else {
                    " and trajectories"
                }
            );
            return Err(CliError::unsuitable(path, reason));
        }
    };
    let failed = |fault: &dyn std::fmt::Display| CliError::unsuitable(path, fault);
    let bytes = match format {
        FormatArg::Csv => csv::design(&data)
            .map_err(|fault| failed(&fault))?
            .into_bytes(),
        FormatArg::Mat => mat::design(&data).map_err(|fault| failed(&fault))?,
        FormatArg::C => c_header::design(&data).into_bytes(),
        FormatArg::Parquet | FormatArg::Sdpa => {
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
    if format == FormatArg::C {
        let reason = "this is a trajectory; c is for design files, use csv, parquet or mat";
        return Err(CliError::unsuitable(path, reason));
    }
    let (text, table) = read_trajectory(path)?;
    let summary = folder.join(SUMMARY_FILE);
    let beside = path.file_name() == Some(TRAJECTORY_FILE.as_ref()) && summary.exists();
    let summary = beside.then(|| read_summary(&summary)).transpose()?;
    let data = TrajectoryData::new(table, summary.as_ref(), sha256_of(&text));
    let bytes = match format {
        FormatArg::Parquet => data
            .to_parquet()
            .map_err(|fault| CliError::unsuitable(path, fault))?,
        FormatArg::Mat => data
            .to_mat()
            .map_err(|fault| CliError::unsuitable(path, fault))?,
        FormatArg::Csv | FormatArg::C | FormatArg::Sdpa => data.table.to_csv().into_bytes(),
    };
    Ok(Exported {
        bytes,
        not_proved: None,
    })
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
