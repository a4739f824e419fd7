//! Flight code written again into its folder, and what its files say of themselves.

use super::flight::Flight;
use super::*;
use crate::support::tools::installed;
use std::process::Command;

fn again(file: &Path, folder: &Path, more: &[&str]) -> Run {
    let run = command()
        .args(["export", word(file), "--format", "c99", "-o"])
        .arg(folder)
        .args(more)
        .output();
    Run::new(run.expect("the command runs"))
}

#[test]
fn an_edited_file_of_flight_code_is_kept_unless_force_is_given() {
    let flight = Flight::of(xu2020_design(), &[]);
    let folder = flight.folder.path();
    let example = folder.join("example_main.c");
    let mine = text(&example).replace("int main", "/* mine */ int main");
    std::fs::write(&example, &mine).expect("a file");
    let message = again(xu2020_design(), folder, &[]).refusal();
    assert!(
        message.contains("example_main.c") && message.contains("edited"),
        "{message}"
    );
    assert_eq!(text(&example), mine);
    again(xu2020_design(), folder, &["--force"]).ends_with(0);
    assert!(!text(&example).contains("mine"));
    // A file that is gone is written again without a word.
    std::fs::remove_file(&example).expect("removed");
    again(xu2020_design(), folder, &[]).ends_with(0);
    assert!(example.is_file());
}

#[test]
fn flight_code_of_another_controller_does_not_mix_with_what_is_there() {
    let flight = Flight::of(xu2020_design(), &[]);
    let folder = flight.folder.path();
    let before = names_in(folder);
    let message = again(double_integrator_design(), folder, &[]).refusal();
    assert!(message.contains("another controller, xu2020"), "{message}");
    assert_eq!(names_in(folder), before);

    let notes = folder.join("notes.txt");
    std::fs::write(&notes, "mine").expect("a file");
    let edited = folder.join(format!("{}_cfs_app.c", flight.name));
    std::fs::write(&edited, text(&edited) + "/* mine */\n").expect("a file");
    again(double_integrator_design(), folder, &["--force"]).ends_with(0);
    let mut expected = names_in(Flight::of(double_integrator_design(), &[]).folder.path());
    // What nobody else can write again stays.
    expected.extend([
        "notes.txt".to_string(),
        format!("{}_cfs_app.c", flight.name),
    ]);
    expected.sort();
    assert_eq!(names_in(folder), expected);
}

#[test]
fn an_edited_file_that_an_export_leaves_out_is_not_overwritten_by_the_next_one() {
    let flight = Flight::of(xu2020_design(), &[]);
    let folder = flight.folder.path();
    let law = flight.path("_reference.m");
    let mine = text(&law) + "% mine\n";
    std::fs::write(&law, &mine).expect("a file");
    let run = again(xu2020_design(), folder, &["--float"]).ends_with(0);
    assert!(run.stderr.contains("xu2020_reference.m"), "{run:?}");
    assert_eq!(text(&law), mine);
    assert!(!flight.path("_mex.c").exists());
    let message = again(xu2020_design(), folder, &[]).refusal();
    assert!(message.contains("xu2020_reference.m"), "{message}");
    assert_eq!(text(&law), mine);
}

#[test]
fn a_list_of_digests_that_was_tampered_with_makes_nothing_of_the_users_disappear() {
    let flight = Flight::of(xu2020_design(), &[]);
    let folder = flight.folder.path();
    let list = folder.join("SHA256SUMS");
    let notes = folder.join("notes.txt");
    std::fs::write(&notes, "mine\n").expect("a file");
    // The digest of that text.
    let digest = "fcbc800db3f1867000b852f1ce0044b8f1584f76ade1ed6e65189824f95c3cda";
    let line = format!("{digest}  notes.txt\n");
    std::fs::write(&list, text(&list) + &line).expect("a file");
    again(xu2020_design(), folder, &["--force"]).ends_with(0);
    assert_eq!(text(&notes), "mine\n");

    let example = folder.join("example_main.c");
    let mine = text(&example) + "/* mine */\n";
    std::fs::write(&example, &mine).expect("a file");
    std::fs::remove_file(&list).expect("removed");
    let message = again(xu2020_design(), folder, &[]).refusal();
    assert!(message.contains("example_main.c"), "{message}");
    assert_eq!(text(&example), mine);
}

