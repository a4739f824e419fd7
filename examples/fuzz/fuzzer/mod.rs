//! Changed files through every reader and every proof, in one process.
//!
//! The file of index i depends on the seed and i only, so that one can be made again.

mod corpus;
mod mutate;
mod targets;
mod tokens;

use std::panic::{catch_unwind, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use rand_chacha::rand_core::SeedableRng;
use rand_chacha::ChaCha8Rng;

pub use corpus::Corpus;
use corpus::{Reader, Seed};
use mutate::{mutated, Dice};
use targets::{attempt, Effect};

/// A file that takes longer than this is a finding [s].
const SLOW: f64 = 5.0;

/// What is run.
#[derive(Debug, Clone)]
pub struct Settings {
    /// Of the random numbers.
    pub seed: u64,
    /// First index.
    pub first: u64,
    /// Files at most.
    pub count: u64,
    /// Time at most.
    pub time: Duration,
    /// One file in so many is decided (proved, exported, planned, solved), the others are read.
    pub deep_every: u64,
    /// Where the files with findings are written.
    pub folder: Option<PathBuf>,
}

/// What came of it.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    /// Time in the files of each seed that are decided (s), and how many.
    pub by_seed: std::collections::BTreeMap<String, (f64, u64)>,
    /// Files.
    pub files: u64,
    /// Those that were read and whose values are allowed.
    pub accepted: u64,
    /// Those whose proof was decided, or that were solved.
    pub decided: u64,
    /// Those that were proved.
    pub proved: u64,
    /// Those that were decided once more exactly.
    pub exact: u64,
    /// Time (s).
    pub seconds: f64,
    /// Of it, in files that are read only (s).
    pub reading_seconds: f64,
    /// Files that are read only.
    pub read_only: u64,
    /// Panics, wrong answers and slow files.
    pub findings: Vec<Finding>,
}

/// A file with which something is wrong.
#[derive(Debug, Clone)]
pub struct Finding {
    /// Index of the file.
    pub index: u64,
    /// Name of the file that was changed.
    pub of: String,
    /// What is wrong.
    pub what: String,
    /// The file.
    pub bytes: Vec<u8>,
}

/// Most findings that are kept.
const MOST_FINDINGS: usize = 100;

/// Runs until the count or the time is reached.
pub fn run(corpus: &Corpus, settings: &Settings, mut progress: impl FnMut(&Tally)) -> Tally {
    let message = Arc::new(Mutex::new(String::new()));
    let quiet = Quiet::new(Arc::clone(&message));
    let begin = Instant::now();
    let mut tally = Tally::default();
    let mut last = begin;
    for index in settings.first..settings.first.saturating_add(settings.count) {
        let start = Instant::now();
        if start - begin >= settings.time || tally.findings.len() >= MOST_FINDINGS {
            break;
        }
        if start - last > Duration::from_secs(10) {
            tally.seconds = begin.elapsed().as_secs_f64();
            progress(&tally);
            last = start;
        }
        let deep = index % settings.deep_every == 0;
        let (seed, bytes) = file(corpus, settings.seed, index, deep);
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            attempt(reader(seed, index), &bytes, deep)
        }));
        let seconds = start.elapsed().as_secs_f64();
        let effect = outcome.unwrap_or_else(|_| Effect {
            wrong: Some(
                message
                    .lock()
                    .map_or_else(|_| "a panic".to_string(), |text| text.clone()),
            ),
            ..Effect::default()
        });
        tally.add(&effect, deep, seconds);
        if deep {
            let entry = tally.by_seed.entry(seed.name.clone()).or_default();
            *entry = (entry.0 + seconds, entry.1 + 1);
        }
        let slow = (seconds > SLOW).then(|| format!("took {seconds:.1} s"));
        if let Some(what) = effect.wrong.or(slow) {
            let finding = Finding {
                index,
                of: seed.name.clone(),
                what,
                bytes,
            };
            if let Some(folder) = &settings.folder {
                keep(folder, &finding);
            }
            tally.findings.push(finding);
        }
    }
    drop(quiet);
    tally.seconds = begin.elapsed().as_secs_f64();
    tally
}

/// While it lives, the messages of this thread's panics go to a text; those of other threads are printed as before.
struct Quiet(Arc<Hook>);

type Hook = Box<dyn Fn(&std::panic::PanicHookInfo<'_>) + Send + Sync>;

impl Quiet {
    fn new(heard: Arc<Mutex<String>>) -> Self {
        let before: Arc<Hook> = Arc::new(std::panic::take_hook());
        let (others, here) = (Arc::clone(&before), std::thread::current().id());
        std::panic::set_hook(Box::new(move |info| match heard.lock() {
            Ok(mut message) if std::thread::current().id() == here => *message = info.to_string(),
            _ => others(info),
        }));
        Quiet(before)
    }
}

impl Drop for Quiet {
    fn drop(&mut self) {
        // A hook cannot be set while a panic goes on.
        if std::thread::panicking() {
            return;
        }
        let before = Arc::clone(&self.0);
        std::panic::set_hook(Box::new(move |info| before(info)));
    }
}

impl Tally {
    fn add(&mut self, effect: &Effect, deep: bool, seconds: f64) {
        self.files += 1;
        self.accepted += u64::from(effect.accepted);
        self.decided += u64::from(effect.decided);
        self.proved += u64::from(effect.proved);
        self.exact += u64::from(effect.exact);
        if !deep {
            self.read_only += 1;
            self.reading_seconds += seconds;
        }
    }
}

/// The file of an index: which one is changed, and its bytes.
pub fn file(corpus: &Corpus, seed: u64, index: u64, deep: bool) -> (&Seed, Vec<u8>) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(index);
    let mut dice = Dice(random);
    let mut chosen = &corpus.seeds[smallest(corpus.seeds.len(), &mut dice)];
    // Half of the files that are decided have a proof.
    if deep && (chosen.long || dice.below(2) == 0) {
        chosen = &corpus.seeds[corpus.proofs[smallest(corpus.proofs.len(), &mut dice)]];
    }
    let small = deep && dice.below(4) > 0 && !chosen.numbers.is_empty();
    let bytes = mutated(chosen, corpus, small, &mut dice);
    (chosen, bytes)
}

/// The smallest of three places among seeds that are sorted by size: more files in the same time, and still some of
/// every size.
fn smallest(count: usize, dice: &mut Dice) -> usize {
    let drawn = [(); 3].map(|()| dice.below(count));
    drawn.into_iter().fold(count, usize::min)
}

/// How a file is read: now and then as what it is not.
fn reader(seed: &Seed, index: u64) -> Reader {
    let readers = [
        Reader::Json,
        Reader::Summary,
        Reader::Campaign,
        Reader::Trajectory,
        Reader::Sdpa,
        Reader::SdpaDense,
        Reader::Axis,
    ];
    match index % 256 {
        at @ 1..=7 => readers[at as usize - 1],
        _ => seed.reader,
    }
}

/// Writes a file with a finding, and what it is.
fn keep(folder: &Path, finding: &Finding) {
    let name = format!("{}-{}", finding.index, finding.of);
    let kept = std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(folder.join(&name), &finding.bytes))
        .and_then(|()| std::fs::write(folder.join(format!("{name}.txt")), &finding.what));
    if let Err(error) = kept {
        eprintln!(
            "{}: cannot be written: {error}",
            folder.join(name).display()
        );
    }
}
