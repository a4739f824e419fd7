//! The static library for C answers as the reference does.

use super::flight::Flight;
use super::*;
use std::process::Command;

/// Builds the library; where it is.
fn library() -> &'static Path {
    static LIBRARY: OnceLock<PathBuf> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let crate_of_it = repository().join("runtime/c-abi");
        let target = std::env::var_os("CARGO_TARGET_DIR").map(PathBuf::from);
        let target = target.unwrap_or_else(|| repository().join("target"));
        let target = target.join("c-abi");
        let run = Command::new(env!("CARGO"))
            .args(["build", "--release", "--locked", "--target-dir"])
            .arg(&target)
            .current_dir(crate_of_it)
            .output()
            .expect("cargo runs");
        assert!(run.status.success(), "{run:?}");
        target.join("release/libsteadfast.a")
    })
}

/// A value as an initialiser of C.
fn initialiser(value: &Value) -> String {
    match value {
        Value::Array(entries) => {
            let inner: Vec<String> = entries.iter().map(initialiser).collect();
            format!("{{{}}}", inner.join(", "))
        }
        number => format!("{:.16e}", number.as_f64().expect("a number")),
    }
}

/// A program that runs a controller over the vectors of its flight code; it prints how many samples agreed.
fn program(kind: &str, name: &str, parameters: &str) -> String {
    format!(
        r#"
#include "steadfast.h"
#include "{name}_vectors.h"
#include <stdio.h>
#include <string.h>

int main(void)
{{
    static steadfast_{kind} controller;
    const steadfast_{kind}_parameters parameters = {{{parameters}}};
    steadfast_{kind}_parameters wrong = parameters;
    int sample;
    int index;
    wrong.torque_limit_nm[1] = -1.0;
    if (steadfast_{kind}_init(&controller, &wrong) != STEADFAST_BAD_PARAMETERS) return 2;
    if (steadfast_{kind}_init(NULL, &parameters) != STEADFAST_NULL_POINTER) return 3;
    if (steadfast_{kind}_init(&controller, &parameters) != 0) return 4;
    if (steadfast_{kind}_reset(&controller) != 0) return 5;
    for (sample = 0; sample < {upper}_SAMPLES; ++sample) {{
        double row[{upper}_GIVEN];
        steadfast_command command;
        memcpy(row, {name}_given[sample], sizeof row);
        if (steadfast_{kind}_step(&controller, row[0], &row[1], &row[5], &command) != {name}_flags[sample][1]) return 6;
        if (command.status != {name}_flags[sample][1] || command.sent != {name}_flags[sample][0]) return 7;
        for (index = 0; index < 3; ++index) {{
            uint64_t bits;
            memcpy(&bits, &command.torque_nm[index], sizeof bits);
            if (bits != {name}_commands[sample][index]) return 8;
        }}
    }}
    printf("%d\n", sample);
    return 0;
}}
"#,
        upper = name.to_ascii_uppercase()
    )
}

/// Compiles such a program as strict C with the library, and runs it.
#[track_caller]
fn assert_agrees(kind: &str, file: &Path, parameters: &str) {
    let flight = Flight::of(file, &[]);
    let source = program(kind, &flight.name, parameters);
    let source = write(flight.folder.path(), "check.c", source);
    let out = flight.path(".abi");
    // Tables of the vectors that this program does not use.
    let run = Command::new("gcc")
        .args([
            "-std=c99",
            "-Wall",
            "-Wextra",
            "-pedantic",
            "-Werror",
            "-Wno-unused-variable",
        ])
        .arg(format!(
            "-I{}",
            repository().join("runtime/c-abi/include").display()
        ))
        .arg("-o")
        .args([&out, &source])
        .arg(library())
        .arg("-lm")
        .output()
        .expect("gcc runs");
    assert!(run.status.success(), "{run:?}");
    let run = Command::new(&out).output().expect("the program runs");
    assert_eq!(
        run.status.code(),
        Some(0),
        "{kind}: a check of this number failed"
    );
    assert_eq!(String::from_utf8_lossy(&run.stdout), "400\n");
}

#[test]
fn a_design_in_the_static_library_answers_as_the_reference_does() {
    let design = json(xu2020_design());
    let at = |pointer: &str| initialiser(design.pointer(pointer).expect(pointer));
    let parts = [
        at("/controller/gains/0"),
        at("/controller/trigger_weight"),
        "0.0".to_string(),
        at("/model/specs/nu"),
        "0.0".to_string(),
        "{0.0, 0.0, 0.0}".to_string(),
        at("/model/plant/exact/torque_limit_nm"),
        at("/model/plant/exact/rate_rad_s"),
        at("/model/plant/exact/q0_min"),
        at("/model/specs/hbar_s"),
    ];
    assert_agrees("xu2020", xu2020_design(), &parts.join(", "));
}

#[test]
fn the_law_of_wu_in_the_static_library_answers_as_the_reference_does() {
    let mut scenario = json(&shipped("wu2018.json"));
    let gains = json!({ "direct": { "error_gain_nm_s_rad": 2.5, "attitude_weight_rad_s": 0.08 } });
    set(&mut scenario, "/controller/wu2018/gains", gains);
    let law = &scenario["controller"]["wu2018"];
    let trigger = &law["trigger"]["relative"];
    let parts = [
        "2.5, 0.08".to_string(),
        initialiser(&trigger["relative"]),
        initialiser(&trigger["absolute_rad_s"]),
        initialiser(&law["torque_limit_nm"]),
        match law["shortest_rotation_hysteresis"].is_null() {
            true => "-1.0".to_string(),
            false => initialiser(&law["shortest_rotation_hysteresis"]),
        },
    ];
    let folder = folder();
    let file = write(folder.path(), "wu.json", scenario.to_string());
    assert_agrees("wu2018", &file, &parts.join(", "));
}
