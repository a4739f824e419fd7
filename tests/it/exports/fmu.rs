//! The functional mock-up unit, the files for MATLAB, and how they are compiled.

use super::flight::{Flight, STRICT};
use super::*;
use crate::support::tools::installed;
use std::process::Command;

const SCRIPT: &str = include_str!("fmu.py");

/// A unit of a design or scenario.
fn unit(file: &Path, folder: &Path) -> PathBuf {
    let out = folder.join("controller.fmu");
    let run = export(file, "fmu", Some(&out));
    assert!(matches!(run.status, Some(0 | 2)), "{run:#?}");
    out
}

#[test]
fn a_unit_is_valid_and_answers_with_the_bits_of_the_reference() {
    let modules = ["fmpy", "numpy"];
    if python(&modules, "pass", &[]).is_none() {
        return;
    }
    let wu = shipped("wu2018.json");
    for (file, input) in [
        (xu2020_design(), "torque_nm"),
        (double_integrator_design(), "input"),
        (&wu, "torque_nm"),
    ] {
        let folder = folder();
        let unit = unit(file, folder.path());
        let flight = Flight::of(file, &[]);
        let vectors = flight.path("_vectors.h");
        let said = python(&modules, SCRIPT, &[&unit, &vectors, Path::new(input)]);
        let said = said.expect("Python is there");
        let agreed: u32 = said
            .lines()
            .last()
            .and_then(|line| line.parse().ok())
            .expect("a number");
        assert!(agreed > 370, "{said}");
        println!("{}: {agreed} samples agree to the last bit", flight.name);
    }
}

#[test]
fn the_same_controller_is_the_same_unit_and_its_parts_are_inside() {
    let folder = folder();
    let first = std::fs::read(unit(xu2020_design(), folder.path())).expect("a unit");
    let again = std::fs::read(unit(xu2020_design(), folder.path())).expect("a unit");
    assert!(first == again && first.starts_with(b"PK"));
    let text = String::from_utf8_lossy(&first).into_owned();
    for part in [
        "modelDescription.xml",
        "sources/xu2020.c",
        "sources/xu2020_fmu.c",
        "sources/xu2020.h",
    ] {
        assert!(text.contains(part), "{part}");
    }
    for unfilled in ["@name@", "@guid@", "@NAME@", "@given@", "@title@"] {
        assert!(!text.contains(unfilled), "{unfilled}");
    }
    let message = export(xu2020_design(), "fmu", None).refusal();
    assert!(message.starts_with("argument --output:"), "{message}");
    let message = export(
        &shipped("xu2020.json"),
        "fmu",
        Some(&folder.path().join("x")),
    )
    .refusal();
    assert!(
        message.contains("fmu is for design and scenario files"),
        "{message}"
    );
}

#[test]
fn what_wraps_the_controller_compiles_without_a_warning() {
    let files = [
        xu2020_design().to_path_buf(),
        double_integrator_design().to_path_buf(),
        shipped("wu2018.json"),
        shipped("lei2022.json"),
        shipped("yang2025.json"),
    ];
    for file in files {
        let flight = Flight::of(&file, &[]);
        let run = Command::new("gcc")
            .args(["-std=c99", "-c", "-o"])
            .arg(flight.path(".o"))
            .args(STRICT)
            .arg(flight.path("_simulink.c"))
            .output()
            .expect("gcc runs");
        assert!(run.status.success(), "{}: {run:?}", flight.name);
        // The glue of the unit is text inside of a zip file that is not compressed.
        let folder = folder();
        let bytes = std::fs::read(unit(&file, folder.path())).expect("a unit");
        let glue = inside(&bytes, &format!("sources/{}_fmu.c", flight.name));
        let glue = write(flight.folder.path(), "glue.c", glue);
        let run = Command::new("gcc")
            .args(["-std=c99", "-c", "-o"])
            .arg(flight.path(".o"))
            .args(STRICT)
            .arg(glue)
            .output()
            .expect("gcc runs");
        assert!(run.status.success(), "{}: {run:?}", flight.name);
    }
}

/// A file of a zip file without compression.
fn inside(bytes: &[u8], name: &str) -> Vec<u8> {
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).expect("a zip file");
    let mut file = archive.by_name(name).expect("a file");
    let mut out = Vec::new();
    std::io::Read::read_to_end(&mut file, &mut out).expect("bytes");
    out
}

#[test]
fn octave_runs_the_law_to_read_and_the_compiled_one_with_the_bits_of_the_reference() {
    if !installed("octave-cli") || !installed("mkoctfile") {
        return;
    }
    let (_kept, scheduled) = flight::scheduled_by_the_box();
    let files = [
        (xu2020_design().to_path_buf(), 2),
        (double_integrator_design().to_path_buf(), 2),
        (scheduled_design().to_path_buf(), 2),
        (scheduled, 2),
        (shipped("wu2018.json"), 2),
        // Without a law to read.
        (shipped("lei2022.json"), 1),
        (shipped("yang2025.json"), 1),
    ];
    for (file, compared) in files {
        let flight = Flight::of(&file, &[]);
        let (mex, source) = (flight.path("_mex.c"), flight.path(".c"));
        let built = Command::new("mkoctfile")
            .args(["--mex", word(&mex), word(&source)])
            .env("CFLAGS", "-O2 -std=c99 -ffp-contract=off")
            .current_dir(flight.folder.path())
            .output()
            .expect("mkoctfile runs");
        assert!(built.status.success(), "{built:?}");
        let run = Command::new("octave-cli")
            .args(["-qf", "--eval", &format!("{}_test_vectors", flight.name)])
            .current_dir(flight.folder.path())
            .output()
            .expect("Octave runs");
        let said = String::from_utf8_lossy(&run.stdout).into_owned();
        assert!(run.status.success(), "{}: {said} {run:?}", flight.name);
        assert_eq!(
            said.matches("PASSED").count(),
            compared,
            "{}: {said}",
            flight.name
        );
    }
}

#[test]
fn the_component_of_f_prime_is_a_valid_model() {
    if !installed("fpp-check") {
        return;
    }
    // What the component takes from the framework.
    let framework = "module Fw {\n  port Time\n  port Tlm\n  port Log\n  port LogText\n}\n";
    for file in [xu2020_design(), &shipped("yang2025.json")] {
        let flight = Flight::of(file, &[]);
        let stub = write(flight.folder.path(), "framework.fpp", framework);
        let run = Command::new("fpp-check")
            .args([&stub, &flight.path(".fpp")])
            .output()
            .expect("fpp-check runs");
        assert!(run.status.success(), "{run:?}");
    }
}
