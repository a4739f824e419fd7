//! Checked-in designs for the tests of the library.
#![allow(dead_code)]

use steadfast::run::design::Design;

pub const SPACECRAFT_MODEL: &str = include_str!("../../../models/xu2020.json");
pub const CART_MODEL: &str = include_str!("../../../models/double-integrator.json");

/// The text of the design of models/xu2020.json.
pub fn spacecraft_design() -> &'static str {
    include_str!("../../data/xu2020-design.json")
}

/// The text of the design of models/double-integrator.json.
pub fn cart_design() -> &'static str {
    include_str!("../../data/double-integrator-design.json")
}

pub fn read(text: &str) -> Design {
    Design::from_json(text).unwrap()
}
