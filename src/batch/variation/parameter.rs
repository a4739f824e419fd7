//! Numbers of a file by name.

use serde_json::{Number, Value};

/// Most names that an error lists.
const LISTED: usize = 4;
/// Likeness below which a name is no near miss.
const LEAST_LIKENESS: f64 = 0.7;

/// A number of a file, or all numbers of a list at once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VariedNumber {
    /// Its full name, such as `controller.wu2018.torque_limit_nm[0]`; `[*]` stands for every entry.
    pub name: String,
    /// Where it is, as JSON pointers.
    pointers: Vec<String>,
    /// Whether it must be a whole number.
    pub whole: bool,
}

/// Why a name is no number of a file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// There is nothing of that name.
    #[error("there is no number '{name}' in the file{}", like(near))]
    Unknown {
        /// The name.
        name: String,
        /// Names like it.
        near: Vec<String>,
    },
    /// There is something else of that name.
    #[error("'{name}' is {found}, not a number{}", like(near))]
    NotNumber {
        /// The name.
        name: String,
        /// What it is.
        found: &'static str,
        /// Numbers in it, or names like it.
        near: Vec<String>,
    },
    /// Several numbers have that short name.
    #[error("'{name}' is the end of several names: {}; give one in full", candidates.join(", "))]
    Ambiguous {
        /// The short name.
        name: String,
        /// The names it may stand for.
        candidates: Vec<String>,
    },
    /// A value that is not whole for a number that must be.
    #[error("'{name}' is a whole number; {value} is not a value it can have")]
    NotWhole {
        /// The name.
        name: String,
        /// The value.
        value: f64,
    },
}

fn like(near: &[String]) -> String {
    match near {
        [] => String::new(),
        near => format!("; similar: {}", near.join(", ")),
    }
}

impl VariedNumber {
    /// The number of that name. A full name has dots between keys and an index in brackets or after a
    /// dot; the end of a name will do when it is the end of one name only, and its unit may be left
    /// out (`phi` for `specs.phi_per_s`).
    ///
    /// # Errors
    /// No number of that name, or several.
    pub fn find(file: &Value, name: &str) -> Result<Self, ParameterError> {
        let wanted = normalised(name);
        let mut all = Vec::new();
        collect(file, "", "", &mut all);
        if let Some(exact) = all.iter().find(|parameter| parameter.name == wanted) {
            return Ok(exact.clone());
        }
        for fits in [ends_with, ends_with_a_unit_after] {
            let fitting: Vec<&VariedNumber> =
                all.iter().filter(|p| fits(&p.name, &wanted)).collect();
            match fitting.as_slice() {
                [] => {}
                [only] => return Ok((*only).clone()),
                several => {
                    let names = several.iter().take(LISTED);
                    return Err(ParameterError::Ambiguous {
                        name: name.to_string(),
                        candidates: names.map(|parameter| parameter.name.clone()).collect(),
                    });
                }
            }
        }
        Err(missing(file, name, &wanted, &all))
    }

    /// The file's value, where it is one.
    pub fn value(&self, file: &Value) -> Option<f64> {
        let value = |pointer: &String| file.pointer(pointer).and_then(Value::as_f64);
        let first = self.pointers.first().and_then(value);
        first.filter(|_| self.pointers.iter().all(|pointer| value(pointer) == first))
    }

    /// Whether both set the same number.
    pub fn overlaps(&self, other: &VariedNumber) -> bool {
        let mut own = self.pointers.iter();
        own.any(|pointer| other.pointers.contains(pointer))
    }

    /// Sets the number.
    ///
    /// # Errors
    /// A value that is not whole where the file needs a whole number.
    pub fn set(&self, file: &mut Value, value: f64) -> Result<(), ParameterError> {
        let number = match self.whole {
            false => Number::from_f64(value),
            true => whole(value).map(Number::from),
        };
        let number = number.ok_or_else(|| ParameterError::NotWhole {
            name: self.name.clone(),
            value,
        })?;
        for pointer in &self.pointers {
            if let Some(place) = file.pointer_mut(pointer) {
                *place = Value::Number(number.clone());
            }
        }
        Ok(())
    }
}

/// Largest whole number that a floating-point number holds exactly.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