#[cfg(unix)]
#[test]
fn a_link_in_the_place_of_flight_code_is_refused_before_anything_is_written() {
    let flight = Flight::of(xu2020_design(), &[]);
    let folder = flight.folder.path();
    let test = flight.path("_test.c");
    let elsewhere = folder.join("elsewhere.c");
    for target in ["elsewhere.c", "../nowhere/x", "/dev/null"] {
        std::fs::remove_file(&test).expect("removed");
        std::fs::write(&elsewhere, "mine").expect("a file");
        std::os::unix::fs::symlink(target, &test).expect("a link");
        for more in [&["--float"][..], &["--float", "--force"]] {
            let message = again(xu2020_design(), folder, more).refusal();
            assert!(
                message.contains("_test.c") && message.contains("link"),
                "{message}"
            );
            assert!(text(&flight.path(".h")).contains("double torque_nm"));
        }
        assert_eq!(text(&elsewhere), "mine");
    }
}

#[test]
fn two_designs_whose_names_make_one_identifier_are_two_controllers() {
    let named = |name: &str| {
        let folder = folder();
        let mut file = json(xu2020_design());
        set(&mut file, "/name", json!(name));
        set(&mut file, "/model/name", json!(name));
        let path = write(folder.path(), "design.json", file.to_string());
        (folder, path)
    };
    let ((_one, first), (_two, second)) = (named("a-b"), named("a_b"));
    let flight = Flight::of(&first, &[]);
    let message = again(&second, flight.folder.path(), &[]).refusal();
    assert!(message.contains("another controller, a-b"), "{message}");
}

#[test]
fn the_digests_of_the_flight_code_are_those_of_its_files() {
    let flight = Flight::of(&shipped("yang2025.json"), &[]);
    let folder = flight.folder.path();
    let list = text(&folder.join("SHA256SUMS"));
    assert_eq!(list.lines().count(), names_in(folder).len(), "{list}");
    if !installed("sha256sum") {
        return;
    }
    let check = || {
        let run = Command::new("sha256sum")
            .args(["--strict", "-c", "SHA256SUMS"])
            .current_dir(folder)
            .output();
        run.expect("sha256sum runs")
    };
    let run = check();
    assert!(run.status.success(), "{run:?}");
    std::fs::write(flight.path(".c"), "").expect("a file");
    assert!(!check().status.success());
}

#[test]
fn every_file_of_flight_code_says_whether_it_is_proved() {
    for (file, proved) in [
        (xu2020_design().to_path_buf(), true),
        (shipped("wu2018.json"), false),
        (shipped("lei2022.json"), false),
        (shipped("yang2025.json"), false),
    ] {
        let flight = Flight::of(&file, &[]);
        for name in names_in(flight.folder.path()) {
            let text = text(&flight.folder.path().join(&name));
            assert!(text.contains("PROVED"), "{name}");
            assert_eq!(!text.contains("NOT PROVED"), proved, "{name}");
        }
    }
}

#[test]
fn the_header_says_when_each_law_sends_and_the_readme_how_it_is_sampled() {
    let of = |file: &Path| {
        let flight = Flight::of(file, &[]);
        let readme = flight.folder.path().join("README.txt");
        (text(&flight.path(".h")), text(&readme))
    };
    let (header, readme) = of(xu2020_design());
    assert!(header.contains("The first usable one is always sent"));
    assert!(readme.contains("the test then fails") && readme.contains("At least one sample every"));
    let (header, readme) = of(&shipped("lei2022.json"));
    assert!(
        header.contains("switches the actuators on or off") && !header.contains("first usable")
    );
    assert!(readme.contains("has no sampling interval") && readme.contains("more than it allows"));
    assert!(!readme.contains("set_fault"), "{readme}");
    let (header, _) = of(&shipped("yang2025.json"));
    assert!(header.contains("every sample that is used is sent"));
}

