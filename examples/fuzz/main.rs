//! Changed files of every kind through every reader and every proof of Steadfast, in one process.
//!
//! ```text
//! cargo run --release --example fuzz -- --seed 1 --seconds 60
//! ```
//!
//! Exit status 1 when there is a finding: a panic, a wrong answer, or a file that takes more than 5 s. See
//! docs/src/fuzzing.md.

mod fuzzer;

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use fuzzer::{file, run, Corpus, Settings, Tally};

#[derive(Parser)]
#[command(
    about = "Reads, checks and decides changed files of every kind until a count or a time is reached"
)]
struct Arguments {
    /// Of the random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Time at most [s]
    #[arg(long, default_value_t = 60.0)]
    seconds: f64,
    /// Files at most
    #[arg(long, default_value_t = u64::MAX)]
    count: u64,
    /// Index of the first file
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// One file in so many is decided (proofs, exports, plans, solves); the others are read
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u64).range(1..))]
    deep_every: u64,
    /// Folder for the files with findings
    #[arg(long, default_value = "fuzz-findings")]
    folder: PathBuf,
    /// Print the file of this index and stop
    #[arg(long)]
    show: Option<u64>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let corpus = match Corpus::load(&root) {
        Ok(corpus) => corpus,
        Err(error) => {
            eprintln!("error: {}: {error}", root.display());
            return ExitCode::from(1);
        }
    };
    if let Some(index) = arguments.show {
        let deep = index % arguments.deep_every == 0;
        let (seed, bytes) = file(&corpus, arguments.seed, index, deep);
        println!("{}\n{}", seed.name, String::from_utf8_lossy(&bytes));
        return ExitCode::SUCCESS;
    }
    let settings = Settings {
        seed: arguments.seed,
        first: arguments.first,
        count: arguments.count,
        time: Duration::try_from_secs_f64(arguments.seconds).unwrap_or(Duration::MAX),
        deep_every: arguments.deep_every,
        folder: Some(arguments.folder),
    };
    let tally = run(&corpus, &settings, |tally| eprintln!("{}", line(tally)));
    println!(
        "seed {}, files from index {}",
        settings.seed, settings.first
    );
    println!("{}", line(&tally));
    for (name, (seconds, count)) in &tally.by_seed {
        eprintln!("decided {count} of {name} in {seconds:.2} s");
    }
    for finding in &tally.findings {
        println!(
            "file {} (of {}): {}",
            finding.index, finding.of, finding.what
        );
    }
    match tally.findings.is_empty() {
        true => ExitCode::SUCCESS,
        false => ExitCode::from(1),
    }
}

fn line(tally: &Tally) -> String {
    let rate = |count: u64, seconds: f64| count as f64 / seconds.max(1e-9);
    let deciding = tally.seconds - tally.reading_seconds;
    format!(
        "{} files in {:.1} s ({:.0} a second): {} accepted, {} decided, {} proved, {} decided exactly too; \
         reading alone {:.0} a second, the rest {:.0} a second; {} findings",
        tally.files,
        tally.seconds,
        rate(tally.files, tally.seconds),
        tally.accepted,
        tally.decided,
        tally.proved,
        tally.exact,
        rate(tally.read_only, tally.reading_seconds),
        rate(tally.files - tally.read_only, deciding),
        tally.findings.len()
    )
}
