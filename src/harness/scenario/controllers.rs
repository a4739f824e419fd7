//! The checked controllers of a scenario.

use nalgebra::{Matrix3x6, Matrix6, Vector3, Vector6};
use runtime::trigger::{Adaptation, ThresholdUpdate};
use runtime::{lei2022, wu2018};
use synth::model::{check_matrix, check_positive, check_positive_definite, finite, ModelError};

use super::check::{each, not_negative, require};
use super::controller_file::{
    ClaimFile, ControllerFile, ThresholdFile, WuFile, WuGainsFile, WuTriggerFile, XuFile,
};
use super::lei::lei2022;
use super::systems::System;

/// Most rules of a fuzzy controller.
pub const MAX_RULES: usize = 8;

/// The controller of a scenario.
#[derive(Debug, Clone)]
pub enum ControllerChoice {
    /// That of a design file, by the path in the scenario if there is one.
    Design(Option<String>),
    /// Wu, Shen and Cao 2018.
    Wu(wu2018::Parameters),
    /// Xu and Huang 2020 with given gains.
    Xu(Box<XuChoice>),
    /// Lei et al. 2022.
    Lei(Box<lei2022::Parameters>),
}

/// Xu and Huang's controller with given gains.
#[derive(Debug, Clone)]
pub struct XuChoice {
    /// Centre and gain of each rule.
    pub rules: Vec<(Vector6<f64>, Matrix3x6<f64>)>,
    /// Widths of the memberships.
    pub widths: Vector6<f64>,
    /// Upsilon.
    pub trigger_weight: Matrix6<f64>,
    /// Evolution of the threshold.
    pub threshold: ThresholdUpdate,
    /// Torque limit, N m.
    pub torque_limit: Vector3<f64>,
    /// Longest sampling interval of the design, s.
    pub longest_interval_s: Option<f64>,
    /// What the paper claims.
    pub claim: Option<ClaimFile>,
}

impl ControllerChoice {
    /// Torque limit of each axis, N m, where the scenario gives it.
    pub fn torque_limit(&self) -> Option<Vector3<f64>> {
        match self {
            ControllerChoice::Design(_) => None,
            ControllerChoice::Wu(parameters) => Some(parameters.torque_limit),
            ControllerChoice::Xu(choice) => Some(choice.torque_limit),
            ControllerChoice::Lei(parameters) => Some(parameters.torque_limit),
        }
    }

    /// Whether the torque changes at every sample, so that there is no trigger to watch.
    pub(super) fn sends_every_sample(&self) -> bool {
        match self {
            ControllerChoice::Wu(parameters) => {
                parameters.trigger == wu2018::TriggerRule::EverySample
            }
            ControllerChoice::Lei(parameters) => {
                parameters.trigger == lei2022::TriggerRule::EverySample
            }
            ControllerChoice::Design(_) | ControllerChoice::Xu(_) => false,
        }
    }
}

/// Checks the controller of a file.
pub(super) fn check_controller(
    file: &ControllerFile,
    system: &System,
) -> Result<ControllerChoice, ModelError> {
    match (file, system) {
        (ControllerFile::Design(design), _) => Ok(ControllerChoice::Design(design.file.clone())),
        (ControllerFile::Wu2018(wu), System::RigidBody(body)) => {
            let inertia = body.body.inertia().symmetric_eigenvalues().max();
            let parameters = wu2018(wu, inertia).map_err(|e| e.within("controller.wu2018"))?;
            Ok(ControllerChoice::Wu(parameters))
        }
        (ControllerFile::Xu2020(xu), System::RigidBody(_)) => {
            let choice = xu2020(xu).map_err(|error| error.within("controller.xu2020"))?;
            Ok(ControllerChoice::Xu(Box::new(choice)))
        }
        (ControllerFile::Lei2022(lei), System::RigidBody(body)) => {
            let parameters = lei2022(lei, body).map_err(|e| e.within("controller.lei2022"))?;
            Ok(ControllerChoice::Lei(Box::new(parameters)))
        }
        (_, System::TakagiSugeno(_)) => Err(ModelError::WrongShape {
            field: "controller".to_string(),
            found: "an attitude controller".to_string(),
            expected: "design, because system is takagi_sugeno".to_string(),
        }),
    }
}

fn wu2018(file: &WuFile, plant_inertia: f64) -> Result<wu2018::Parameters, ModelError> {
    each("torque_limit_nm", &file.torque_limit_nm, check_positive)?;
    let trigger = match &file.trigger {
        WuTriggerFile::EverySample(_) => wu2018::TriggerRule::EverySample,
        WuTriggerFile::Relative(rule) => {
            let ok = rule.relative > 0.0 && rule.relative < 1.0;
            require(ok, "trigger.relative.relative", rule.relative, "in (0, 1)")?;
            check_positive("trigger.relative.absolute_rad_s", rule.absolute_rad_s)?;
            wu2018::TriggerRule::Relative {
                relative: rule.relative,
                absolute_rad_s: rule.absolute_rad_s,
            }
        }
    };
    let unwinding = match file.shortest_rotation_hysteresis {
        None => wu2018::Unwinding::AsPublished,
        Some(hysteresis) => {
            let ok = (0.0..1.0).contains(&hysteresis);
            require(ok, "shortest_rotation_hysteresis", hysteresis, "in [0, 1)")?;
            wu2018::Unwinding::ShortestRotation { hysteresis }
        }
    };
    Ok(wu2018::Parameters {
        gains: wu_gains(&file.gains, plant_inertia)?,
        trigger,
        torque_limit: Vector3::from(file.torque_limit_nm),
        unwinding,
    })
}

