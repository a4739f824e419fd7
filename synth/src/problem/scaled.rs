//! A design problem in units of its own, and the way back.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::conditions::state_feedback::{
    DesignProblem, Floor, StateFeedback, Transformed, VertexPlant,
};
use crate::conditions::units::{Sizes, Units};
use crate::riccati::symmetric;

/// A problem and its plant in the units of a solver.
#[derive(Clone)]
pub(super) struct Scaled<P> {
    pub(super) units: Units,
    pub(super) problem: P,
    pub(super) plant: VertexPlant,
    /// In these units.
    pub(super) floor: Option<Floor>,
    /// The margins of the strict conditions, by name, as diagonals: what a relative margin refers to. Empty before
    /// anything is solved.
    pub(super) weights: BTreeMap<String, DVector<f64>>,
    /// True where the feedback is eliminated.
    pub(super) eliminated: bool,
}

/// Sizes within this factor of the units need no other units.
const NEAR: f64 = 4.0;

impl<P: DesignProblem> Scaled<P> {
    pub(super) fn new(
        requested: &P,
        plant: &VertexPlant,
        sizes: &Sizes,
        floor: Option<Floor>,
    ) -> Self {
        let units = requested.units(plant, sizes);
        Scaled {
            problem: requested.in_units(&units),
            plant: plant.in_units(&units),
            floor: floor.map(|floor| Floor {
                objective: floor.objective / units.objective,
                ..floor
            }),
            weights: BTreeMap::new(),
            eliminated: false,
            units,
        }
    }

    /// The sizes in the ellipsoid of a solver's point, proved or not; `None` where Q has no positive diagonal.
    pub(super) fn sizes_at(
        &self,
        transformed: &Transformed,
        values: &[f64],
        objective: f64,
    ) -> Option<Sizes> {
        let diagonal = transformed.inverse.value(values).diagonal();
        let usable = diagonal
            .iter()
            .all(|&entry| entry > 0.0 && entry.is_finite());
        usable.then(|| Sizes {
            state: diagonal.zip_map(&self.units.state, |square, unit| {
                (square / self.units.energy).sqrt() * unit
            }),
            input: None,
            objective: Some(objective),
        })
    }

    /// Undoes the transformation of the unknowns: P = Q^-1, F = Y P, H = Z P; then the units. `objective` is in the
    /// file's units. `None` where that is not possible.
    pub(super) fn recover(
        &self,
        requested: &P,
        given: Option<&DMatrix<f64>>,
        transformed: &Transformed,
        (values, objective): (&[f64], f64),
    ) -> Option<StateFeedback> {
        let units = &self.units;
        let q = transformed.inverse.value(values);
        let y = match self.eliminated {
            true => self.problem.completed(&self.plant, &q)?,
            false => transformed.gain.value(values),
        };
        let scaled = symmetric(&q.try_inverse()?);
        let gain = match P::GAIN_IS_AUXILIARY {
            true => self.problem.quickened(&self.plant, &scaled, &(y * &scaled)),
            false => y * &scaled,
        };
        let in_file_units = |gain: DMatrix<f64>| units.gain_in_file_units(&gain);
        let auxiliary = transformed.auxiliary.iter().zip(P::AUXILIARY_GAINS);
        let mut found = StateFeedback {
            gain: match given {
                Some(given) => given.clone(),
                None => in_file_units(gain),
            },
            auxiliary: auxiliary
                .map(|(z, name)| (name.to_string(), in_file_units(z.value(values) * &scaled)))
                .collect::<BTreeMap<_, _>>(),
            lyapunov: units.unweighed(&scaled) * units.energy,
            guarantee: f64::NAN,
        };
        requested.claim(&mut found, objective);
        let finite = |matrix: &DMatrix<f64>| matrix.iter().all(|value| value.is_finite());
        let usable = finite(&found.gain)
            && finite(&found.lyapunov)
            && found.auxiliary.values().all(finite)
            && found.guarantee.is_finite()
            && found.guarantee > 0.0;
        usable.then_some(found)
    }
}

/// The sizes of states and inputs in the ellipsoid x'Px <= 1 of a feedback, and its objective.
pub(super) fn sizes_of<P: DesignProblem>(found: &StateFeedback) -> Option<Sizes> {
    let inverse = symmetric(&found.lyapunov.clone().try_inverse()?);
    let squares = (&found.gain * &inverse * found.gain.transpose()).diagonal();
    let (state, input) = (inverse.diagonal().map(f64::sqrt), squares.map(f64::sqrt));
    let usable = |sizes: &DVector<f64>| sizes.iter().all(|&size| size.is_finite() && size > 0.0);
    let objective = P::objective_of(found.guarantee);
    usable(&state).then(|| Sizes {
        input: usable(&input).then_some(input),
        objective: Some(objective),
        state,
    })
}

/// True where no size of a state is far from its unit.
pub(super) fn near(units: &Units, sizes: &Sizes) -> bool {
    let ratios = sizes.state.component_div(&units.state);
    ratios.max() / ratios.min() <= NEAR
}
