//! `steadfast merge DIR1 DIR2 ... -o DIR`

use std::path::PathBuf;
use std::process::ExitCode;

use super::campaign::KEPT;
use crate::batch::campaign::merge::merge;
use crate::batch::campaign::record::CampaignFile;
use crate::batch::campaign::CampaignError;
use crate::cli::answer::EXIT_NO;
use crate::cli::error::CliError;
use crate::cli::show::campaign::print_results;

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
    /// Most failed runs that are kept with their trajectory, of those that the shards have kept
    #[arg(long, value_name = "K", default_value_t = KEPT)]
    keep: usize,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Merges shards. 0: every run met every requirement; 2: some did not.
pub fn run(args: &MergeArgs) -> Result<ExitCode, CliError> {
    let failed = |error: CampaignError| CliError::Campaign(error.to_string());
    let results = merge(&args.folders, &args.output, args.keep).map_err(failed)?;
    let record = CampaignFile::read(&args.output).map_err(failed)?;
    print_results(&results, &record.inputs, &args.output, args.json);
    Ok(match results.failures {
        0 => ExitCode::SUCCESS,
        _ => ExitCode::from(EXIT_NO),
    })
}
