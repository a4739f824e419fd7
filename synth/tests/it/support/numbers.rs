//! The numbers of a file, for tests that change each of them.

use serde_json::Value;

/// Paths (JSON pointers) of all numbers below a value.
pub fn numbers(value: &Value, path: &str, out: &mut Vec<String>) {
    match value {
        Value::Number(_) => out.push(path.to_string()),
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                numbers(item, &format!("{path}/{index}"), out);
            }
        }
        Value::Object(entries) => {
            for (key, item) in entries {
                numbers(item, &format!("{path}/{key}"), out);
            }
        }
        _ => {}
    }
}
