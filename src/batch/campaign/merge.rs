//! One campaign from the folders of its shards.

use std::fs;
use std::path::{Path, PathBuf};

use synth::model::read_text;

use super::finish::{concatenate, conclude, remove_others, Record, Source};
use super::folder::{
    run_folder, DESIGN_FILE, FAILED_FOLDER, PROFILES_FILE, RUNS_FILE, SCENARIO_FILE,
};
use super::parts::{difference, inputs_text, prepare};
use super::record::{CampaignFile, Inputs, ProfileGrid, Results};
use super::table::{column_names, Columns, Content};
use super::CampaignError;
use crate::base::files::create_folder;
use crate::run::files::{SUMMARY_FILE, TRAJECTORY_FILE};

/// Prefix of the columns of drawn numbers.
const DRAWN: &str = "drawn.";

/// A shard's folder.
struct Part {
    folder: PathBuf,
    inputs: Inputs,
    results: Results,
}

/// Merges the folders of all shards of a campaign into another folder. `keep`: most failed runs that are
/// kept with their trajectory, of those that the shards have kept.
///
/// # Errors
/// Shards that are not complete, of different campaigns, missing or there twice; files that cannot be
/// read or written.
pub fn merge(folders: &[PathBuf], output: &Path, keep: usize) -> Result<Results, CampaignError> {
    let mut parts = folders
        .iter()
        .map(|folder| read(folder))
        .collect::<Result<Vec<_>, _>>()?;
    parts.sort_by_key(|part| (part.inputs.first_run, part.inputs.end_run));
    check_same(&parts)?;
    check_whole(&parts)?;
    let Some(first) = parts.first() else {
        return Err(CampaignError::Shards("no folder is given".to_string()));
    };
    let inputs = whole(&first.inputs);
    let (scenario, design) = texts(first)?;
    prepare(output, &inputs, &scenario, design.as_deref())?;
    let columns = columns(first)?;
    let table = |name: &'static str, content: Content| {
        let sources = parts.iter().map(move |part| Source {
            path: part.folder.join(name),
            content,
            inputs: inputs_text(&part.inputs),
        });
        sources.collect::<Vec<Source>>()
    };
    let text = inputs_text(&inputs);
    let all = (0, inputs.runs);
    let written = |name: &'static str, content: Content| {
        let path = output.join(name);
        let sources = table(name, content);
        concatenate(&sources, &columns, (&path, content), &text, all, keep)
    };
    let count = written(RUNS_FILE, Content::Runs)?;
    written(PROFILES_FILE, Content::Profiles)?;
    let kept = copy_kept(&parts, output, &count.worst_runs())?;
    let record = Record {
        count: &count,
        kept,
        requirements: first.results.requirements.clone(),
        profile: first.results.profile.clone(),
    };
    conclude(output, &inputs, record)
}

fn read(folder: &Path) -> Result<Part, CampaignError> {
    let record = CampaignFile::read(folder)?;
    match record.results {
        Some(results) => Ok(Part {
            folder: folder.to_path_buf(),
            inputs: record.inputs,
            results,
        }),
        None => Err(CampaignError::Unsuitable {
            path: folder.to_path_buf(),
            reason: "is not complete; the command that made it goes on where it stopped"
                .to_string(),
        }),
    }
}

/// The inputs of the whole campaign.
fn whole(inputs: &Inputs) -> Inputs {
    Inputs {
        shard: None,
        first_run: 0,
        end_run: inputs.runs,
        ..inputs.clone()
    }
}

fn check_same(parts: &[Part]) -> Result<(), CampaignError> {
    for pair in parts.windows(2) {
        let [one, other] = pair else { continue };
        if let Some(difference) = difference(&whole(&other.inputs), &whole(&one.inputs)) {
            return Err(CampaignError::Shards(format!(
                "{} is a shard of another campaign than {}: {difference}",
                other.folder.display(),
                one.folder.display()
            )));
        }
    }
    Ok(())
}

/// Refuses gaps and overlaps.
fn check_whole(parts: &[Part]) -> Result<(), CampaignError> {
    let mut next = 0;
    let mut before: Option<&Part> = None;
    for part in parts {
        let first = part.inputs.first_run;
        if first > next {
            return Err(missing(next, first));
        }
        if let Some(before) = before.filter(|_| first < next) {
            return Err(CampaignError::Shards(format!(
                "{} and {} both hold run {first}",
                before.folder.display(),
                part.folder.display()
            )));
        }
        next = part.inputs.end_run;
        before = Some(part);
    }
    match before {
        Some(part) if next < part.inputs.runs => Err(missing(next, part.inputs.runs)),
        _ => Ok(()),
    }
}

fn missing(from: u64, to: u64) -> CampaignError {
    CampaignError::Shards(format!("no folder holds the runs {from} to {}", to - 1))
}

fn texts(part: &Part) -> Result<(String, Option<String>), CampaignError> {
    let read = |name: &str| {
        let path = part.folder.join(name);
        read_text(&path).map_err(|problem| CampaignError::file(&path, problem))
    };
    let design = part.inputs.design_sha256.as_ref();
    Ok((
        read(SCENARIO_FILE)?,
        design.map(|_| read(DESIGN_FILE)).transpose()?,
    ))
}

fn columns(part: &Part) -> Result<Columns, CampaignError> {
    let names = column_names(&part.folder.join(RUNS_FILE))?;
    let drawn = names.iter().filter_map(|name| name.strip_prefix(DRAWN));
    let ProfileGrid {
        times_s,
        quantities,
    } = part.results.profile.clone();
    Ok(Columns {
        drawn: drawn.map(str::to_string).collect(),
        quantities,
        times_s,
    })
}

/// Copies the folders of the worst runs; those that no shard has kept are left out.
fn copy_kept(parts: &[Part], output: &Path, worst: &[u64]) -> Result<Vec<u64>, CampaignError> {
    remove_others(&output.join(FAILED_FOLDER), worst)?;
    let mut kept = Vec::new();
    for &run in worst {
        let holder = parts.iter().find(|part| part.results.kept.contains(&run));
        let Some(holder) = holder else { continue };
        let (from, to) = (run_folder(&holder.folder, run), run_folder(output, run));
        create_folder(&to)?;
        for name in [SCENARIO_FILE, TRAJECTORY_FILE, SUMMARY_FILE] {
            let (from, to) = (from.join(name), to.join(name));
            let bytes = fs::read(&from).map_err(|source| CampaignError::read(&from, source))?;
            synth::model::write_atomically(&to, &bytes)
                .map_err(|problem| CampaignError::file(&to, problem))?;
        }
        kept.push(run);
    }
    Ok(kept)
}
