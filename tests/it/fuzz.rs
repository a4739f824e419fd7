//! The in-process fuzzer of `examples/fuzz`, briefly.

#[path = "../../examples/fuzz/fuzzer/mod.rs"]
mod fuzzer;

use std::path::Path;
use std::time::Duration;

use fuzzer::{file, run, Corpus, Settings};

fn corpus() -> Corpus {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    Corpus::load(root).expect("the repository's files")
}

#[test]
fn changed_files_of_every_kind_cause_no_panic_and_no_wrong_answer() {
    let settings = Settings {
        seed: 20260,
        first: 0,
        count: 20_000,
        time: Duration::from_secs(600),
        deep_every: 40,
        folder: None,
    };
    let tally = run(&corpus(), &settings, |_| {});
    let told = tally.findings.iter();
    let told = told.map(|finding| {
        let text = String::from_utf8_lossy(&finding.bytes);
        format!(
            "file {} (of {}): {}\n{text}",
            finding.index, finding.of, finding.what
        )
    });
    assert!(
        tally.findings.is_empty(),
        "{}",
        told.collect::<Vec<_>>().join("\n")
    );
    assert_eq!(tally.files, settings.count);
    // Every stage is reached: files that are allowed, files that are not, proofs that hold and proofs that do not.
    assert!(
        tally.accepted > 2_000 && tally.accepted < 18_000,
        "{tally:?}"
    );
    assert!(
        tally.decided > 100 && tally.proved > 20 && tally.proved < tally.decided,
        "{tally:?}"
    );
}

#[test]
fn a_file_of_the_fuzzer_is_made_again_from_seed_and_index() {
    let corpus = corpus();
    for index in [0, 1, 12_345_678_901] {
        let (one, two) = (file(&corpus, 7, index, true), file(&corpus, 7, index, true));
        assert_eq!((&one.0.name, one.1), (&two.0.name, two.1));
    }
    let different = file(&corpus, 8, 1, true);
    assert_ne!(file(&corpus, 7, 1, true).1, different.1);
}
