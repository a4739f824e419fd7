//! What every layer above uses: checks of a file's numbers, digests, tables and their files, units, numbers as
//! text.

pub mod bounded;
pub mod compressed;
pub mod condition;
pub mod csv;
pub mod files;
pub mod guarded;
pub mod number;
pub mod parquet;
pub mod plant_model;
pub mod provenance;
pub mod ranges;
pub mod table;
pub mod trajectory;
pub mod unit;
