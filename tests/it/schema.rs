//! `steadfast schema`: the checked-in schemas are those of the program, and the files fit them.

use std::path::Path;

use crate::support::json_schema::first_fault;
use crate::support::*;
use serde_json::{json, Value};

/// The kinds that the command knows, from its own message about an unknown one.
fn kinds() -> Vec<String> {
    let message = steadfast(["schema", "unheard-of"]).ends_with(1).stderr;
    let names = message
        .split("[possible values: ")
        .nth(1)
        .expect("the kinds");
    let names = names.split(']').next().expect("the end of the kinds");
    names.split(", ").map(str::to_string).collect()
}

fn schema(kind: &str) -> Value {
    let run = steadfast(["schema", kind]).ends_with(0);
    serde_json::from_str(&run.stdout).expect("a JSON schema")
}

#[track_caller]
fn assert_fits(kind: &str, file: &Path) {
    if let Some(fault) = first_fault(&schema(kind), &json(file)) {
        panic!("{} against the {kind} schema: {fault}", file.display());
    }
}

#[test]
fn the_checked_in_schemas_are_those_of_the_program() {
    let folder = repository().join("docs/schema");
    let mut expected = Vec::new();
    for kind in kinds() {
        let name = format!("{kind}.schema.json");
        let printed = steadfast(["schema", &kind]).ends_with(0).stdout;
        let same = text(&folder.join(&name)) == printed;
        assert!(
            same,
            "docs/schema/{name} is out of date: run `steadfast schema {kind}`"
        );
        expected.push(name);
    }
    expected.sort();
    assert_eq!(names_in(&folder), expected);
}

#[test]
fn every_shipped_file_fits_its_schema() {
    for file in all_shipped() {
        assert_fits(shipped_kind(&json(&file)), &file);
    }
}

#[test]
fn what_synthesize_writes_fits_the_design_schema() {
    assert_fits("design", xu2020_design());
    assert_fits("design", double_integrator_design());
}

#[test]
fn the_schema_refuses_what_the_program_refuses() {
    let model = schema("model");
    let refused: [(&str, Value); 6] = [
        ("/unheard_of", json!(1)),
        ("/specs/unheard_of", json!(1)),
        ("/specs/phi_per_s", json!("fast")),
        ("/plant/exact/inertia_kg_m2", json!([[1, 0, 0], [0, 1, 0]])),
        ("/plant", json!({ "cube": {} })),
        ("/gains", json!("sometimes")),
    ];
    for (pointer, value) in refused {
        let mut file = json(&shipped("xu2020.json"));
        assert_eq!(first_fault(&model, &file), None);
        set(&mut file, pointer, value);
        assert!(first_fault(&model, &file).is_some(), "{pointer}");
    }
}
