//! C source text: comments, constants and names.

use super::quantity::Quantity;

/// Longest line of a comment.
const WIDTH: usize = 96;
/// Longest prefix of the names.
const LONGEST_PREFIX: usize = 40;

/// Names that a file of that name would hide from a compiler, and that build tools keep for themselves.
const RESERVED: [&str; 22] = [
    "assert",
    "errno",
    "float",
    "limits",
    "math",
    "mex",
    "stddef",
    "stdint",
    "stdio",
    "stdlib",
    "string",
    "cfe",
    "all",
    "clean",
    "edit_cache",
    "help",
    "install",
    "package",
    "rebuild_cache",
    "test",
    "m",
    "example_main",
];

/// A comment of several lines.
pub fn comment(lines: &[String]) -> String {
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

/// A table of constants under a name of its own, with what it is above.
pub fn table(variable: &str, quantity: &Quantity) -> String {
    let Quantity {
        shape,
        values,
        unit,
        meaning,
        ..
    } = quantity;
    let dimensions: String = shape.iter().map(|size| format!("[{size}]")).collect();
    let about = match dimensions.is_empty() {
        true => format!("{meaning}; unit: {unit}"),
        false => format!("{meaning}; {dimensions}; unit: {unit}"),
    };
    let initial = initialiser(shape, values, 0);
    format!(
        "/* {} */\nstatic const double {variable}{dimensions} = {initial};\n",
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
pub fn constant(value: f64) -> String {
    format!("{value:.16e}")
}

/// The beginning of every name: the design's name as an identifier.
pub fn prefix(name: &str) -> String {
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
        Some(_) if RESERVED.contains(&out) => format!("design_{out}"),
        Some(first) if first.is_ascii_alphabetic() => out.to_string(),
        Some(_) => format!("design_{out}"),
        None => "design".to_string(),
    }
}

/// A title as the name of a type: in C++ or Python.
pub fn type_name(title: &str) -> String {
    let words = title.split(|c: char| !c.is_ascii_alphanumeric());
    let name: String = words
        .filter_map(|word| {
            let mut letters = word.chars();
            let first = letters.next()?.to_ascii_uppercase();
            Some(std::iter::once(first).chain(letters).collect::<String>())
        })
        .collect();
    let is_free = !["True", "False", "None"].contains(&name.as_str());
    match is_free && name.starts_with(|c: char| c.is_ascii_alphabetic()) {
        true => name,
        false => format!("Controller{name}"),
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
            ("Math", "design_math"),
            ("test", "design_test"),
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

    #[test]
    fn a_title_becomes_the_name_of_a_type() {
        for (title, expected) in [
            ("xu2020", "Xu2020"),
            ("small spacecraft - 2", "SmallSpacecraft2"),
            ("2 rules", "Controller2Rules"),
            ("true", "ControllerTrue"),
            ("- -", "Controller"),
        ] {
            assert_eq!(type_name(title), expected);
        }
    }
}
