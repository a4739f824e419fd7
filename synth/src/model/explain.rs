//! What a parser's error means to whoever wrote the file.

use serde::de::IgnoredAny;
use serde::Serialize;
use serde_json::error::Category;
use serde_json::Value;

use super::error::FileError;
use super::kind::{kind_of, Kind};

type LocatedError = serde_path_to_error::Error<serde_json::Error>;

/// A parser's error as an error of the file.
pub fn explain(text: &str, expected: Kind, error: LocatedError) -> FileError {
    if let Some(found) = kind_of(text).filter(|found| *found != expected) {
        return FileError::WrongKind { found, expected };
    }
    if let Some(reason) = ends_early(text) {
        return FileError::NotJson { reason };
    }
    let field = match error.path().to_string().as_str() {
        "." | "" | "?" => "(top level)".to_string(),
        path => path.to_string(),
    };
    let inner = error.into_inner();
    let message = inner.to_string();
    if inner.classify() == Category::Data {
        let place = format!(" at line {} column {}", inner.line(), inner.column());
        // A number out of its range is found by its field.
        let range = message.strip_suffix(&place);
        let range = range.filter(|range| range.contains(" is not allowed; it must be "));
        let reason = range.map_or_else(|| plain(&message), str::to_string);
        return FileError::Field { field, reason };
    }
    let (line, column) = (inner.line(), inner.column());
    let is_json = serde_json::from_str::<IgnoredAny>(text).is_ok();
    let token = token_at(text, line, column).filter(|token| stands_for_number(token));
    let fault = message.split(" at line ").next().unwrap_or_default();
    // Fixed lists and named choices report what follows them as a fault of syntax.
    match (is_json, fault, token) {
        (true, "trailing characters", _) => FileError::Field {
            field,
            reason: format!("the list has too many entries at line {line} column {column}"),
        },
        (true, "expected value", _) => FileError::Field {
            field,
            reason: format!("a second name follows at line {line} column {column}, expected one"),
        },
        (_, _, Some(token)) => FileError::Field {
            field,
            reason: format!("the value {token} is not allowed; numbers must be finite decimals"),
        },
        _ => FileError::NotJson { reason: message },
    }
}

/// The parser's words about a file that was cut off: the first fault may then be about what is there.
fn ends_early(text: &str) -> Option<String> {
    let fault = serde_json::from_str::<IgnoredAny>(text).err()?;
    (fault.classify() == Category::Eof).then(|| format!("the file ends too early: {fault}"))
}

/// The word or number around a position (line and column from 1), at most 40 characters of it.
fn token_at(text: &str, line: usize, column: usize) -> Option<&str> {
    let line = text.lines().nth(line.checked_sub(1)?)?;
    let ends = |c: char| c.is_whitespace() || ",:[]{}\"".contains(c);
    let at = column.checked_sub(1)?.min(line.len());
    let before = line.get(..at)?;
    let start = before.rfind(ends).map_or(0, |found| found + 1);
    let rest = line.get(start..)?;
    let length = rest.find(ends).unwrap_or(rest.len());
    rest.get(..length)
        .filter(|token| (1..=40).contains(&token.len()))
}

fn stands_for_number(token: &str) -> bool {
    let bare = token.trim_start_matches(['-', '+']);
    let word = ["nan", "inf", "infinity"].contains(&bare.to_ascii_lowercase().as_str());
    word || bare.starts_with(|c: char| c.is_ascii_digit() || c == '.')
}

/// The parser's words without the names of its types.
fn plain(message: &str) -> String {
    let Some((found, expected)) = message.rsplit_once(", expected ") else {
        return message.to_string();
    };
    let (expected, place) = match expected.rfind(" at line ") {
        Some(at) => expected.split_at(at),
        None => (expected, ""),
    };
    format!(
        "{}, expected {}{place}",
        plain_found(found),
        plain_expected(expected)
    )
}

fn plain_found(found: &str) -> String {
    let kind = found
        .strip_prefix("invalid type: ")
        .or(found.strip_prefix("invalid value: "));
    match kind {
        Some("map") => "found an object".to_string(),
        Some("sequence") => "found a list".to_string(),
        Some(kind) => {
            let kind = kind.replacen("floating point", "number", 1);
            format!("found {}", kind.replacen("integer", "number", 1))
        }
        None => match found.strip_prefix("invalid length ") {
            Some(length) => format!("found {length} entries"),
            None => found.replacen("unknown variant", "unknown name", 1),
        },
    }
}

fn plain_expected(expected: &str) -> String {
    if let Some(length) = expected.strip_prefix("an array of length ") {
        return format!("a list of {length} entries");
    }
    if expected.starts_with("struct ") {
        return "an object with named fields".to_string();
    }
    match expected {
        "f64" => "a number".to_string(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, 0 or above".to_string(),
        "a sequence" => "a list".to_string(),
        other => other.to_string(),
    }
}

/// The first field for which the file has a list where the format has an object: the parser takes
/// the fields in order then, which nobody can read.
pub fn list_for_object<T: Serialize>(text: &str, parsed: &T) -> Option<String> {
    let given: Value = serde_json::from_str(text).ok()?;
    let parsed = serde_json::to_value(parsed).ok()?;
    first_list_for_object(&given, &parsed)
}

/// Its path, built only where there is one.
fn first_list_for_object(given: &Value, parsed: &Value) -> Option<String> {
    match (given, parsed) {
        (Value::Array(_), Value::Object(_)) => Some(String::new()),
        (Value::Array(given), Value::Array(parsed)) => {
            let mut pairs = given.iter().zip(parsed).enumerate();
            pairs.find_map(|(i, (given, parsed))| {
                let rest = first_list_for_object(given, parsed)?;
                Some(format!("[{i}]{}", joined(&rest)))
            })
        }
        (Value::Object(given), Value::Object(parsed)) => given.iter().find_map(|(key, given)| {
            let rest = first_list_for_object(given, parsed.get(key)?)?;
            Some(format!("{key}{}", joined(&rest)))
        }),
        _ => None,
    }
}

/// The rest of a path with what joins it to what is before.
fn joined(rest: &str) -> String {
    match rest.chars().next() {
        None | Some('[') => rest.to_string(),
        Some(_) => format!(".{rest}"),
    }
}
