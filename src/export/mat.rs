//! MAT-files of level 5, uncompressed: what MATLAB, Octave and scipy read.
//!
//! The layout is that of the MathWorks document "MAT-File Format". It is written here because the library
//! for it, matrw 0.1, drops every error of the disk, puts the time of day into the file, and writes text
//! beyond ASCII so that scipy cannot read the file.

use super::design::DesignData;
use super::quantity::Quantity;
use crate::base::provenance::GENERATOR;

/// A variable's value.
#[derive(Debug, Clone, PartialEq)]
pub enum MatValue {
    /// Real numbers: sizes (two or more) and the numbers, first index fastest.
    Real(Vec<usize>, Vec<f64>),
    /// A line of text.
    Text(String),
    /// A structure with named fields.
    Struct(Vec<(String, MatValue)>),
}

/// What cannot be written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MatError {
    /// A name that MATLAB does not have.
    #[error(
        "'{0}' is no name of a MATLAB variable (a letter, then letters, digits or _; at most {LONGEST_NAME} in all)"
    )]
    Name(String),
    /// The same name twice.
    #[error("the name '{0}' occurs twice")]
    Twice(String),
    /// A variable is too large for the format.
    #[error("'{0}' has more than 4 GiB, which a MAT-file of this kind cannot hold")]
    TooLarge(String),
}

/// Longest name of a variable or field.
const LONGEST_NAME: usize = 63;

/// Data types of elements.
const MI_INT8: u32 = 1;
const MI_INT32: u32 = 5;
const MI_UINT32: u32 = 6;
const MI_DOUBLE: u32 = 9;
const MI_MATRIX: u32 = 14;
const MI_UTF16: u32 = 17;

/// Classes of arrays.
const MX_STRUCT: u32 = 2;
const MX_CHAR: u32 = 4;
const MX_DOUBLE: u32 = 6;

/// Lengths of the text and of the offset of the header.
const HEADER_TEXT: usize = 116;
const HEADER_OFFSET: usize = 8;

/// The file's bytes; the same variables give the same bytes.
///
/// # Errors
/// A name that MATLAB does not have, twice the same name, a variable beyond 4 GiB.
pub fn to_bytes(variables: &[(String, MatValue)]) -> Result<Vec<u8>, MatError> {
    let mut text = format!("MATLAB 5.0 MAT-file, written by {GENERATOR}").into_bytes();
    text.resize(HEADER_TEXT, b' ');
    let mut out = text;
    out.extend([0; HEADER_OFFSET]);
    out.extend(0x0100_u16.to_le_bytes());
    out.extend(b"IM");
    check_names(variables)?;
    for (name, value) in variables {
        matrix(name, name, value, &mut out)?;
    }
    Ok(out)
}

/// A design as a MAT-file: each quantity a variable (several matrices stand behind each other in the third
/// index), `proved` (1 or 0), and the structures `units` and `provenance`.
///
/// # Errors
/// None for the names that designs have.
pub fn design(data: &DesignData) -> Result<Vec<u8>, MatError> {
    let quantities = data.quantities.iter();
    let units = quantities.clone().map(|own| (&own.name, own.unit));
    let proved = MatValue::Real(vec![1, 1], vec![f64::from(u8::from(data.proved))]);
    let mut variables = vec![
        ("proved".to_string(), proved),
        ("provenance".to_string(), texts(data.about())),
        ("units".to_string(), texts(units)),
    ];
    variables.extend(quantities.map(|own| (own.name.clone(), array(own))));
    to_bytes(&variables)
}

/// A structure of texts.
pub fn texts<K: ToString, T: ToString>(pairs: impl IntoIterator<Item = (K, T)>) -> MatValue {
    let pairs = pairs.into_iter();
    let fields = pairs.map(|(key, text)| (key.to_string(), MatValue::Text(text.to_string())));
    MatValue::Struct(fields.collect())
}

/// Rows, columns and matrices, first index fastest.
fn array(quantity: &Quantity) -> MatValue {
    let [matrices, rows, columns] = quantity.extent();
    let mut values = Vec::with_capacity(quantity.values.len());
    for matrix in 0..matrices {
        for column in 0..columns {
            let start = matrix * rows * columns + column;
            let entries = quantity.values.iter().skip(start).step_by(columns.max(1));
            values.extend(entries.take(rows));
        }
    }
    let sizes = match matrices {
        1 => vec![rows, columns],
        _ => vec![rows, columns, matrices],
    };
    MatValue::Real(sizes, values)
}

fn check_names(variables: &[(String, MatValue)]) -> Result<(), MatError> {
    for (index, (name, value)) in variables.iter().enumerate() {
        let letter = name.starts_with(|c: char| c.is_ascii_alphabetic());
        let rest = name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !letter || !rest || name.len() > LONGEST_NAME {
            return Err(MatError::Name(name.chars().take(80).collect()));
        }
        if variables.iter().take(index).any(|(other, _)| other == name) {
            return Err(MatError::Twice(name.clone()));
        }
        if let MatValue::Struct(fields) = value {
            check_names(fields)?;
        }
    }
    Ok(())
}

