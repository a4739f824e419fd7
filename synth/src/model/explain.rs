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
    let mut field = match error.path().to_string().as_str() {
        "." | "" | "?" => "(top level)".to_string(),
        path => path.to_string(),
    };
    let mut inner = error.into_inner();
    // A value is refused as soon as it is read, before what follows it: what is no JSON is said first.
    if let Err(fault) = serde_json::from_str::<IgnoredAny>(text) {
        let elsewhere = inner.classify() == Category::Data || field.ends_with('?');
        let key = key_before(text, fault.line(), fault.column()).filter(|_| elsewhere);
        field = match (key, field.rsplit_once('.')) {
            (Some(key), Some((parent, "?"))) => format!("{parent}.{key}"),
            (Some(key), _) if !field.ends_with(&key) => key,
            _ => field,
        };
        inner = fault;
    }
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
    if !is_json && !text.trim_start().starts_with('{') {
        return FileError::NotJson {
            reason: begins_otherwise(text, line, column),
        };
    }
    let fault = message.split(" at line ").next().unwrap_or_default();
    // A second number where a comma is missing is none that is not allowed.
    let second = |token: &str| fault.starts_with("expected `,`") && token.parse::<f64>().is_ok();
    let token = token_at(text, line, column);
    let token = token.filter(|token| stands_for_number(token) && !second(token));
    // Fixed lists and named choices report what follows them as a fault of syntax.
    match (is_json, fault, token) {
        (true, "trailing characters", _) => FileError::Field {
            field,
            reason: format!("the list has too many entries at line {line} column {column}"),
        },
        (true, "expected value", _) => FileError::Field {
            reason: format!(
                "{}, at line {line} column {column}",
                not_one_name(text, &field)
            ),
            field,
        },
        (_, _, Some(token)) => FileError::Field {
            field,
            reason: format!("the value {token} is not allowed; numbers must be finite decimals"),
        },
        _ => FileError::NotJson {
            reason: plain_syntax(&message),
        },
    }
}

/// What stands where an object with one name is expected.
fn not_one_name(text: &str, field: &str) -> String {
    let place = field.replace(['.', '['], "/").replace(']', "");
    let value: Option<Value> = serde_json::from_str(text).ok();
    let found = match value
        .as_ref()
        .and_then(|value| value.pointer(&format!("/{place}")))
    {
        Some(Value::Object(names)) if names.is_empty() => "an object without a name".to_string(),
        Some(Value::Object(names)) if names.len() > 1 => {
            let names: Vec<&str> = names.keys().map(String::as_str).collect();
            format!("the names {}", names.join(", "))
        }
        Some(Value::Array(_)) => "a list".to_string(),
        Some(Value::Number(number)) => format!("the number {number}"),
        Some(Value::Bool(truth)) => truth.to_string(),
        Some(Value::Null) => "null".to_string(),
        _ => "something else".to_string(),
    };
    format!("found {found}, expected one name")
}

/// What a file begins with that is no JSON object.
fn begins_otherwise(text: &str, line: usize, column: usize) -> String {
    let begin: String = text.trim_start().chars().take(20).collect();
    match begin.is_empty() {
        true => "the file is empty".to_string(),
        false => format!(
            "the file begins with {begin:?}, and a JSON file with {{ (line {line} column {column})"
        ),
    }
}

/// The parser's words about what is no JSON, without its jargon.
fn plain_syntax(message: &str) -> String {
    message
        .replace("expected ident", "found a word that is none of JSON's")
        .replace("key must be a string", "a name must be in double quotes")
}

/// The name, in double quotes and with a colon behind it, that a position (line and column from 1) comes after.
fn key_before(text: &str, line: usize, column: usize) -> Option<String> {
    let before: usize = text
        .split_inclusive('\n')
        .take(line.checked_sub(1)?)
        .map(str::len)
        .sum();
    let end = before.checked_add(column)?.min(text.len());
    let head = text.get(..end)?;
    let colon = head.rfind(':')?;
    let name = head.get(..colon)?.trim_end().strip_suffix('"')?;
    let start = name.rfind('"')?;
    name.get(start + 1..).map(str::to_string)
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
        "u8" | "u16" | "u32" | "u64" | "usize" => {
            let largest = match expected {
                "u8" => u64::from(u8::MAX),
                "u16" => u64::from(u16::MAX),
                "u32" => u64::from(u32::MAX),
                _ => u64::MAX,
            };
            format!("a whole number from 0 to {largest}")
        }
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
