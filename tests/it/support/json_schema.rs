//! A validator for the part of JSON Schema (draft 2020-12) that the project's schemas use. A keyword
//! that it does not know fails the test, so nothing is skipped unseen.

use serde_json::{Map, Value};

/// Keywords that only describe.
const ANNOTATIONS: [&str; 8] = [
    "$schema",
    "$defs",
    "title",
    "description",
    "default",
    "format",
    "$id",
    "examples",
];

/// The first reason why `value` is not valid, with its place.
pub fn first_fault(schema: &Value, value: &Value) -> Option<String> {
    fault(schema, schema, value, "")
}

fn fault(root: &Value, schema: &Value, value: &Value, place: &str) -> Option<String> {
    let rules = match schema {
        Value::Bool(true) => return None,
        Value::Bool(false) => return Some(format!("{place}: nothing is allowed here")),
        other => other.as_object().expect("a schema is an object"),
    };
    rules.iter().find_map(|(keyword, rule)| {
        let wrong = |what: &str| Some(format!("{place}: {value} is not {what} {rule}"));
        let within = |schema: &Value| fault(root, schema, value, place);
        match keyword.as_str() {
            "type" => (!has_type(rule, value)).then(|| wrong("of type"))?,
            "const" => (rule != value).then(|| wrong("the constant"))?,
            "enum" => (!list(rule).contains(value)).then(|| wrong("one of"))?,
            "minimum" => value
                .as_f64()
                .is_some_and(|x| Some(x) < rule.as_f64())
                .then(|| wrong("at least"))?,
            "maximum" => value
                .as_f64()
                .is_some_and(|x| Some(x) > rule.as_f64())
                .then(|| wrong("at most"))?,
            "exclusiveMinimum" => value
                .as_f64()
                .is_some_and(|x| Some(x) <= rule.as_f64())
                .then(|| wrong("above"))?,
            "exclusiveMaximum" => value
                .as_f64()
                .is_some_and(|x| Some(x) >= rule.as_f64())
                .then(|| wrong("below"))?,
            "minItems" => length(value)
                .is_some_and(|n| Some(n) < rule.as_u64())
                .then(|| wrong("as long as"))?,
            "maxItems" => length(value)
                .is_some_and(|n| Some(n) > rule.as_u64())
                .then(|| wrong("as short as"))?,
            "required" => {
                let missing = |name: &&Value| value.get(name.as_str().unwrap()).is_none();
                let name = list(rule).iter().find(missing)?;
                value
                    .is_object()
                    .then(|| format!("{place}: {name} is missing"))
            }
            "properties" => properties(root, rule, value, place),
            "additionalProperties" => additional(root, rules, rule, value, place),
            "items" => {
                let mut entries = value.as_array()?.iter().enumerate();
                entries.find_map(|(i, entry)| fault(root, rule, entry, &format!("{place}/{i}")))
            }
            "$ref" => {
                let pointer = rule.as_str()?.strip_prefix('#').expect("a local reference");
                within(root.pointer(pointer).expect("the reference exists"))
            }
            "allOf" => list(rule).iter().find_map(within),
            "anyOf" => {
                let none = list(rule).iter().all(|schema| within(schema).is_some());
                none.then(|| format!("{place}: no alternative fits"))
            }
            "oneOf" => {
                let faults: Vec<_> = list(rule).iter().filter_map(within).collect();
                let fitting = list(rule).len() - faults.len();
                (fitting != 1).then(|| format!("{place}: {fitting} alternatives fit: {faults:?}"))
            }
            other if ANNOTATIONS.contains(&other) => None,
            other => panic!("the keyword {other} at {place} is not known to this validator"),
        }
    })
}

fn properties(root: &Value, rule: &Value, value: &Value, place: &str) -> Option<String> {
    let fields = value.as_object()?;
    fields
        .iter()
        .find_map(|(name, field)| fault(root, rule.get(name)?, field, &format!("{place}/{name}")))
}

fn additional(
    root: &Value,
    rules: &Map<String, Value>,
    rule: &Value,
    value: &Value,
    place: &str,
) -> Option<String> {
    let known = |name: &str| {
        rules
            .get("properties")
            .is_some_and(|known| known.get(name).is_some())
    };
    let mut others = value.as_object()?.iter().filter(|(name, _)| !known(name));
    others.find_map(|(name, field)| fault(root, rule, field, &format!("{place}/{name}")))
}

fn has_type(rule: &Value, value: &Value) -> bool {
    let names = match rule {
        Value::Array(names) => names.as_slice(),
        name => std::slice::from_ref(name),
    };
    names
        .iter()
        .any(|name| match name.as_str().expect("a type's name") {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "number" => value.is_number(),
            "integer" => value.is_i64() || value.is_u64(),
            "boolean" => value.is_boolean(),
            "null" => value.is_null(),
            other => panic!("the type {other} is not known to this validator"),
        })
}

fn list(value: &Value) -> &[Value] {
    value.as_array().expect("a list")
}

fn length(value: &Value) -> Option<u64> {
    value.as_array().map(|entries| entries.len() as u64)
}