#[test]
fn a_null_pointer_fills_in_the_command_all_the_same() {
    let flight = Flight::of(xu2020_design(), &[]);
    let name = &flight.name;
    let upper = name.to_ascii_uppercase();
    let program = format!(
        r#"#include "{name}.h"
#include <stdio.h>
#include <string.h>
int main(void)
{{
    {name}_controller controller;
    {name}_command command;
    const double attitude[4] = {{0.8, 0.0, 0.0, 0.6}};
    const double rate[3] = {{0.0, 0.0, 0.0}};
    double torque;
    {name}_init(&controller);
    (void){name}_step(&controller, 0.0, attitude, rate, &command);
    torque = command.torque_nm[2];
    (void)memset(&command, 0xFF, sizeof command);
    if ({name}_step(&controller, 0.1, NULL, rate, &command) != {upper}_NULL_POINTER || command.sent != 0U ||
        command.status != {upper}_NULL_POINTER || command.torque_nm[2] != torque || torque == 0.0) {{
        return 1;
    }}
    (void)memset(&command, 0xFF, sizeof command);
    if ({name}_step(NULL, 0.1, attitude, rate, &command) != {upper}_NULL_POINTER || command.sent != 0U ||
        command.status != {upper}_NULL_POINTER || command.torque_nm[2] != 0.0) {{
        return 2;
    }}
    return ({name}_step(&controller, 0.1, attitude, rate, NULL) == {upper}_NULL_POINTER) ? 0 : 3;
}}
"#
    );
    let source = flight.path("_null.c");
    std::fs::write(&source, program).expect("a file");
    let binary = flight.path(".null");
    let run = Command::new("gcc")
        .args(["-std=c99"])
        .args(super::flight::STRICT)
        .arg("-o")
        .arg(&binary)
        .args([source, flight.path(".c")])
        .arg("-lm")
        .output();
    let Ok(run) = run else {
        eprintln!("SKIPPED: gcc is not installed; null pointers were not tried");
        return;
    };
    assert!(run.status.success(), "{run:?}");
    let run = Command::new(binary).status().expect("the program runs");
    assert_eq!(run.code(), Some(0));
}

#[test]
fn single_precision_is_measured_against_the_reference_and_is_not_called_proved() {
    for file in [
        xu2020_design().to_path_buf(),
        double_integrator_design().to_path_buf(),
        scheduled_design().to_path_buf(),
        shipped("wu2018.json"),
    ] {
        let flight = Flight::of(&file, &["--float", "--samples", "2000"]);
        let header = text(&flight.path(".h"));
        assert!(header.contains("SINGLE PRECISION: NOT PROVED"), "{header}");
        assert!(
            header.contains("_PROVED 0") && header.contains("const float"),
            "{header}"
        );
        assert!(header.contains("double time_s") && !header.contains("double torque_nm"));
        let names = names_in(flight.folder.path());
        assert!(names
            .iter()
            .all(|name| !name.ends_with(".m") && !name.contains("_mex")));
        flight.passes_strictly();
        // No product of the controller is one of doubles.
        if installed("gcc") {
            let run = Command::new("gcc")
                .args([
                    "-std=c99",
                    "-Wdouble-promotion",
                    "-Werror",
                    "-c",
                    "-o",
                    "/dev/null",
                ])
                .arg(flight.path(".c"))
                .output();
            let run = run.expect("gcc runs");
            assert!(run.status.success(), "{run:?}");
        }
        // A wrong digit far beyond single precision is found.
        let source = flight.path(".c");
        let right = text(&source);
        let wrong = right.replacen(
            "LIMITS[input]), -LIMITS",
            "LIMITS[input]), -0.9F * LIMITS",
            1,
        );
        assert_ne!(right, wrong);
        std::fs::write(&source, wrong).expect("a file");
        if installed("gcc") {
            let (passes, said) = flight.test("gcc", &["-std=c99", "-O1"]);
            assert!(!passes, "{said}");
        }
    }
}

#[test]
fn what_needs_doubles_is_refused_in_single_precision() {
    let folder = folder();
    let out = folder.path().join("out");
    let (_kept, adaptive) = super::flight::scheduled_by_the_box();
    for file in [adaptive, shipped("lei2022.json"), shipped("yang2025.json")] {
        let message = again(&file, &out, &["--float"]).refusal();
        assert!(
            message.contains("--float is for designs with a fixed threshold"),
            "{message}"
        );
        assert!(!out.exists());
    }
    let run = command()
        .args([
            "export",
            word(xu2020_design()),
            "--format",
            "csv",
            "--float",
        ])
        .output();
    let message = Run::new(run.expect("the command runs")).refusal();
    assert!(
        message.contains("--float") && message.contains("c99"),
        "{message}"
    );
}
