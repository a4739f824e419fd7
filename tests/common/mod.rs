//! Designs for the tests, synthesized once in each test program.
#![allow(dead_code)]

use std::sync::OnceLock;

use steadfast::harness::design::Design;
use synth::model::Model;
use synth::solve::Clarabel;
use synth::synthesis::{synthesize, Form, Outcome};

pub const SPACECRAFT_MODEL: &str = include_str!("../../models/xu2020.json");
pub const CART_MODEL: &str = include_str!("../../models/double-integrator.json");

/// The text of the design of models/xu2020.json.
pub fn spacecraft_design() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| design_text(SPACECRAFT_MODEL))
}

/// The text of the design of models/double-integrator.json.
pub fn cart_design() -> &'static str {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| design_text(CART_MODEL))
}

pub fn read(text: &str) -> Design {
    Design::from_json(text).unwrap()
}

fn design_text(text: &str) -> String {
    let model = Model::from_json(text).unwrap();
    let backend = Clarabel::default();
    match synthesize(&model, text, Form::Chordal, &backend, None).unwrap() {
        Outcome::Solved(design) => design.file.to_json(),
        other => panic!("no design: {other:?}"),
    }
}