fn wu_gains(file: &WuGainsFile, plant_inertia: f64) -> Result<wu2018::Gains, ModelError> {
    match file {
        WuGainsFile::Direct(direct) => {
            check_positive(
                "gains.direct.error_gain_nm_s_rad",
                direct.error_gain_nm_s_rad,
            )?;
            check_positive(
                "gains.direct.attitude_weight_rad_s",
                direct.attitude_weight_rad_s,
            )?;
            Ok(wu2018::Gains {
                error_gain: direct.error_gain_nm_s_rad,
                attitude_weight: direct.attitude_weight_rad_s,
            })
        }
        WuGainsFile::SettlingTime(settling) => {
            let field = "gains.settling_time";
            let inertia = settling.largest_inertia_kg_m2.unwrap_or(plant_inertia);
            check_positive(
                &format!("{field}.settling_time_s"),
                settling.settling_time_s,
            )?;
            check_positive(&format!("{field}.damping_ratio"), settling.damping_ratio)?;
            check_positive(&format!("{field}.largest_inertia_kg_m2"), inertia)?;
            let gains = wu2018::Gains::from_settling_time(
                inertia,
                settling.damping_ratio,
                settling.settling_time_s,
            );
            gains.map_err(|_| ModelError::OutOfRange {
                field: field.to_string(),
                value: inertia,
                allowed: "above 0".to_string(),
            })
        }
    }
}

fn xu2020(file: &XuFile) -> Result<XuChoice, ModelError> {
    let count = file.rules.len();
    if !(1..=MAX_RULES).contains(&count) {
        return Err(ModelError::WrongShape {
            field: "rules".to_string(),
            found: format!("{count} rules"),
            expected: format!("1 to {MAX_RULES} rules"),
        });
    }
    let mut rules = Vec::new();
    for (index, rule) in file.rules.iter().enumerate() {
        each(&format!("rules[{index}].centre"), &rule.centre, finite)?;
        for (row, gains) in rule.gain.iter().enumerate() {
            each(&format!("rules[{index}].gain[{row}]"), gains, finite)?;
        }
        let gain = Matrix3x6::from_fn(|r, c| rule.gain[r][c]);
        rules.push((Vector6::from(rule.centre), gain));
    }
    each("widths", &file.widths, check_positive)?;
    each("torque_limit_nm", &file.torque_limit_nm, check_positive)?;
    if let Some(interval) = file.longest_interval_s {
        check_positive("longest_interval_s", interval)?;
    }
    if let Some(claim) = &file.published_claim {
        check_positive("published_claim.gain_bound", claim.gain_bound)?;
        check_positive("published_claim.decay_rate_per_s", claim.decay_rate_per_s)?;
        check_positive(
            "published_claim.membership_mismatch",
            claim.membership_mismatch,
        )?;
    }
    Ok(XuChoice {
        rules,
        widths: Vector6::from(file.widths),
        trigger_weight: weight(&file.trigger_weight)?,
        threshold: threshold(&file.threshold)?,
        torque_limit: Vector3::from(file.torque_limit_nm),
        longest_interval_s: file.longest_interval_s,
        claim: file.published_claim.clone(),
    })
}

fn weight(rows: &[[f64; 6]; 6]) -> Result<Matrix6<f64>, ModelError> {
    let field = "trigger_weight";
    let rows_as_lists: Vec<Vec<f64>> = rows.iter().map(|row| row.to_vec()).collect();
    let matrix = check_matrix(field, &rows_as_lists, (Some(6), Some(6)))?;
    check_positive_definite(field, &matrix)?;
    Ok(Matrix6::from_fn(|r, c| rows[r][c]))
}

fn threshold(file: &ThresholdFile) -> Result<ThresholdUpdate, ModelError> {
    let in_range =
        |field: &str, value: f64| require((0.0..1.0).contains(&value), field, value, "in [0, 1)");
    match file {
        ThresholdFile::Fixed(fixed) => {
            in_range("threshold.fixed.nu", fixed.nu)?;
            Ok(ThresholdUpdate::Fixed {
                threshold: fixed.nu,
            })
        }
        ThresholdFile::Clamped(clamped) => {
            in_range("threshold.clamped.nu_min", clamped.nu_min)?;
            in_range("threshold.clamped.nu_max", clamped.nu_max)?;
            let ok = clamped.nu_min <= clamped.nu_max;
            require(
                ok,
                "threshold.clamped.nu_max",
                clamped.nu_max,
                "nu_min or above",
            )?;
            Ok(ThresholdUpdate::Clamped {
                adaptation: adaptation("threshold.clamped.mu", &clamped.mu)?,
                minimum: clamped.nu_min,
                maximum: clamped.nu_max,
            })
        }
        ThresholdFile::UnclampedAsPublished(printed) => {
            in_range("threshold.unclamped_as_published.nu_min", printed.nu_min)?;
            Ok(ThresholdUpdate::UnclampedAsPublished {
                adaptation: adaptation("threshold.unclamped_as_published.mu", &printed.mu)?,
                minimum: printed.nu_min,
            })
        }
    }
}

fn adaptation(field: &str, mu: &[f64; 3]) -> Result<Adaptation, ModelError> {
    each(field, mu, not_negative)?;
    let [amplitude, slope, dead_band] = *mu;
    Ok(Adaptation {
        amplitude,
        slope,
        dead_band,
    })
}
