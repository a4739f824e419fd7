//! A design as comma-separated values: one row for each number.

use super::design::DesignData;
use super::quantity::Quantity;

/// Columns of the table.
pub const COLUMNS: [&str; 7] = [
    "quantity", "matrix", "row", "column", "value", "unit", "text",
];

/// The table could not be put together.
#[derive(Debug, thiserror::Error)]
#[error("the table cannot be written: {0}")]
pub struct CsvError(#[from] ::csv::Error);

/// One row for each number, with its place counted from 1, and one for each word of provenance, whose
/// value is empty. Numbers read back exactly.
///
/// # Errors
/// Never for data in memory, as far as is known.
pub fn design(data: &DesignData) -> Result<String, CsvError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for (key, text) in data.about() {
        writer.write_record([&key, "", "", "", "", "", &text])?;
    }
    for quantity in &data.quantities {
        for (place, value) in places(quantity).into_iter().zip(&quantity.values) {
            let [matrix, row, column] = place;
            let value = value.to_string();
            let name = &quantity.name;
            writer.write_record([name, &matrix, &row, &column, &value, &quantity.unit, ""])?;
        }
    }
    let bytes = writer
        .into_inner()
        .map_err(|error| ::csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
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