/// An array; `variable` is what an error names, `name` is empty inside a structure.
fn matrix(variable: &str, name: &str, value: &MatValue, out: &mut Vec<u8>) -> Result<(), MatError> {
    let mut body = Vec::new();
    let (class, sizes, data) = match value {
        MatValue::Real(sizes, values) => {
            let bytes = values.iter().flat_map(|value| value.to_le_bytes());
            let data = (MI_DOUBLE, bytes.collect::<Vec<u8>>());
            (MX_DOUBLE, sizes.clone(), Some(data))
        }
        MatValue::Text(text) => {
            let units = utf16(text);
            let bytes = units.iter().flat_map(|unit| unit.to_le_bytes());
            let data = (MI_UTF16, bytes.collect::<Vec<u8>>());
            let sizes = vec![usize::from(!units.is_empty()), units.len()];
            (MX_CHAR, sizes, Some(data))
        }
        MatValue::Struct(_) => (MX_STRUCT, vec![1, 1], None),
    };
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    element(variable, MI_UINT32, &flags, &mut body)?;
    let mut dimensions = Vec::new();
    for size in sizes {
        let size = i32::try_from(size).map_err(|_| MatError::TooLarge(variable.to_string()))?;
        dimensions.extend(size.to_le_bytes());
    }
    element(variable, MI_INT32, &dimensions, &mut body)?;
    element(variable, MI_INT8, name.as_bytes(), &mut body)?;
    if let Some((kind, bytes)) = data {
        element(variable, kind, &bytes, &mut body)?;
    }
    if let MatValue::Struct(fields) = value {
        structure(variable, fields, &mut body)?;
    }
    out.extend(MI_MATRIX.to_le_bytes());
    out.extend(length(variable, body.len())?.to_le_bytes());
    out.append(&mut body);
    Ok(())
}

/// Names and values of a structure's fields.
fn structure(
    variable: &str,
    fields: &[(String, MatValue)],
    out: &mut Vec<u8>,
) -> Result<(), MatError> {
    // Names end with a zero; programs expect 32 bytes each where that is enough.
    let longest = fields.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let width: u8 = if longest < 32 { 32 } else { 64 };
    element(variable, MI_INT32, &u32::from(width).to_le_bytes(), out)?;
    let mut names = Vec::new();
    for (name, _) in fields {
        let mut padded = name.clone().into_bytes();
        padded.resize(usize::from(width), 0);
        names.extend(padded);
    }
    element(variable, MI_INT8, &names, out)?;
    for (_, value) in fields {
        matrix(variable, "", value, out)?;
    }
    Ok(())
}

/// A data element: up to 4 bytes in the short form, else padded to a multiple of 8.
fn element(variable: &str, kind: u32, data: &[u8], out: &mut Vec<u8>) -> Result<(), MatError> {
    let bytes = length(variable, data.len())?;
    if data.len() <= 4 {
        out.extend((bytes << 16 | kind).to_le_bytes());
        out.extend(data);
        out.extend(vec![0; 4 - data.len()]);
        return Ok(());
    }
    out.extend(kind.to_le_bytes());
    out.extend(bytes.to_le_bytes());
    out.extend(data);
    out.extend(vec![0; data.len().next_multiple_of(8) - data.len()]);
    Ok(())
}

fn length(variable: &str, bytes: usize) -> Result<u32, MatError> {
    u32::try_from(bytes).map_err(|_| MatError::TooLarge(variable.to_string()))
}

/// MATLAB counts units of 16 bits; readers differ on characters of two units, so they are left out.
fn utf16(text: &str) -> Vec<u16> {
    let single = text
        .chars()
        .map(|c| if c.len_utf16() == 1 { c } else { '?' });
    single.collect::<String>().encode_utf16().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str, value: MatValue) -> Vec<(String, MatValue)> {
        vec![(name.to_string(), value)]
    }

    #[test]
    fn a_number_is_laid_out_as_the_format_says() {
        let bytes = to_bytes(&named("a", MatValue::Real(vec![1, 1], vec![1.5]))).unwrap();
        assert!(bytes.starts_with(b"MATLAB 5.0 MAT-file"));
        assert_eq!(bytes[116..128], [0, 0, 0, 0, 0, 0, 0, 0, 0, 1, b'I', b'M']);
        let expected = [
            [14, 0, 0, 0, 56, 0, 0, 0],
            [6, 0, 0, 0, 8, 0, 0, 0],
            [6, 0, 0, 0, 0, 0, 0, 0],
            [5, 0, 0, 0, 8, 0, 0, 0],
            [1, 0, 0, 0, 1, 0, 0, 0],
            [1, 0, 1, 0, b'a', 0, 0, 0],
            [9, 0, 0, 0, 8, 0, 0, 0],
            1.5_f64.to_le_bytes(),
        ];
        assert_eq!(bytes[128..], expected.concat());
    }

    #[test]
    fn names_that_matlab_does_not_have_are_refused() {
        for name in ["", "1a", "_a", "a b", "größe", &"a".repeat(64)] {
            let error = to_bytes(&named(name, MatValue::Text("x".into())));
            assert_eq!(error, Err(MatError::Name(name.to_string())));
            let inside = MatValue::Struct(named(name, MatValue::Text("x".into())));
            let error = to_bytes(&named("a", inside));
            assert_eq!(error, Err(MatError::Name(name.to_string())));
        }
        let once = named("a", MatValue::Struct(Vec::new()));
        let twice = [once.clone(), once].concat();
        assert_eq!(to_bytes(&twice), Err(MatError::Twice("a".to_string())));
    }
}
