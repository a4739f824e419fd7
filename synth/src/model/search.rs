//! What a search may vary, as written in a model file.

use super::error::ModelError;
use super::file::{GainForm, ModelFile, Objective, PlantFile, SearchFile};
use super::ranges::{check_positive, require};

/// Checks the limits of a model's search, and that its objective has a meaning.
pub(super) fn check_search(file: &ModelFile) -> Result<(), ModelError> {
    let exact = matches!(file.plant, PlantFile::Exact(_));
    let search = file.specs.search.as_ref();
    if file.specs.objective == Objective::Region && !exact && file.specs.must_contain.is_empty() {
        return Err(ModelError::Choice {
            field: "specs.must_contain".to_string(),
            reason: "the list is empty; for the objective 'region' it must hold at least one state to be covered, \
                     because only an 'exact' plant has attitudes to cover in its place"
                .to_string(),
        });
    }
    if search.is_some() && file.specs.objective == Objective::Both {
        return Err(ModelError::Choice {
            field: "specs.search".to_string(),
            reason:
                "the objective \"both\" takes its limits from specs.outer; leave the search out"
                    .to_string(),
        });
    }
    if exact && (search.is_some() || file.specs.objective == Objective::Region) {
        check_starts(file)?;
    }
    if file.gains == GainForm::Scheduled
        && (search.is_some() || file.specs.objective == Objective::Region)
    {
        return Err(ModelError::Choice {
            field: "gains".to_string(),
            reason: "a search needs constant gains; it must be \"constant\"".to_string(),
        });
    }
    search.map_or(Ok(()), |search| check_limits(search, exact))
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
            return Err(ModelError::Choice { field, reason });
        }
        if state.iter().all(|&entry| entry == 0.0) {
            let reason = "the state is zero, which every set contains; name a state to be covered";
            return Err(ModelError::Choice {
                field,
                reason: reason.to_string(),
            });
        }
    }
    Ok(())
}

fn check_limits(search: &SearchFile, exact: bool) -> Result<(), ModelError> {
    let below_one = [("nu", search.nu), ("q0_min", search.q0_min)];
    for (name, range) in below_one {
        check_range(name, range, 1.0, "both in (0, 1)")?;
    }
    let positive = [
        ("phi_per_s", search.phi_per_s),
        ("rate_rad_s", search.rate_rad_s),
        ("eps_1", search.eps_1),
        ("eps_3", search.eps_3),
        ("xi_max", search.xi_max),
    ];
    for (name, range) in positive {
        check_range(name, range, f64::INFINITY, "both above 0")?;
    }
    let bounds = [
        ("gamma_max", search.gamma_max),
        ("guaranteed_gain_max", search.guaranteed_gain_max),
    ];
    for (name, bound) in bounds {
        if let Some(bound) = bound {
            check_positive(&format!("specs.search.{name}"), bound)?;
        }
    }
    if let Some(angle) = search.certified_angle_min_deg {
        let field = "specs.search.certified_angle_min_deg";
        require(angle > 0.0 && angle < 180.0, field, angle, "in (0, 180)")?;
    }
    let rounds = search.rounds;
    let ok = (1..=1000).contains(&rounds);
    require(ok, "specs.search.rounds", f64::from(rounds), "in 1 to 1000")?;
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
        Some((name, _)) => Err(ModelError::Choice {
            field: format!("specs.search.{name}"),
            reason: "only an 'exact' plant has it; leave it out".to_string(),
        }),
    }
}

fn check_range(
    name: &str,
    range: Option<[f64; 2]>,
    limit: f64,
    allowed: &str,
) -> Result<(), ModelError> {
    let Some([low, high]) = range else {
        return Ok(());
    };
    let field = format!("specs.search.{name}");
    for (index, value) in [low, high].into_iter().enumerate() {
        let field = format!("{field}[{index}]");
        check_positive(&field, value)?;
        require(value < limit, &field, value, allowed)?;
    }
    if low > high {
        return Err(ModelError::Choice {
            field,
            reason: format!("the range [{low}, {high}] is reversed; the lowest value comes first"),
        });
    }
    Ok(())
}
