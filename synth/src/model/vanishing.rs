//! Numbers of a file that are not 0 and are read as 0.

use super::FileError;

/// A number that is read as 0, with the name that it stands behind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Vanishing {
    /// As it is written.
    pub written: String,
    /// The last name before it.
    pub name: String,
}

impl From<Vanishing> for FileError {
    fn from(number: Vanishing) -> Self {
        FileError::Field {
            field: number.name,
            reason: format!(
                "the value {} is not allowed; it must be 0 or a number of magnitude 1e-30 to 1e30",
                number.written
            ),
        }
    }
}

/// The first number of a valid JSON text that is smaller than any number of 64 bits and not 0.
pub fn first_vanishing(text: &str) -> Option<Vanishing> {
    let (mut name, mut rest) = ("", text);
    while let Some(start) = rest.find(|c: char| c == '"' || c == '-' || c.is_ascii_digit()) {
        let (length, token) = match rest[start..].strip_prefix('"') {
            Some(inside) => {
                let length = string_length(inside);
                let content = &inside[..length];
                let after = inside[length..].strip_prefix('"').unwrap_or("");
                if after.trim_start().starts_with(':') {
                    name = content;
                }
                (length + 2, None)
            }
            None => {
                let part = |c: char| c.is_ascii_digit() || "+-.eE".contains(c);
                let token = &rest[start..];
                let length = token.find(|c| !part(c)).unwrap_or(token.len());
                (length, Some(&token[..length]))
            }
        };
        if let Some(token) = token.filter(|token| vanishes(token)) {
            return Some(Vanishing {
                written: token.chars().take(40).collect(),
                name: name.to_string(),
            });
        }
        rest = rest.get(start + length..)?;
    }
    None
}

/// Length of a string's inside, up to the quotation mark that ends it.
fn string_length(inside: &str) -> usize {
    let mut escaped = false;
    let end = inside.bytes().position(|byte| {
        let ends = byte == b'"' && !escaped;
        escaped = byte == b'\\' && !escaped;
        ends
    });
    end.unwrap_or(inside.len())
}

fn vanishes(token: &str) -> bool {
    let digits = token.split(['e', 'E']).next().unwrap_or("");
    let has_digit = digits.bytes().any(|byte| (b'1'..=b'9').contains(&byte));
    has_digit && token.parse::<f64>() == Ok(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_below_all_of_64_bits_is_named_with_its_key() {
        let text = r#"{"name": "1e-400 \"0\"", "a": [0, -0.0, 0e5, 1e-300], "b": [2, -3.5e-999]}"#;
        let found = first_vanishing(text).expect("one vanishes");
        assert_eq!(
            (found.written.as_str(), found.name.as_str()),
            ("-3.5e-999", "b")
        );
        assert_eq!(first_vanishing(&text.replace("-3.5e-999", "0")), None);
    }
}
