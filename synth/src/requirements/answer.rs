//! What is proved of a design, requirement by requirement.

use serde::Serialize;

use super::facts::Facts;
use crate::certify::reach::{angle_above_vector_part_deg, angle_of_vector_part_deg};
use crate::design::{settling_time, DesignFile};
use crate::model::{Model, PlantFile};

/// What is proved of a design, in an engineer's units; each number on the safe side.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Achieved {
    /// Pointing error from rest, and in the end from every certified start (deg).
    pub pointing_deg: f64,
    /// Time from every certified start until the pointing error stays within what is required (s); infinite where that is
    /// not required or not proved.
    pub settle_s: f64,
    /// Whether every certified start comes under the certificate that bounds the pointing error in the end.
    pub is_handed_over: bool,
    /// Every attitude at rest up to this angle is a certified start (deg).
    pub certified_angle_deg: f64,
    /// Rate about each axis at all times [rad/s].
    pub rate_rad_s: f64,
    /// Samples per second; messages are no more.
    pub messages_per_s: f64,
}

/// A requirement with its proved value.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answered {
    /// Its key.
    pub requirement: &'static str,
    /// What is required.
    pub required: f64,
    /// What is proved.
    pub proved: f64,
    /// Whether larger is better.
    #[serde(skip)]
    pub at_least: bool,
}

impl Answered {
    /// Whether the proved value is as good as required.
    pub fn is_met(&self) -> bool {
        match self.at_least {
            true => self.proved >= self.required,
            false => self.proved <= self.required,
        }
    }

    /// 1 where the proved value is just as required, more where it is better.
    pub fn fraction(&self) -> f64 {
        match self.at_least {
            true => self.proved / self.required,
            false => self.required / self.proved,
        }
    }
}

impl Achieved {
    /// From the numbers of a proved design, and the pointing error that is required (deg).
    pub fn of(file: &DesignFile, model: &Model, required_deg: Option<f64>) -> Self {
        let own = &file.certificate;
        let large = file.outer.as_ref().map(|outer| &outer.certificate);
        let large = large.unwrap_or(own);
        let specs = &file.model.specs;
        let limits = match (&specs.outer, &file.model.plant) {
            (Some(outer), _) => outer.rate_rad_s,
            (None, PlantFile::Exact(exact)) => exact.rate_rad_s,
            _ => [f64::INFINITY; 3],
        };
        let angle = large.certified_vector_part.map(angle_of_vector_part_deg);
        // Without a hand-over the small set's bound holds for its own starts only.
        let outer = file.outer.as_ref();
        let is_handed_over = outer.is_none_or(|outer| outer.hand_over.is_some());
        let last = if is_handed_over { own } else { large };
        let bounds = last.final_bounds.as_ref();
        let settle = required_deg.and_then(|angle| settling_time(file, model, angle));
        Achieved {
            settle_s: settle.unwrap_or(f64::INFINITY),
            is_handed_over,
            pointing_deg: bounds.map_or(180.0, |bounds| {
                angle_above_vector_part_deg(bounds.vector_part)
            }),
            certified_angle_deg: angle.unwrap_or(0.0),
            rate_rad_s: limits.into_iter().fold(0.0, f64::max),
            messages_per_s: 1.0 / specs.hmin_s.unwrap_or(0.0),
        }
    }

    /// Each requirement of the facts with what is proved of it.
    pub fn answers(&self, facts: &Facts) -> Vec<Answered> {
        let own = &facts.file.requirements;
        let one = |requirement, required: Option<f64>, proved, at_least| {
            required.map(|required| Answered {
                requirement,
                required,
                proved,
                at_least,
            })
        };
        let all = [
            one("pointing_deg", own.pointing_deg, self.pointing_deg, false),
            one("settle_s", own.settle_s, self.settle_s, false),
            one("rate_rad_s", own.rate_rad_s, self.rate_rad_s, false),
            one(
                "certified_angle_deg",
                own.certified_angle_deg,
                self.certified_angle_deg,
                true,
            ),
            one(
                "messages_per_s",
                own.messages_per_s,
                self.messages_per_s,
                false,
            ),
        ];
        all.into_iter().flatten().collect()
    }
}
