//! A run's trajectory with its units and provenance.

use arrow_array::Float64Array;

use super::mat::{texts, to_bytes, MatError, MatValue};
use crate::base::parquet::{self, Column, ParquetError};
use crate::base::provenance::GENERATOR;
use crate::base::table::Table;
use crate::base::unit::unit_of_key;
use crate::run::summary::{CertificateOutcome, Summary};

/// A trajectory and what is to be said of it.
#[derive(Debug, Clone)]
pub struct TrajectoryData {
    /// The table.
    pub table: Table,
    /// Keys and texts of its provenance, in order.
    pub about: Vec<(&'static str, String)>,
}

impl TrajectoryData {
    /// A trajectory with the summary of its run, where there is one, and the SHA-256 of its file.
    pub fn new(table: Table, summary: Option<&Summary>, sha256: String) -> Self {
        let mut about = vec![
            ("exported_by", GENERATOR.to_string()),
            ("trajectory_sha256", sha256),
        ];
        if let Some(summary) = summary {
            about.extend(provenance(summary));
        }
        Self { table, about }
    }

    /// The table as Parquet: doubles; units in the columns' metadata, provenance in the file's.
    ///
    /// # Errors
    /// None for a table whose columns have names of their own.
    pub fn to_parquet(&self) -> Result<Vec<u8>, ParquetError> {
        let columns = self
            .columns()
            .map(|(name, values)| Column::new(name, unit(name), Float64Array::from(values)));
        let columns: Vec<Column> = columns.collect();
        parquet::to_bytes(&columns, &self.about)
    }

    /// A MAT-file: each column a variable, and the structures `units` and `provenance`.
    ///
    /// # Errors
    /// A column whose name MATLAB does not have; a column beyond 4 GiB.
    pub fn to_mat(&self) -> Result<Vec<u8>, MatError> {
        let units = self.table.columns.iter().map(|name| (name, unit(name)));
        let about = self.about.iter().map(|(key, text)| (key, text));
        let mut variables = vec![
            ("units".to_string(), texts(units)),
            ("provenance".to_string(), texts(about)),
        ];
        for (name, values) in self.columns() {
            let value = MatValue::Real(vec![values.len(), 1], values);
            variables.push((name.to_string(), value));
        }
        to_bytes(&variables)
    }

    fn columns(&self) -> impl Iterator<Item = (&str, Vec<f64>)> {
        let width = self.table.columns.len().max(1);
        let named = self.table.columns.iter().enumerate();
        named.map(move |(index, name)| {
            let values = self.table.values.iter().skip(index).step_by(width);
            (name.as_str(), values.copied().collect())
        })
    }
}

/// The unit of a column; 1 for a number without one.
fn unit(column: &str) -> &'static str {
    match unit_of_key(column) {
        "" => "1",
        unit => unit,
    }
}

fn provenance(summary: &Summary) -> Vec<(&'static str, String)> {
    let made = &summary.provenance;
    let design = made.design_sha256.clone().unwrap_or("none".to_string());
    let certificate = summary.certificate.as_ref();
    let proof = certificate.map(CertificateOutcome::as_text);
    let proof = proof.unwrap_or("nothing is proved for this controller".to_string());
    vec![
        ("scenario", summary.scenario.clone()),
        ("source", summary.source.clone()),
        ("system", summary.system.key().to_string()),
        ("controller", summary.controller.clone()),
        ("verdict", summary.verdict.name().to_string()),
        ("proof", proof),
        ("generator", made.generator.clone()),
        ("integrator", made.integrator.clone()),
        ("random_generator", made.random_generator.clone()),
        ("seed", made.seed.to_string()),
        ("scenario_sha256", made.scenario_sha256.clone()),
        ("design_sha256", design),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_without_a_unit_have_unit_1() {
        let names = ["error_q0_scalar", "sent", "time_s"];
        assert_eq!(names.map(unit), ["1", "1", "s"]);
    }
}
