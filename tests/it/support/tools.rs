//! Other people's programs, used where they are installed.

use std::path::Path;
use std::process::Command;

/// Runs a Python script with arguments; what it prints, or `None`, said loudly, where Python or a module is
/// missing.
#[track_caller]
pub fn python(modules: &[&str], script: &str, arguments: &[&Path]) -> Option<String> {
    let check = format!("import {}", modules.join(", "));
    let found = Command::new("python3").args(["-c", &check]).output();
    if !found.is_ok_and(|run| run.status.success()) {
        eprintln!("SKIPPED: python3 with {modules:?} is not installed; nothing was compared");
        return None;
    }
    let run = Command::new("python3")
        .args(["-c", script])
        .args(arguments)
        .env("MPLBACKEND", "Agg")
        .output()
        .expect("python3 runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(run.status.success(), "{}", text(&run.stderr));
    Some(text(&run.stdout))
}

/// Compiles a program with the given compiler and runs it; what it prints, or `None`, said loudly, where
/// the compiler is missing. Any warning is a failure.
#[track_caller]
pub fn compiled(compiler: &str, options: &[&str], source: &Path) -> Option<String> {
    let program = source.with_extension("out");
    let run = Command::new(compiler)
        .args(["-Wall", "-Wextra", "-pedantic", "-Werror"])
        .args(options)
        .arg(source)
        .arg("-o")
        .arg(&program)
        .output();
    let Ok(run) = run else {
        eprintln!("SKIPPED: {compiler} is not installed; nothing was compiled");
        return None;
    };
    let complaint = String::from_utf8_lossy(&run.stderr).into_owned();
    assert!(run.status.success(), "{compiler} {options:?}: {complaint}");
    let run = Command::new(&program).output().expect("the program runs");
    assert!(run.status.success());
    Some(String::from_utf8(run.stdout).expect("text"))
}

/// Whether a program is installed; says so loudly where it is not.
pub fn installed(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok();
    if !found {
        eprintln!("SKIPPED: {program} is not installed; nothing was tried with it");
    }
    found
}
