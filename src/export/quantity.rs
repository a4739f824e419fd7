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
    pub unit: &'static str,
    /// What it is.
    pub meaning: String,
}

/// A number, or a list of what is itself one of these, all of one size.
pub trait Numbers {
    /// Sizes, from the outermost list to the innermost.
    fn shape(&self) -> Vec<usize>;
    /// The numbers, last index fastest.
    fn values(&self) -> Vec<f64>;
}

impl Numbers for f64 {
    fn shape(&self) -> Vec<usize> {
        Vec::new()
    }

    fn values(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl<T: Numbers> Numbers for [T] {
    fn shape(&self) -> Vec<usize> {
        let inner = self.first().map_or(Vec::new(), T::shape);
        [vec![self.len()], inner].concat()
    }

    fn values(&self) -> Vec<f64> {
        self.iter().flat_map(T::values).collect()
    }
}

impl<T: Numbers> Numbers for Vec<T> {
    fn shape(&self) -> Vec<usize> {
        self.as_slice().shape()
    }

    fn values(&self) -> Vec<f64> {
        self.as_slice().values()
    }
}

impl Quantity {
    /// Numbers under a name.
    pub fn new<T: Numbers + ?Sized>(name: &str, unit: &'static str, numbers: &T) -> Self {
        Self {
            name: name.to_string(),
            shape: numbers.shape(),
            values: numbers.values(),
            unit,
            meaning: String::new(),
        }
    }

    /// With what it is.
    pub fn means(mut self, meaning: &str) -> Self {
        self.meaning = meaning.to_string();
        self
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
