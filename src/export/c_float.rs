//! A C text with float in the place of double, but for the time.

use std::iter::Peekable;
use std::str::Chars;

/// What keeps the precision of doubles.
const TIMES: [&str; 3] = ["time_s", "LONGEST_INTERVAL_S", "TIME_ROUNDING"];

/// What has another name in single precision.
const RENAMED: [(&str, &str); 5] = [
    ("sqrt", "sqrtf"),
    ("fabs", "fabsf"),
    ("exp", "expf"),
    ("DBL_MANT_DIG", "FLT_MANT_DIG"),
    ("double", "float"),
];

/// The same C text with float in the place of double, but for the time.
pub fn in_float(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text.chars().peekable();
    // Whether a number belongs to something that stays a double.
    let mut exact = false;
    while let Some(c) = rest.next() {
        match c {
            '/' if rest.peek() == Some(&'*') => comment(&mut rest, &mut out),
            '"' => quoted(&mut rest, &mut out),
            c if c.is_ascii_alphabetic() || c == '_' => {
                let word = word(c, &mut rest);
                let next = following(&rest);
                let stays = TIMES.contains(&next.as_str());
                let is_time = TIMES.contains(&word.as_str());
                exact |= word == "double" && stays || is_time && is_assigned(&rest);
                let renamed = RENAMED.iter().find(|(from, _)| *from == word);
                match renamed.filter(|_| !stays) {
                    Some((_, to)) => out += to,
                    None => out += &word,
                }
            }
            c if c.is_ascii_digit() => out += &number(c, &mut rest, exact),
            c => {
                exact &= !matches!(c, ';' | ',' | ')');
                out.push(c);
            }
        }
    }
    out
}

/// The rest of a comment as it is.
fn comment(rest: &mut Peekable<Chars>, out: &mut String) {
    out.push('/');
    let mut last = ' ';
    for c in rest.by_ref() {
        out.push(c);
        if last == '*' && c == '/' {
            return;
        }
        last = c;
    }
}

/// The rest of a string as it is.
fn quoted(rest: &mut Peekable<Chars>, out: &mut String) {
    out.push('"');
    let mut escaped = false;
    for c in rest.by_ref() {
        out.push(c);
        if c == '"' && !escaped {
            return;
        }
        escaped = c == '\\' && !escaped;
    }
}

/// Whether a character stands inside of a word or of a number.
fn is_part(c: &char) -> bool {
    c.is_ascii_alphanumeric() || *c == '_'
}

/// A word that begins so.
fn word(first: char, rest: &mut Peekable<Chars>) -> String {
    let mut out = String::from(first);
    while let Some(c) = rest.next_if(is_part) {
        out.push(c);
    }
    out
}

/// The word after spaces and an opening parenthesis.
fn following(rest: &Peekable<Chars>) -> String {
    let after = rest.clone().skip_while(|c| matches!(c, ' ' | '('));
    after.take_while(is_part).collect()
}

/// Whether a value is assigned next.
fn is_assigned(rest: &Peekable<Chars>) -> bool {
    let mut after = rest.clone().skip_while(|c| *c == ' ');
    after.next() == Some('=') && after.next() != Some('=')
}

/// A number that begins so, marked as float where it is one that is not exact.
fn number(first: char, rest: &mut Peekable<Chars>, exact: bool) -> String {
    let mut out = word(first, rest);
    if let Some(point) = rest.next_if_eq(&'.') {
        out += &word(point, rest);
    }
    let is_real = !out.starts_with("0x") && out.contains(['.', 'e']);
    if is_real && out.ends_with('e') {
        let sign = rest.next_if(|c| matches!(c, '-' | '+'));
        out += &sign.map_or(String::new(), |sign| word(sign, rest));
    }
    if is_real && !exact {
        out.push('f');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::in_float;

    #[test]
    fn everything_but_the_time_becomes_single() {
        let pairs = [
            (
                "static const double LIMITS[2] = {1.5e-1, 2.0};",
                "static const float LIMITS[2] = {1.5e-1f, 2.0f};",
            ),
            (
                "static const double LONGEST_INTERVAL_S = 1.0e-1;",
                "static const double LONGEST_INTERVAL_S = 1.0e-1;",
            ),
            (
                "f(double time_s, const double x[3]); y = 0.5;",
                "f(double time_s, const float x[3]); y = 0.5f;",
            ),
            (
                "4.0 * fabs(time_s) + fabs(x)",
                "4.0f * fabs(time_s) + fabsf(x)",
            ),
            (
                "/* a double 1.0 */ \"double 1.0\" 0x80000000U 12 1U",
                "/* a double 1.0 */ \"double 1.0\" 0x80000000U 12 1U",
            ),
            ("1e-2) + 1.0", "1e-2f) + 1.0f"),
            (
                "self->time_s = 0.0; x = 0.0;",
                "self->time_s = 0.0; x = 0.0f;",
            ),
            ("if (DBL_MANT_DIG != 53)", "if (FLT_MANT_DIG != 53)"),
        ];
        for (from, to) in pairs {
            assert_eq!(in_float(from), to);
        }
    }
}
