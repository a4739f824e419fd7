//! `steadfast report DIR`

use std::path::{Component, Path, PathBuf};

use crate::base::files::write;
use crate::batch::campaign::folder::{
    run_folder, CAMPAIGN_FILE, DESIGN_FILE, PROFILES_FILE, RUNS_FILE, SCENARIO_FILE,
};
use crate::batch::campaign::record::CampaignFile;
use crate::cli::answer::{Answer, Exit};
use crate::cli::contents::Contents;
use crate::cli::error::CliError;
use crate::cli::show::facts::written;
use crate::cli::target::Targets;
use crate::report::html::PageKind;
use crate::report::pages::campaign;
use crate::report::pages::files::{rebuild_report, ReportError};
use crate::run::files::{REPORT_FILE, SUMMARY_FILE, TRAJECTORY_FILE};

/// Arguments of `report`.
#[derive(clap::Args)]
pub struct ReportArgs {
    /// Folder written by `simulate -o` or `campaign -o`
    folder: PathBuf,
    /// The page; report.html in the folder when left out
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace an output file even where it holds something of another kind
    #[arg(long)]
    force: bool,
}

/// Builds the report page of a run or of a campaign from its files.
pub fn run(args: &ReportArgs) -> Result<Answer, CliError> {
    let default = args.folder.join(REPORT_FILE);
    let path = args.output.as_ref().unwrap_or(&default);
    check_paths(&args.folder, path, args.force)?;
    let page = if args.folder.join(CAMPAIGN_FILE).exists() {
        pages_of_kept_runs(&args.folder)?;
        campaign::page(&args.folder, &link(path, &args.folder)).map_err(|error| match error {
            ReportError::Campaign(error) => CliError::campaign(&args.folder, error),
            other => CliError::unsuitable(&args.folder, other),
        })?
    } else {
        rebuild_report(&args.folder)?
    };
    write(path, &page)?;
    Ok(Answer::text(Exit::Yes, written(path)))
}

/// Files of a folder that a page must not take the place of.
const KEPT_FILES: [&str; 7] = [
    SUMMARY_FILE,
    TRAJECTORY_FILE,
    CAMPAIGN_FILE,
    RUNS_FILE,
    PROFILES_FILE,
    SCENARIO_FILE,
    DESIGN_FILE,
];

/// Refuses what is no folder, and a page that would replace what it is made of.
fn check_paths(folder: &Path, page: &Path, force: bool) -> Result<(), CliError> {
    if !folder.is_dir() {
        let reason = match folder.exists() {
            true => "this is a file; the folder of a run or of a campaign is expected here",
            false => "there is no such folder",
        };
        return Err(CliError::unsuitable(folder, reason));
    }
    let kept = KEPT_FILES.map(|name| folder.join(name));
    let kept: Vec<&Path> = kept.iter().map(PathBuf::as_path).collect();
    let targets = Targets {
        inputs: &kept,
        force,
    };
    let kind = match folder.join(CAMPAIGN_FILE).exists() {
        true => PageKind::Campaign,
        false => PageKind::Run,
    };
    targets.check_file(Some(page), Contents::Page(kind))
}

/// Kept runs that get a page of their own: the worst.
const PAGES: usize = 20;

/// Writes the pages of the worst kept runs of a campaign, those that are not there yet.
fn pages_of_kept_runs(folder: &Path) -> Result<(), CliError> {
    let record = CampaignFile::read(folder).map_err(|error| CliError::campaign(folder, error))?;
    let kept = record
        .results
        .map(|results| results.kept)
        .unwrap_or_default();
    for run in kept.into_iter().take(PAGES) {
        let folder = run_folder(folder, run);
        let page = folder.join(REPORT_FILE);
        // A run whose files were taken away is not linked either.
        if folder.join(TRAJECTORY_FILE).exists() && !page.exists() {
            write(&page, &rebuild_report(&folder)?)?;
        }
    }
    Ok(())
}

/// How a page calls a folder: the way from the page's folder to it.
fn link(page: &Path, folder: &Path) -> String {
    let place = match page.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let (Ok(from), Ok(to)) = (place.canonicalize(), folder.canonicalize()) else {
        return ".".to_string();
    };
    let common = from
        .components()
        .zip(to.components())
        .take_while(|(a, b)| a == b)
        .count();
    let up = from.components().skip(common).map(|_| "..".to_string());
    let down = to.components().skip(common).map(encoded);
    let steps: Vec<String> = up.chain(down).collect();
    match steps.is_empty() {
        true => ".".to_string(),
        false => steps.join("/"),
    }
}

/// A part of a path for a link.
fn encoded(part: Component) -> String {
    let name = part.as_os_str().to_string_lossy().into_owned();
    let kept = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte);
    let one = |byte: u8| match kept(byte) {
        true => char::from(byte).to_string(),
        false => format!("%{byte:02X}"),
    };
    name.bytes().map(one).collect()
}
