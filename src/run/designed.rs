//! The flight controller of a design: constant or scheduled gains, on the memberships of its model.

use nalgebra::{SMatrix, SVector};
use runtime::attitude::AttitudeMeasurement;
use runtime::error::ParameterError;
use runtime::local_rules::{FuzzySet, LocalRules};
use runtime::membership::{Membership, RigidBodyBox, RIGID_BODY_VERTICES};
use runtime::xu2020;
use synth::fuzzy::RuleModel;
use synth::model::Plant;

use super::design::{threshold_update, Design};
use super::outcome::SimulateError;
use crate::controllers::xu2020::{StateOf, XuInLoop};
use crate::sim::controller::Use;
use crate::sim::embedding;

/// The limit of an input that only pads, which never receives a command.
const PADDED_LIMIT: f64 = 1.0;

/// Makes the controller of a design, its state padded to `N` and its input to `M`, and hands it on.
/// Rules are padded to the next of 1, 2, 4, 8, 16 by rules that are never used.
pub(crate) fn designed<T, const N: usize, const M: usize, U>(
    design: &Design,
    then: U,
) -> Result<U::Output, SimulateError>
where
    T: StateOf<N>,
    U: Use<T, M>,
{
    let states = design.model.plant.sizes().0;
    Ok(match design.law_gains()? {
        1 => then.with(XuInLoop::new(local::<N, M, 1>(design)?, states)),
        2 => then.with(XuInLoop::new(local::<N, M, 2>(design)?, states)),
        3..=4 => then.with(XuInLoop::new(local::<N, M, 4>(design)?, states)),
        5..=8 => then.with(XuInLoop::new(local::<N, M, 8>(design)?, states)),
        _ => then.with(XuInLoop::new(local::<N, M, 16>(design)?, states)),
    })
}

/// Makes the controller of a spacecraft's design and hands it on. That of an exact spacecraft has the
/// memberships of its box, with one gain or one for each vertex.
pub(crate) fn designed_attitude<U: Use<AttitudeMeasurement, 3>>(
    design: &Design,
    then: U,
) -> Result<U::Output, SimulateError> {
    let Plant::Spacecraft(craft) = &design.model.plant else {
        return designed(design, then);
    };
    let region = RigidBodyBox::new(craft.rate_bound.into(), craft.scalar_part_min)?;
    Ok(match design.law_gains()? {
        1 => then.with(XuInLoop::new(controller::<_, 6, 3, 1>(design, region)?, 6)),
        _ => then.with(XuInLoop::new(
            controller::<_, 6, 3, RIGID_BODY_VERTICES>(design, region)?,
            6,
        )),
    })
}

/// The controller with the memberships of local rules.
fn local<const N: usize, const M: usize, const R: usize>(
    design: &Design,
) -> Result<xu2020::Controller<LocalRules<N, R>, N, M, R>, ParameterError> {
    let (sets, bounds) = match &design.model.plant {
        Plant::Rules(rules) => (sets(rules), rules.system.box_bounds.as_slice()),
        _ => ([[FuzzySet::Any; N]; R], &[][..]),
    };
    controller(
        design,
        LocalRules::new(sets, embedding::filled(bounds, f64::INFINITY))?,
    )
}

/// The sets of the rules; a constant gain has one rule that is always used.
fn sets<const N: usize, const R: usize>(rules: &RuleModel) -> [[FuzzySet; N]; R] {
    let mut out = [[FuzzySet::Any; N]; R];
    if R == 1 {
        return out;
    }
    for (rule, row) in out.iter_mut().enumerate() {
        match rules.sets.get(rule) {
            None => *row = [FuzzySet::Never; N],
            Some(sets) => row.iter_mut().zip(sets).for_each(|(to, from)| *to = *from),
        }
    }
    out
}

fn controller<S, const N: usize, const M: usize, const R: usize>(
    design: &Design,
    membership: S,
) -> Result<xu2020::Controller<S, N, M, R>, ParameterError>
where
    S: Membership<N, R>,
{
    let certificate = &design.certificate;
    let specs = &design.model.file.specs;
    let gains: Vec<SMatrix<f64, M, N>> = certificate.gains().map(embedding::matrix).collect();
    let limit: SVector<f64, M> = embedding::filled(&design.law().1, PADDED_LIMIT);
    xu2020::Controller::new(xu2020::Parameters {
        gains: std::array::from_fn(|rule| gains.get(rule).copied().unwrap_or_else(SMatrix::zeros)),
        membership,
        trigger_weight: embedding::with_unit_diagonal(&certificate.trigger_weight),
        threshold_update: threshold_update(specs),
        torque_limit: limit,
        trigger_floor: certificate.trigger_floor,
        longest_interval_s: Some(specs.hbar_s),
    })
}
