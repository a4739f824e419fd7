//! A second search of a spacecraft's parameters, in units in which every spacecraft looks alike: it begins elsewhere, and
//! its programs are well scaled whatever the size of the craft.

use super::plan::Plan;
use crate::certify::reach::angle_of_vector_part_deg;
use crate::model::{Model, ModelFile, OutputWeights, PlantFile};
use crate::natural_units::{turn_time, NaturalUnits};
use crate::optimality::Optimality;
use crate::programs::Outcome;
use crate::synthesis::restated;

/// A model in natural units, with what it takes to restate its design.
pub(super) struct NaturalModel {
    units: NaturalUnits,
    /// The model in these units.
    pub model: Model,
    /// Whether the model in SI units states output weights; else they are those of its objective.
    states_weights: bool,
    /// The farthest start (rad) times the disturbance over the weakest torque limit: the vector part of a pointing error is
    /// a few halves of this.
    natural_error: f64,
}

/// A pointing error of so many natural ones is taken for that of a search that went wrong: 2 to 7 are usual.
const POOR: f64 = 10.0;

impl NaturalModel {
    /// For a search for the smallest guaranteed gain of a spacecraft with starts that must be contained; `None` for
    /// others, for a bound on gamma, which depends on the units, and where the units are those of the model.
    pub fn of(model: &Model, plan: &Plan) -> Option<Self> {
        let specs = &model.file.specs;
        let PlantFile::Exact(exact) = &model.file.plant else {
            return None;
        };
        if !specs.objective.is_guaranteed_gain() || plan.limits.gamma_max.is_some() {
            return None;
        }
        let farthest = farthest_deg(plan)?.to_radians();
        let weakest = exact
            .torque_limit_nm
            .iter()
            .copied()
            .fold(f64::INFINITY, f64::min);
        let inertia = &exact.inertia_kg_m2;
        let time = turn_time(inertia, &exact.torque_limit_nm, farthest);
        let units = NaturalUnits::of_turn(time, inertia);
        if units == NaturalUnits::near(1.0, 1.0) {
            return None;
        }
        let mut file = model.file.clone();
        let weights = OutputWeights::of(exact.output_weights, specs.objective).ok()?;
        set_weights(&mut file, Some(weights));
        Some(NaturalModel {
            units,
            model: Model::new(units.from_si(&file)).ok()?,
            states_weights: exact.output_weights.is_some(),
            natural_error: farthest * exact.disturbance_bound_nm / weakest,
        })
    }

    /// Whether the search in the model's own units found no proved design, or one with a pointing error out of all
    /// proportion to the disturbance.
    pub fn is_worth_trying(&self, own: &Outcome) -> bool {
        let Outcome::Solved(design) = own else {
            return true;
        };
        let bounds = design.file.certificate.final_bounds.as_ref();
        let error = bounds.map(|bounds| 2.0 * bounds.vector_part);
        let poor = error.is_some_and(|error| error > POOR * self.natural_error);
        poor || !design.is_proved()
    }

    /// The outcome in SI units where it is a proved design; `None` for any other.
    pub fn restated(&self, outcome: Outcome) -> Option<Outcome> {
        let Outcome::Solved(mut design) = outcome else {
            return None;
        };
        let found = design.file.certificate.guaranteed_gain;
        let best_seen = design.optimality.map(|gap| gap.best_seen / found);
        if !self.states_weights {
            set_weights(&mut design.file.model, None);
        }
        let mut own = restated(self.units, *design).ok()?;
        let gain = own.file.certificate.guaranteed_gain;
        own.optimality = best_seen.and_then(|ratio| Optimality::of_smallest(gain, ratio * gain));
        own.is_proved().then(|| Outcome::Solved(Box::new(own)))
    }
}

fn set_weights(file: &mut ModelFile, weights: Option<OutputWeights>) {
    if let PlantFile::Exact(exact) = &mut file.plant {
        exact.output_weights = weights;
    }
}

/// The largest angle of the attitudes that must be contained (deg); `None` where there are none.
fn farthest_deg(plan: &Plan) -> Option<f64> {
    let states = plan.contained.iter().flat_map(|set| set.column_iter());
    let attitudes = states.map(|state| state.rows(3, 3).norm());
    let farthest = attitudes.filter(|norm| *norm > 0.0).reduce(f64::max)?;
    Some(angle_of_vector_part_deg(farthest.min(1.0)))
}
