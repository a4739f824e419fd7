//! One campaign from the folders of its shards.

use std::fs;
use std::path::{Path, PathBuf};

use super::finish::{remove_others, Source};
use super::folder::{
    run_folder, CampaignFolder, DESIGN_FILE, FAILED_FOLDER, RUNS_FILE, SCENARIO_FILE,
};
use super::record::{CampaignFile, Inputs, RequirementCount, Results};
use super::table::{column_names, CampaignColumns, DRAWN};
use super::CampaignError;
use crate::base::files::{create_folder, read, write, OutputError};
use crate::run::files::{SUMMARY_FILE, TRAJECTORY_FILE};

/// A shard's folder.
struct ShardFolder {
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
    let shards = folders.iter().map(|folder| shard(folder));
    let mut shards = shards.collect::<Result<Vec<_>, _>>()?;
    shards.sort_by_key(|shard| (shard.inputs.first_run, shard.inputs.end_run));
    check(&shards)?;
    let Some(first) = shards.first() else {
        return Err(CampaignError::Shards("no folder is given".to_string()));
    };
    let (scenario, design) = texts(first)?;
    let whole = CampaignFolder {
        path: output.to_path_buf(),
        columns: columns(first)?,
        inputs: whole(&first.inputs),
    };
    let _open = whole.open(&scenario, design.as_deref())?;
    whole.write_tables(|name, content| {
        let sources = shards.iter().map(|shard| Source {
            path: shard.folder.join(name),
            content,
            inputs: shard.inputs.to_json(),
        });
        sources.collect()
    })?;
    let count = whole.count(keep)?;
    let kept = copy_kept(&shards, output, &count.worst_runs())?;
    whole.conclude(count, kept, missed(&shards))
}

/// How many runs of all shards, which are of one campaign, missed each requirement.
fn missed(shards: &[ShardFolder]) -> Vec<RequirementCount> {
    let each = shards
        .iter()
        .map(|shard| shard.results.requirements.clone());
    let all = each.reduce(|mut all, own| {
        let pairs = all.iter_mut().zip(own);
        pairs.for_each(|(all, own)| all.missed += own.missed);
        all
    });
    all.unwrap_or_default()
}

fn shard(folder: &Path) -> Result<ShardFolder, CampaignError> {
    let record = CampaignFile::read(folder)?;
    match record.results {
        Some(results) => Ok(ShardFolder {
            folder: folder.to_path_buf(),
            inputs: record.inputs,
            results,
        }),
        None => {
            let reason = "is not complete; the command that made it goes on where it stopped";
            Err(CampaignError::unsuitable(folder, reason.to_string()))
        }
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

/// Refuses shards of different campaigns, gaps and overlaps.
fn check(shards: &[ShardFolder]) -> Result<(), CampaignError> {
    let pairs = || shards.iter().zip(shards.iter().skip(1));
    for (one, other) in pairs() {
        if let Some(difference) = whole(&other.inputs).difference(&whole(&one.inputs)) {
            return Err(CampaignError::Shards(format!(
                "{} is a shard of another campaign than {}: {difference}",
                other.folder.display(),
                one.folder.display()
            )));
        }
    }
    let begin = shards.first().map_or(0, |first| first.inputs.first_run);
    if begin > 0 {
        return Err(missing(0, begin));
    }
    for (one, other) in pairs() {
        let (next, first) = (one.inputs.end_run, other.inputs.first_run);
        if first > next {
            return Err(missing(next, first));
        }
        if first < next {
            return Err(CampaignError::Shards(format!(
                "{} and {} both hold run {first}",
                one.folder.display(),
                other.folder.display()
            )));
        }
    }
    match shards.last().map(|last| &last.inputs) {
        Some(last) if last.end_run < last.runs => Err(missing(last.end_run, last.runs)),
        _ => Ok(()),
    }
}

fn missing(from: u64, to: u64) -> CampaignError {
    CampaignError::Shards(format!("no folder holds the runs {from} to {}", to - 1))
}

fn texts(shard: &ShardFolder) -> Result<(String, Option<String>), CampaignError> {
    let read = |name: &str| read(&shard.folder.join(name));
    let design = shard.inputs.design_sha256.as_ref();
    Ok((
        read(SCENARIO_FILE)?,
        design.map(|_| read(DESIGN_FILE)).transpose()?,
    ))
}

fn columns(shard: &ShardFolder) -> Result<CampaignColumns, CampaignError> {
    let names = column_names(&shard.folder.join(RUNS_FILE))?;
    let drawn = names.iter().filter_map(|name| name.strip_prefix(DRAWN));
    Ok(CampaignColumns {
        drawn: drawn.map(str::to_string).collect(),
        profile: shard.results.profile.clone(),
    })
}

/// Copies the folders of the worst runs; those that no shard has kept are left out.
fn copy_kept(
    shards: &[ShardFolder],
    output: &Path,
    worst: &[u64],
) -> Result<Vec<u64>, CampaignError> {
    remove_others(&output.join(FAILED_FOLDER), worst)?;
    let mut kept = Vec::new();
    for &run in worst {
        let holder = shards
            .iter()
            .find(|shard| shard.results.kept.contains(&run));
        let Some(holder) = holder else { continue };
        let (from, to) = (run_folder(&holder.folder, run), run_folder(output, run));
        create_folder(&to)?;
        for name in [SCENARIO_FILE, TRAJECTORY_FILE, SUMMARY_FILE] {
            let (from, to) = (from.join(name), to.join(name));
            let bytes = fs::read(&from);
            let bytes = bytes.map_err(|source| OutputError::io(&from, "cannot be read", source))?;
            write(&to, &bytes)?;
        }
        kept.push(run);
    }
    Ok(kept)
}
