//! A design as comma-separated values: one row for each number.

use super::design::DesignData;
use super::quantity::Quantity;
use crate::base::csv::{to_text, CsvError};

/// Columns of the table.
pub const COLUMNS: [&str; 7] = [
    "quantity", "matrix", "row", "column", "value", "unit", "text",
];

/// One row for each number, with its place counted from 1, and one for each word of provenance, whose
/// value is empty. Numbers read back exactly.
///
/// # Errors
/// Never for data in memory, as far as is known.
pub fn design(data: &DesignData) -> Result<String, CsvError> {
    let head = COLUMNS.map(str::to_string);
    let about = data.about().into_iter();
    let about = about.map(|(key, text)| {
        let [matrix, row, column, value, unit] = Default::default();
        [key, matrix, row, column, value, unit, text]
    });
    let numbers = data.quantities.iter().flat_map(|quantity| {
        let numbers = places(quantity).into_iter().zip(&quantity.values);
        numbers.map(|([matrix, row, column], value)| {
            let (name, unit) = (quantity.name.clone(), quantity.unit.to_string());
            let value = value.to_string();
            [name, matrix, row, column, value, unit, String::new()]
        })
    });
    to_text([head].into_iter().chain(about).chain(numbers))
}

/// Matrix, row and column of every number, empty where the quantity has none.
fn places(quantity: &Quantity) -> Vec<[String; 3]> {
    let [matrices, rows, columns] = quantity.extent();
    let dimensions = quantity.shape.len();
    let shown = |index: usize, least: usize| match dimensions >= least {
        true => (index + 1).to_string(),
        false => String::new(),
    };
    let mut out = Vec::with_capacity(quantity.values.len());
    for matrix in 0..matrices {
        for row in 0..rows {
            for column in 0..columns {
                out.push([shown(matrix, 3), shown(row, 1), shown(column, 2)]);
            }
        }
    }
    out
}
