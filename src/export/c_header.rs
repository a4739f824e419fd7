//! A design as a C header of static const tables.
//!
//! It compiles as C from the standard of 1990 on and as C++, without warnings. Numbers have 17
//! significant digits, which C compilers with correctly rounded conversion (all that follow Annex F)
//! turn back into the same doubles; hexadecimal constants would not be C90, nor C++ before 2017.

use std::fmt::Write;

use super::design::DesignData;
use super::quantity::Quantity;

/// Longest line of a comment.
const WIDTH: usize = 96;
/// Longest prefix of the names.
const LONGEST_PREFIX: usize = 40;

/// The header's text.
pub fn design(data: &DesignData) -> String {
    let prefix = prefix(&data.name);
    let upper = prefix.to_ascii_uppercase();
    let mut out = comment(&opening(data));
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
        out += &table(&prefix, quantity);
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

fn opening(data: &DesignData) -> Vec<String> {
    let mut out = vec![format!(
        "Controller '{}', tables for flight code.",
        data.name
    )];
    match data.proved {
        true => out.push(
            "PROVED: every condition was proved from these very numbers when this header was written."
                .to_string(),
        ),
        false => {
            out.push(format!(
                "NOT PROVED: nothing is guaranteed for this controller. Conditions that are not \
                 proved ({}): {}.",
                data.failed.len(),
                data.failed.join("; ")
            ));
        }
    }
    out.push(String::new());
    out.extend(data.law.iter().cloned());
    out.push(
        "Matrices are stored row by row; of several, the first index is the rule's.".to_string(),
    );
    out.push(String::new());
    if data.proved {
        out.push("The proof assumes:".to_string());
        out.extend(data.assumptions.iter().map(|text| format!("- {text}")));
        out.push(String::new());
    }
    let provenance = data.provenance.iter();
    out.extend(provenance.map(|(key, text)| format!("{key}: {text}")));
    out
}

/// A comment of several lines.
fn comment(lines: &[String]) -> String {
    let mut out = String::from("/*\n");
    for line in lines {
        let mut column = 0;
        out += " *";
        for word in harmless(line).split(' ').filter(|word| !word.is_empty()) {
            if column > 0 && column + word.len() > WIDTH {
                out += "\n *  ";
                column = 1;
            }
            out.push(' ');
            out += word;
            column += word.len() + 1;
        }
        out.push('\n');
    }
    out + " */\n"
}

/// Text that can neither end a comment nor draw a warning in one: plain ASCII, without the beginning
/// or end of a comment, a trigraph, or a backslash.
fn harmless(text: &str) -> String {
    let plain = |c: char| match c {
        '\\' => '/',
        ' '..='~' => c,
        _ => '?',
    };
    let text: String = text.chars().map(plain).collect();
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        let clash = matches!(
            (out.chars().last(), c),
            (Some('*'), '/') | (Some('/'), '*') | (Some('?'), '?')
        );
        if clash {
            out.push(' ');
        }
        out.push(c);
    }
    out
}

fn table(prefix: &str, quantity: &Quantity) -> String {
    let Quantity {
        name,
        shape,
        values,
        unit,
        meaning,
    } = quantity;
    let dimensions: String = shape.iter().map(|size| format!("[{size}]")).collect();
    let about = match dimensions.is_empty() {
        true => format!("{meaning}; unit: {unit}"),
        false => format!("{meaning}; {dimensions}; unit: {unit}"),
    };
    let initial = initialiser(shape, values, 0);
    format!(
        "/* {} */\nstatic const double {prefix}_{name}{dimensions} = {initial};\n",
        harmless(&about)
    )
}

/// Braces inside braces, a row in a line.
fn initialiser(shape: &[usize], values: &[f64], depth: usize) -> String {
    let indent = "    ".repeat(depth);
    match shape {
        [] => values
            .first()
            .map_or(String::new(), |value| constant(*value)),
        [_] => {
            let row: Vec<String> = values.iter().map(|value| constant(*value)).collect();
            format!("{{{}}}", row.join(", "))
        }
        [count, rest @ ..] => {
            let parts = values.chunks(values.len().checked_div(*count).unwrap_or(0).max(1));
            let inner: Vec<String> = parts
                .map(|part| format!("{indent}    {}", initialiser(rest, part, depth + 1)))
                .collect();
            format!("{{\n{}\n{indent}}}", inner.join(",\n"))
        }
    }
}

/// A constant of type double with 17 significant digits.
fn constant(value: f64) -> String {
    format!("{value:.16e}")
}

/// The beginning of every name: the design's name as an identifier.
fn prefix(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        match c.is_ascii_alphanumeric() {
            true => out.push(c.to_ascii_lowercase()),
            false if out.is_empty() || out.ends_with('_') => {}
            false => out.push('_'),
        }
    }
    out.truncate(LONGEST_PREFIX);
    let out = out.trim_end_matches('_');
    match out.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => out.to_string(),
        Some(_) => format!("design_{out}"),
        None => "design".to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_becomes_an_identifier() {
        let cases = [
            ("xu2020", "xu2020"),
            ("small spacecraft - 2", "small_spacecraft_2"),
            ("2 rules", "design_2_rules"),
            ("Größe__x", "gr_e_x"),
            ("- -", "design"),
        ];
        for (name, expected) in cases {
            assert_eq!(prefix(name), expected, "{name}");
        }
        assert_eq!(prefix(&"a-".repeat(80)).len(), LONGEST_PREFIX - 1);
    }

    #[test]
    fn text_cannot_end_a_comment() {
        let evil = "ends */ here /* or //* here, ??/ and \\ too: ä????/";
        let safe = harmless(evil);
        for bad in ["*/", "/*", "??", "\\", "ä"] {
            assert!(!safe.contains(bad), "{safe}");
        }
        let whole = comment(&[evil.to_string()]);
        assert!(whole.ends_with("*/\n"));
        assert_eq!(whole.matches("*/").count(), 1);
    }

    #[test]
    fn constants_read_back_as_the_same_bits() {
        for value in [0.1, -0.0, 1.0 / 3.0, 5e-324, f64::MAX, -123456.789e-20] {
            let read: f64 = constant(value).parse().unwrap();
            assert_eq!(read.to_bits(), value.to_bits());
        }
    }
}
