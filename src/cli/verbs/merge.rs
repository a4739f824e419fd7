//! `steadfast merge DIR1 DIR2 ... -o DIR`

use std::path::PathBuf;

use super::campaign::{check_folder, KEPT};
use crate::batch::campaign::merge::merge;
use crate::batch::campaign::record::CampaignFile;
use crate::batch::campaign::CampaignError;
use crate::cli::answer::Answer;
use crate::cli::arguments::whole;
use crate::cli::error::CliError;
use crate::cli::show::campaign::answer;

/// Arguments of `merge`.
#[derive(clap::Args)]
#[command(allow_negative_numbers = true)]
pub struct MergeArgs {
    /// Folders of all shards of a campaign, in any order
    #[arg(required = true)]
    folders: Vec<PathBuf>,
    /// Folder for the whole campaign
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
    /// Most failed runs that are kept with their trajectory, of those that the shards have kept
    #[arg(long, value_name = "K", default_value_t = KEPT, value_parser = whole)]
    keep: u64,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Merges shards. 0: every run met every requirement; 2: some did not.
pub fn run(args: &MergeArgs) -> Result<Answer, CliError> {
    check_folder(&args.output, &[], args.force)?;
    let failed = |error: CampaignError| CliError::Campaign(error.to_string());
    let results = merge(&args.folders, &args.output, args.keep as usize).map_err(failed)?;
    let record = CampaignFile::read(&args.output).map_err(failed)?;
    Ok(answer(&results, &record.inputs, &args.output))
}