fn whole(value: f64) -> Option<u64> {
    let fits = value.fract() == 0.0 && (0.0..=LARGEST_WHOLE).contains(&value);
    fits.then_some(value as u64)
}

/// `a.0.b` as `a[0].b`.
fn normalised(name: &str) -> String {
    let mut out = String::new();
    for part in name.split('.') {
        let index = !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
        match (index, out.is_empty()) {
            (true, false) => out += &format!("[{part}]"),
            (_, true) => out += part,
            (false, false) => out += &format!(".{part}"),
        }
    }
    out
}

fn is_whole(number: &Number) -> bool {
    number.is_u64() || number.is_i64()
}

/// Every number below `value`, and each list of numbers as one.
fn collect(value: &Value, name: &str, pointer: &str, out: &mut Vec<VariedNumber>) {
    match value {
        Value::Number(number) => out.push(VariedNumber {
            name: name.to_string(),
            pointers: vec![pointer.to_string()],
            whole: is_whole(number),
        }),
        Value::Array(entries) => {
            let places = (0..entries.len()).map(|index| format!("{pointer}/{index}"));
            let places: Vec<String> = places.collect();
            let numbers: Option<Vec<&Number>> = entries.iter().map(Value::as_number).collect();
            if let Some(numbers) = numbers.filter(|numbers| !numbers.is_empty()) {
                out.push(VariedNumber {
                    name: format!("{name}[*]"),
                    pointers: places.clone(),
                    whole: numbers.into_iter().all(is_whole),
                });
            }
            for (index, (entry, place)) in entries.iter().zip(&places).enumerate() {
                collect(entry, &format!("{name}[{index}]"), place, out);
            }
        }
        Value::Object(fields) => {
            for (key, field) in fields {
                let name = match name {
                    "" => key.clone(),
                    parent => format!("{parent}.{key}"),
                };
                let step = key.replace('~', "~0").replace('/', "~1");
                collect(field, &name, &format!("{pointer}/{step}"), out);
            }
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

fn ends_with(name: &str, end: &str) -> bool {
    let before = name.strip_suffix(end);
    !end.is_empty() && before.is_some_and(|before| before.ends_with('.'))
}

/// `specs.phi_per_s` ends with `phi` and a unit.
fn ends_with_a_unit_after(name: &str, end: &str) -> bool {
    let last = end.rsplit('.').next().unwrap_or(end);
    let own = name.rsplit('.').next().unwrap_or(name);
    let unit = own.strip_prefix(last).unwrap_or_default();
    if last.is_empty() || !unit.starts_with('_') || unit.contains('[') {
        return false;
    }
    let bare = &name[..name.len() - unit.len()];
    bare == end || ends_with(bare, end)
}

fn missing(file: &Value, name: &str, wanted: &str, all: &[VariedNumber]) -> ParameterError {
    let name = name.to_string();
    let steps = wanted.replace('[', ".").replace(']', "");
    let there = file.pointer(&format!("/{}", steps.replace('.', "/")));
    let Some(there) = there.filter(|_| !wanted.is_empty()) else {
        let near = near_misses(wanted, all);
        return ParameterError::Unknown { name, near };
    };
    let inside = all.iter().map(|parameter| &parameter.name).filter(|name| {
        let rest = name.strip_prefix(wanted);
        rest.is_some_and(|rest| rest.starts_with(['.', '[']))
    });
    ParameterError::NotNumber {
        name,
        found: kind(there),
        near: inside.take(LISTED).cloned().collect(),
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "empty",
        Value::Bool(_) => "a yes or no",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// The names most like the wanted one, as a whole or in their last part.
fn near_misses(wanted: &str, all: &[VariedNumber]) -> Vec<String> {
    let last = |name: &str| name.rsplit('.').next().unwrap_or(name).to_string();
    let names = all.iter().map(|parameter| &parameter.name);
    let names = names.map(|name| {
        let whole = strsim::normalized_damerau_levenshtein(name, wanted);
        let end = strsim::jaro_winkler(&last(name), &last(wanted));
        (whole.max(end), name)
    });
    let liked = names.filter(|(likeness, _)| *likeness >= LEAST_LIKENESS);
    let mut liked: Vec<(f64, &String)> = liked.collect();
    liked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(b.1)));
    let nearest = liked.into_iter().take(LISTED);
    nearest.map(|(_, name)| name.clone()).collect()
}
