//! What a search may vary, as written in a model file.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::file::{GainForm, ModelFile, Objective, PlantFile};
use super::validate::{check_positive, require};
use super::ModelError;

/// Limits of a search: [lowest, highest] each. What is required of the closed loop (phi, nu) stays as it is
/// where it is left out; what only the proof needs (the box, eps, xi up to xi_max) is then free.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchFile {
    /// Decay rate phi [1/s]; fixed when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phi_per_s: Option<[f64; 2]>,
    /// Trigger threshold nu, in (0, 1); fixed when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nu: Option<[f64; 2]>,
    /// The box of a spacecraft: bound on the rate about each axis [rad/s].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_rad_s: Option<[f64; 2]>,
    /// The box of a spacecraft: smallest scalar part q0, in (0, 1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub q0_min: Option<[f64; 2]>,
    /// Multiplier weight eps_1, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub eps_1: Option<[f64; 2]>,
    /// Multiplier weight eps_3, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub eps_3: Option<[f64; 2]>,
    /// Largest disturbance weight xi; up to the model's xi_max when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub xi_max: Option<[f64; 2]>,
    /// Largest gain bound gamma that is accepted, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gamma_max: Option<f64>,
    /// Largest guaranteed gain that is accepted, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub guaranteed_gain_max: Option<f64>,
    /// Every attitude at rest up to this angle, in (0, 180), must be in the certified set (deg). Spacecraft only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certified_angle_min_deg: Option<f64>,
    /// Most rounds, in 1 to 1000; each solves two programs.
    #[serde(default = "default_rounds")]
    pub rounds: u32,
}

impl SearchFile {
    /// No limits but the usual ones.
    pub fn unlimited() -> Self {
        SearchFile {
            rounds: default_rounds(),
            ..SearchFile::default()
        }
    }
}

fn default_rounds() -> u32 {
    40
}

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
