//! What a search may vary, as written in a model file.

use super::error::ModelError;
use super::file::{GainForm, ModelFile, PlantFile, SearchFile};
use super::objective::Objective;
use super::ranges::require;

/// Checks the limits of a model's search, and that its objective has a meaning.
pub(super) fn check_search(file: &ModelFile) -> Result<(), ModelError> {
    let exact = matches!(file.plant, PlantFile::Exact(_));
    let search = file.specs.search.as_ref();
    if file.specs.objective == Objective::Region && !exact && file.specs.must_contain.is_empty() {
        return Err(ModelError::choice(
            "specs.must_contain",
            "the list is empty; for the objective 'region' it must hold at least one state to be covered, \
             because only an 'exact' plant has attitudes to cover in its place",
        ));
    }
    if search.is_some() && file.specs.objective == Objective::Both {
        return Err(ModelError::choice(
            "specs.search",
            "the objective \"both\" takes its limits from specs.outer; leave the search out",
        ));
    }
    if exact && (search.is_some() || file.specs.objective == Objective::Region) {
        check_starts(file)?;
    }
    if file.gains == GainForm::Scheduled
        && (search.is_some() || file.specs.objective == Objective::Region)
    {
        let reason = "a search needs constant gains; it must be \"constant\"";
        return Err(ModelError::choice("gains", reason));
    }
    check_asked(file)?;
    search.map_or(Ok(()), |search| check_limits(search, exact))
}

/// A gain is asked for once, and of one design.
fn check_asked(file: &ModelFile) -> Result<(), ModelError> {
    let specs = &file.specs;
    let (field, given) = match specs.gamma {
        Some(_) => ("specs.gamma", true),
        None => ("specs.gamma_max", specs.gamma_max.is_some()),
    };
    let searched =
        specs.search.is_some() || matches!(specs.objective, Objective::Region | Objective::Both);
    let reason = match (searched, specs.gamma, specs.gamma_max) {
        (true, ..) if given => {
            "has no meaning for a search or for the objectives region and both; \
             specs.search has gamma_max and guaranteed_gain_max"
        }
        (_, Some(_), Some(_)) => "goes without gamma_max: it is the gain that is asked for",
        _ => return Ok(()),
    };
    Err(ModelError::choice(field, reason))
}

/// The vector part of a quaternion is at most 1 long.
fn check_starts(file: &ModelFile) -> Result<(), ModelError> {
    for (index, state) in file.specs.must_contain.iter().enumerate() {
        let norm = state.iter().skip(3).map(|q| q * q).sum::<f64>().sqrt();
        let field = format!("specs.must_contain[{index}]");
        if norm > 1.0 {
            let reason = format!(
                "the vector part of the quaternion (entries 4 to 6) has the norm {norm}; it must be at most 1"
            );
            return Err(ModelError::choice(field, reason));
        }
        if state.iter().all(|&entry| entry == 0.0) {
            let reason = "the state is zero, which every set contains; name a state to be covered";
            return Err(ModelError::choice(field, reason));
        }
    }
    Ok(())
}

fn check_limits(search: &SearchFile, exact: bool) -> Result<(), ModelError> {
    let field = |name: &str| format!("specs.search.{name}");
    let ranges = [
        ("phi_per_s", search.phi_per_s),
        ("nu", search.nu),
        ("rate_rad_s", search.rate_rad_s),
        ("q0_min", search.q0_min),
        ("eps_1", search.eps_1),
        ("eps_3", search.eps_3),
        ("xi_max", search.xi_max),
    ];
    for (name, range) in ranges {
        if let Some([low, high]) = range.filter(|[low, high]| low > high) {
            let reason =
                format!("the range [{low}, {high}] is reversed; the lowest value comes first");
            return Err(ModelError::choice(field(name), reason));
        }
    }
    let rounds = search.rounds;
    let ok = (1..=1000).contains(&rounds);
    require(ok, &field("rounds"), f64::from(rounds), "in 1 to 1000")?;
    let only_exact = [
        ("rate_rad_s", search.rate_rad_s.is_some()),
        ("q0_min", search.q0_min.is_some()),
        (
            "certified_angle_min_deg",
            search.certified_angle_min_deg.is_some(),
        ),
    ];
    match only_exact.iter().find(|(_, given)| *given && !exact) {
        None => Ok(()),
        Some((name, _)) => {
            let reason = "only an 'exact' plant has it; leave it out";
            Err(ModelError::choice(field(name), reason))
        }
    }
}
