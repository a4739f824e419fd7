//! A design as a C header of static const tables.
//!
//! It compiles as C from the standard of 1990 on and as C++, without warnings. Numbers have 17
//! significant digits, which C compilers with correctly rounded conversion (all that follow Annex F)
//! turn back into the same doubles; hexadecimal constants would not be C90, nor C++ before 2017.

use std::fmt::Write;

use super::c_text::{comment, prefix, table};
use super::design::DesignData;
use super::opening::opening;
use super::quantity::Quantity;

/// The header's text.
pub fn design(data: &DesignData) -> String {
    let prefix = prefix(&data.name);
    let upper = prefix.to_ascii_uppercase();
    let mut out = comment(&opening(data, "tables for flight code"));
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        "#ifndef STEADFAST_{upper}_H\n#define STEADFAST_{upper}_H\n\n#include <float.h>\n\n\
         #if DBL_MANT_DIG != 53\n#error \"the tables need doubles of 64 bits (IEEE 754)\"\n#endif\n\n\
         /* 1 when the check proved every condition, else 0. */\n#define {upper}_PROVED {}\n",
        u8::from(data.proved)
    );
    for (name, size) in sizes(&data.quantities) {
        let _ = writeln!(out, "#define {upper}_{name} {size}");
    }
    for quantity in &data.quantities {
        out.push('\n');
        out += &table(&format!("{prefix}_{}", quantity.name), quantity);
    }
    out += "\n#endif\n";
    out
}

/// Numbers of states, inputs and rules, as the gains have them.
fn sizes(quantities: &[Quantity]) -> Vec<(&'static str, usize)> {
    let gains = quantities
        .iter()
        .find(|quantity| ["gains", "gain"].contains(&quantity.name.as_str()));
    gains.map_or(Vec::new(), |gains| {
        let [rules, inputs, states] = gains.extent();
        vec![("STATES", states), ("INPUTS", inputs), ("GAINS", rules)]
    })
}
