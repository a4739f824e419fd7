//! A parameter search for the controller of Lei et al. 2022.
//!
//! A [`requirements file`](file::TuneFile) says what the spacecraft is and what it must do. [`limits`]
//! refuses what no controller can do. A [`shape::Shape`] is a parameter set without units, from which
//! [`shape`] makes the parameters of a given spacecraft and start; [`search`] looks for a shape with
//! which every run of a training set meets the requirements, and [`tune`] tries it on starts that the
//! search has not seen.

pub mod file;
pub mod limits;
pub mod report;
pub mod search;
pub mod shape;
pub mod trial;

use nalgebra::Vector3;

use file::Requirements;
use report::TuneReport;
use search::Search;
use trial::starts;

use super::engine::{Control, Interrupted, Threads};
use crate::scenario::ScenarioFile;
use crate::sim::random::{Purpose, Random};

/// Most times that starts on which the search failed are added to its training set.
const ROUNDS: usize = 3;

/// The proposed scenario and what it was found to do.
#[derive(Debug, Clone)]
pub struct Tuned {
    /// The scenario, for the start that the requirements name.
    pub scenario: ScenarioFile,
    /// How it came about, and how it does from other starts.
    pub report: TuneReport,
}

/// Searches and validates.
///
/// # Errors
/// It was stopped.
pub fn tune(
    requirements: &Requirements,
    threads: &Threads,
    control: &Control,
) -> Result<Tuned, Interrupted> {
    let settings = &requirements.file.search;
    let mut random = Random::new(settings.seed, Purpose::InitialState);
    // Drawn first, so that they do not depend on how the search goes.
    let unseen = axes(&mut random, settings.validation_axes);
    let mut training: Vec<Vector3<f64>> = (0..3).map(|axis| Vector3::ith(axis, 1.0)).collect();
    training.extend(axes(&mut random, settings.training_axes));
    let mut search = Search::new(requirements, threads, control);
    for _ in 0..ROUNDS {
        search.run(&training)?;
        let fresh = axes(&mut random, settings.validation_axes);
        let trials = search.trials(&search.shape, &starts(&fresh))?;
        let missed = trials.iter().filter(|trial| !trial.met());
        let mut missed: Vec<Vector3<f64>> = missed.map(|trial| trial.start.axis).collect();
        missed.dedup();
        if missed.is_empty() || search.exhausted() {
            break;
        }
        training.extend(missed);
    }
    let trials = search.trials(&search.shape, &starts(&unseen))?;
    let scenario = shape::scenario(requirements, &search.shape, &requirements.start());
    Ok(Tuned {
        report: TuneReport::new(requirements, &search, &scenario, unseen.len(), trials),
        scenario,
    })
}

/// Axes uniform on the sphere.
fn axes(random: &mut Random, count: usize) -> Vec<Vector3<f64>> {
    let mut axis = || loop {
        let direction = Vector3::from_fn(|_, _| random.normal());
        if let Some(axis) = direction.try_normalize(1e-6) {
            return axis;
        }
    };
    (0..count).map(|_| axis()).collect()
}
