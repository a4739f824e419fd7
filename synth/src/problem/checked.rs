//! From a problem file to checked numbers.

use nalgebra::{DMatrix, DVector};

use super::file::{
    HInfinityFile, HullFile, ProblemFile, ProblemKindFile, ProblemPlantFile, ReferenceFile,
    SaturatedRegionFile, PROBLEM_SCHEMA_VERSION,
};
use super::DesignTask;
use crate::conditions::h_infinity::HInfinity;
use crate::conditions::quadratic_stabilisation::QuadraticStabilisation;
use crate::conditions::saturated_region::{ReferenceSet, SaturatedRegion, MAX_SATURATED_INPUTS};
use crate::conditions::state_feedback::{VertexPlant, Wanted};
use crate::model::{
    check_bounds, check_count, check_line, check_matrix, check_positive_definite, check_seen,
    check_state_matrices, check_version, entries, parse, FileError, Kind, ModelError, Size,
    MAX_BOUNDS, MAX_COLUMNS,
};

/// A checked problem file.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem {
    /// The file it came from, unchanged.
    pub file: ProblemFile,
    /// The plant.
    pub plant: VertexPlant,
    /// What is requested.
    pub task: DesignTask,
}

impl Problem {
    /// Reads and checks the text of a problem file.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        Ok(Problem::new(parse(text, Kind::Problem)?)?)
    }

    /// Checks what the ranges of single numbers leave open.
    pub(super) fn new(file: ProblemFile) -> Result<Self, ModelError> {
        check_version(file.schema_version, PROBLEM_SCHEMA_VERSION)?;
        check_line("name", &file.name)?;
        let ProblemPlantFile::Vertices(hull) = &file.plant;
        let plant = check_plant(hull, file.gain.as_deref())?;
        let task = match &file.problem {
            ProblemKindFile::QuadraticStabilisation(requested) => {
                let rate = requested.decay_rate_per_s;
                let task = QuadraticStabilisation::new(rate, plant.states());
                DesignTask::QuadraticStabilisation(task)
            }
            ProblemKindFile::HInfinity(requested) => {
                DesignTask::HInfinity(check_h_infinity(requested, &plant)?)
            }
            ProblemKindFile::SaturatedRegion(requested) => {
                DesignTask::SaturatedRegion(check_region(requested, &plant)?)
            }
        };
        Ok(Problem { file, plant, task })
    }
}

fn check_plant(hull: &HullFile, gain: Option<&[Vec<f64>]>) -> Result<VertexPlant, ModelError> {
    let vertices = check_state_matrices(&hull.state_matrices)?;
    let states = vertices[0].nrows();
    let field = "plant.vertices.input_matrix";
    let input = check_matrix(field, &hull.input_matrix, (Some(states), None))?;
    check_count(field, "columns", input.ncols(), MAX_COLUMNS)?;
    let size = (Some(input.ncols()), Some(states));
    let gain = gain
        .map(|rows| check_matrix("gain", rows, size))
        .transpose()?;
    Ok(VertexPlant {
        vertices,
        input,
        gain,
    })
}

fn check_h_infinity(
    requested: &HInfinityFile,
    plant: &VertexPlant,
) -> Result<HInfinity, ModelError> {
    let matrix = |key: &str, rows: &[Vec<f64>], size: Size| {
        let field = format!("problem.h_infinity.{key}");
        let matrix = check_matrix(&field, rows, size)?;
        check_count(&field, "columns", matrix.ncols(), MAX_COLUMNS)?;
        check_count(&field, "rows", matrix.nrows(), MAX_COLUMNS)?;
        Ok::<_, ModelError>(matrix)
    };
    if let (Some(_), Some(at_most)) = (requested.gamma, requested.gamma_max) {
        let field = "problem.h_infinity.gamma_max";
        let allowed = "left out where gamma is given";
        return Err(ModelError::range(field, at_most, allowed));
    }
    let (n, m) = (plant.states(), plant.inputs());
    let disturbance = matrix(
        "disturbance_matrix",
        &requested.disturbance_matrix,
        (Some(n), None),
    )?;
    let output = matrix("output_matrix", &requested.output_matrix, (None, Some(n)))?;
    let (d, p) = (disturbance.ncols(), output.nrows());
    let direct = |key: &str, rows: &Option<Vec<Vec<f64>>>, columns: usize| match rows {
        Some(rows) => matrix(key, rows, (Some(p), Some(columns))),
        None => Ok(DMatrix::zeros(p, columns)),
    };
    let from_input = &requested.input_to_output_matrix;
    let from_disturbance = &requested.disturbance_to_output_matrix;
    let input_to_output = direct("input_to_output_matrix", from_input, m)?;
    let disturbance_to_output = direct("disturbance_to_output_matrix", from_disturbance, d)?;
    let all = [&output, &input_to_output, &disturbance_to_output];
    check_seen("problem.h_infinity.output_matrix", &all)?;
    Ok(HInfinity {
        input_to_output,
        disturbance_to_output,
        disturbance,
        output,
        wanted: Wanted {
            exactly: requested.gamma,
            at_most: requested.gamma_max,
        },
    })
}

fn check_region(
    requested: &SaturatedRegionFile,
    plant: &VertexPlant,
) -> Result<SaturatedRegion, ModelError> {
    let field = |key: &str| format!("problem.saturated_region.{key}");
    let (n, m) = (plant.states(), plant.inputs());
    check_count(
        "plant.vertices.input_matrix",
        "columns (for saturated_region)",
        m,
        MAX_SATURATED_INPUTS,
    )?;
    if requested.input_limit.len() != m {
        let found = entries(requested.input_limit.len());
        let expected = format!("{}, one for each input", entries(m));
        return Err(ModelError::shape(field("input_limit"), found, expected));
    }
    let reference = match &requested.reference {
        None => ReferenceSet::Ellipsoid(DMatrix::identity(n, n)),
        Some(ReferenceFile::Ellipsoid(rows)) => {
            let field = field("reference.ellipsoid");
            let weight = check_matrix(&field, rows, (Some(n), Some(n)))?;
            check_positive_definite(&field, &weight)?;
            ReferenceSet::Ellipsoid(weight)
        }
        Some(ReferenceFile::Points(points)) => check_points(&field("reference.points"), points, n)?,
    };
    let (rows, bounds) = check_bounds(&field("box"), &requested.region, n)?;
    let region = bounds.iter().enumerate();
    Ok(SaturatedRegion {
        input_limit: DVector::from_column_slice(&requested.input_limit),
        decay_rate: requested.decay_rate_per_s,
        reference,
        region: region
            .map(|(i, &bound)| (rows.rows(i, 1).into_owned(), bound))
            .collect(),
    })
}

fn check_points(field: &str, points: &[Vec<f64>], n: usize) -> Result<ReferenceSet, ModelError> {
    check_count(field, "points", points.len(), MAX_BOUNDS)?;
    let matrix = check_matrix(field, points, (None, Some(n)))?;
    if let Some(zero) = matrix
        .row_iter()
        .position(|row| row.iter().all(|&x| x == 0.0))
    {
        let allowed = "a point with an entry that is not 0";
        return Err(ModelError::range(format!("{field}[{zero}]"), 0.0, allowed));
    }
    let points = matrix
        .row_iter()
        .map(|row| DMatrix::from_column_slice(n, 1, row.transpose().as_slice()));
    Ok(ReferenceSet::Points(points.collect()))
}
