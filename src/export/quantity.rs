//! A named array of numbers.

/// Numbers with a shape, a unit and a meaning.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Name: the key of the design or model file; an identifier in C and MATLAB.
    pub name: String,
    /// Sizes: none for a number, entries of a vector, rows and columns of a matrix, or the number of
    /// matrices and then their rows and columns. No size is 0.
    pub shape: Vec<usize>,
    /// The numbers, last index fastest.
    pub values: Vec<f64>,
    /// Unit; 1 for none.
    pub unit: String,
    /// What it is.
    pub meaning: String,
}

impl Quantity {
    /// A number.
    pub fn number(name: &str, value: f64, unit: &str, meaning: &str) -> Self {
        Self::new(name, Vec::new(), vec![value], unit, meaning)
    }

    /// A vector.
    pub fn vector(name: &str, values: &[f64], unit: &str, meaning: &str) -> Self {
        Self::new(name, vec![values.len()], values.to_vec(), unit, meaning)
    }

    /// A matrix, given by its rows, which have the same length.
    pub fn matrix(name: &str, rows: &[Vec<f64>], unit: &str, meaning: &str) -> Self {
        let shape = vec![rows.len(), rows.first().map_or(0, Vec::len)];
        Self::new(name, shape, rows.concat(), unit, meaning)
    }

    /// Matrices of one size.
    pub fn matrices(name: &str, matrices: &[Vec<Vec<f64>>], unit: &str, meaning: &str) -> Self {
        let first = matrices.first();
        let columns = first.and_then(|rows| rows.first()).map_or(0, Vec::len);
        let shape = vec![matrices.len(), first.map_or(0, Vec::len), columns];
        let values = matrices.iter().flatten().flatten().copied().collect();
        Self::new(name, shape, values, unit, meaning)
    }

    fn new(name: &str, shape: Vec<usize>, values: Vec<f64>, unit: &str, meaning: &str) -> Self {
        Self {
            name: name.to_string(),
            shape,
            values,
            unit: unit.to_string(),
            meaning: meaning.to_string(),
        }
    }

    /// Number of matrices, of rows and of columns; a vector is one column.
    pub fn extent(&self) -> [usize; 3] {
        match *self.shape.as_slice() {
            [matrices, rows, columns] => [matrices, rows, columns],
            [rows, columns] => [1, rows, columns],
            [rows] => [1, rows, 1],
            _ => [1, 1, 1],
        }
    }
}
