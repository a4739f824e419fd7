//! What the tests of bad input share: a refusal is one clear sentence, exit status 1, nothing written.
#![allow(dead_code)] // Each test file uses a part.

use serde_json::Value;

use super::*;

/// A refusal of `synthesize` for the given file contents; nothing may be written.
#[track_caller]
pub fn synthesize_refusal(contents: impl AsRef<[u8]>) -> String {
    let folder = folder();
    let model = write(folder.path(), "model.json", contents);
    let output = folder.path().join("design.json");
    let run = steadfast([
        "synthesize".as_ref(),
        model.as_os_str(),
        "-o".as_ref(),
        output.as_ref(),
    ]);
    let message = run.refusal();
    assert_eq!(names_in(folder.path()), ["model.json"], "{message}");
    let named = message.strip_prefix(&format!("{}: ", model.display()));
    let message = named
        .unwrap_or_else(|| panic!("the file is not named: {message}"))
        .to_string();
    assert_plain(&message);
    message
}

/// No word of the implementation's language.
#[track_caller]
pub fn assert_plain(message: &str) {
    for word in [
        "f64", "u32", "usize", "struct", "Model", "Vec", "variant", "panicked",
    ] {
        assert!(!message.contains(word), "{word} in: {message}");
    }
}

/// Every part is said.
#[track_caller]
pub fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{part}' is not in: {message}");
    }
}

/// The model of Xu and Huang's spacecraft.
pub fn spacecraft() -> Value {
    json(&shipped("xu2020.json"))
}

/// The model of the cart.
pub fn cart() -> Value {
    json(&shipped("double-integrator.json"))
}
