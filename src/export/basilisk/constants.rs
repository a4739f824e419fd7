//! Constants of a Python file.

use nalgebra::SMatrix;

/// A name with its value as Python text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Constant {
    name: &'static str,
    text: String,
}

impl Constant {
    /// Numbers as a list of lists.
    pub fn new(name: &'static str, list: String) -> Self {
        Constant {
            name,
            text: format!("np.array({list}, dtype=float)"),
        }
    }

    /// Its line.
    pub fn line(&self) -> String {
        format!("{} = {}", self.name, self.text)
    }
}

/// A number that reads back as the same double.
fn literal(value: f64) -> String {
    match value.is_finite() {
        true => format!("{value:?}"),
        false => "math.inf".to_string(),
    }
}

/// A number.
pub fn number(name: &'static str, value: f64) -> Constant {
    Constant {
        name,
        text: literal(value),
    }
}

/// Yes or no.
pub fn flag(name: &'static str, value: bool) -> Constant {
    let text = if value { "True" } else { "False" };
    Constant {
        name,
        text: text.to_string(),
    }
}

/// The same for each axis.
pub fn flags(name: &'static str, value: bool) -> Constant {
    let one = if value { "True" } else { "False" };
    Constant {
        name,
        text: format!("np.array([{one}, {one}, {one}], dtype=bool)"),
    }
}

/// A list of numbers.
pub fn numbers(name: &'static str, values: &[f64]) -> Constant {
    Constant::new(name, list(values))
}

/// A list of rows.
pub fn rows(name: &'static str, rows: &[Vec<f64>]) -> Constant {
    Constant::new(name, matrix(rows))
}

/// A matrix.
pub fn of_matrix<const R: usize, const C: usize>(
    name: &'static str,
    matrix: &SMatrix<f64, R, C>,
) -> Constant {
    let row = |row: usize| (0..C).map(|column| matrix[(row, column)]).collect();
    let all: Vec<Vec<f64>> = (0..R).map(row).collect();
    rows(name, &all)
}

/// Several matrices.
pub fn matrices(all: &[Vec<Vec<f64>>]) -> String {
    let inner: Vec<String> = all.iter().map(|one| matrix(one)).collect();
    format!("[{}]", inner.join(",\n    "))
}

fn matrix(rows: &[Vec<f64>]) -> String {
    let inner: Vec<String> = rows.iter().map(|row| list(row)).collect();
    format!("[{}]", inner.join(",\n    "))
}

fn list(values: &[f64]) -> String {
    let inner: Vec<String> = values.iter().map(|&value| literal(value)).collect();
    format!("[{}]", inner.join(", "))
}
