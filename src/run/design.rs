//! A design on a scenario: does it fit, and does its proof cover the run?

use nalgebra::{Matrix3, Vector3};
use runtime::trigger::{Adaptation, ThresholdUpdate};
use synth::certify::reach::angle_of_vector_part_deg;
use synth::certify::theorem1::Certificate;
use synth::certify::{Report, Verdict};
use synth::design::{prove, DesignFile, LargeSetCertificate};
use synth::fuzzy::{ExactSpacecraft, INERTIA_ENTRIES};
use synth::model::{FileError, Model, Plant, Specs};

use crate::base::number::precise;
use crate::base::provenance::sha256_of;
use crate::plants::rigid_body::RigidBodySystem;
use crate::plants::takagi_sugeno::TakagiSugenoSystem;
use crate::plants::{Mixing, RigidBody, System};
use crate::scenario::Scenario;
use crate::sim::sampling::Instants;

/// A design file, checked.
#[derive(Debug, Clone)]
pub struct Design {
    /// The file.
    pub file: DesignFile,
    /// The model inside it.
    pub model: Model,
    /// Its numbers.
    pub certificate: Certificate,
    /// The outer certificate with its model, where there are two; the numbers above are then the inner
    /// one's.
    pub outer: Option<LargeSetCertificate>,
    /// The outcome of the check, made from the file's numbers.
    pub report: Report,
    /// SHA-256 of the file's text, in hexadecimal.
    pub sha256: String,
}

/// Why a design cannot be used in a scenario.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Another kind of plant.
    #[error("the design is for {design}; the scenario's system is {scenario}")]
    Kind {
        /// What the design controls.
        design: String,
        /// What the scenario has.
        scenario: String,
    },
    /// Another size.
    #[error(
        "the design has {design_states} states and {design_inputs} inputs; the scenario's system \
         has {states} states and {inputs} inputs"
    )]
    Size {
        /// States of the design.
        design_states: usize,
        /// Inputs of the design.
        design_inputs: usize,
        /// States of the system.
        states: usize,
        /// Inputs of the system.
        inputs: usize,
    },
    /// A body far from the model's.
    #[error(
        "the scenario's moments of inertia are {} to {} times those of the design's model; a design is \
         run on plants from {allowed_smallest} to {allowed_largest} times",
        precise(*smallest), precise(*largest)
    )]
    Inertia {
        /// Smallest ratio over all axes.
        smallest: f64,
        /// Largest ratio over all axes.
        largest: f64,
        /// Smallest ratio allowed.
        allowed_smallest: f64,
        /// Largest ratio allowed.
        allowed_largest: f64,
    },
}

/// A design that proves something about its gains but is no law that can be run: how they are weighted at a
/// state is not known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "the design has {gains} gains for a model with {rules} rules: how they are mixed is not known, so it is no \
     controller that can be run"
)]
pub struct NoLaw {
    /// Gains of the design.
    pub gains: usize,
    /// Rules whose memberships the model states.
    pub rules: usize,
}

/// Ratios of moments of inertia, plant to model, at which a design is still tried.
const INERTIA_RATIOS: [f64; 2] = [0.5, 2.0];

/// Ratio from which on the plant is another one than the model.
const INERTIA_ROUNDING: f64 = 1e-12;

impl Design {
    /// Reads a design file and proves it from its numbers.
    ///
    /// # Errors
    /// A file that is not a valid design.
    pub fn from_json(text: &str) -> Result<Self, FileError> {
        let (file, model) = DesignFile::from_json(text)?;
        let certificate = file.certificate(&model)?;
        let outer = file.large_set_certificate(&model)?;
        let report = prove(&model, &certificate, outer.as_ref());
        Ok(Self {
            file,
            model,
            outer,
            certificate,
            report,
            sha256: sha256_of(text),
        })
    }

    /// True when every condition is proved.
    pub fn proved(&self) -> bool {
        self.report.verdict == Verdict::Proved
    }

    /// Number of gains of the law: one, or one for each rule of the model.
    ///
    /// # Errors
    /// Gains without memberships.
    pub fn law_gains(&self) -> Result<usize, NoLaw> {
        let gains = self.certificate.gain_count();
        let rules = self.model.plant.membership_count().unwrap_or(0);
        match gains == 1 || gains == rules {
            true => Ok(gains),
            false => Err(NoLaw { gains, rules }),
        }
    }

    /// The name of the law, and its torque limits, N m (inputs of another plant).
    pub fn law(&self) -> (String, Vec<f64>) {
        let name = format!(
            "design '{}': Xu and Huang 2020, law (12) and trigger (10)",
            self.file.name
        );
        let limit = self.model.plant.takagi_sugeno().input_limit;
        (name, limit.as_slice().to_vec())
    }

    /// Refuses a design that is made for another plant.
    ///
    /// # Errors
    /// The difference, with its numbers.
    pub fn check_fit(&self, system: &System) -> Result<(), FitError> {
        let (design_states, design_inputs, _, _) = self.model.plant.sizes();
        let spacecraft = || "a rigid spacecraft (6 states, 3 inputs)".to_string();
        let fuzzy = |states: usize, inputs: usize| {
            format!("a Takagi-Sugeno model ({states} states, {inputs} inputs)")
        };
        match (self.model.plant.inertia(), system) {
            (Some(inertia), System::RigidBody(body)) => {
                let [smallest, largest] = inertia_ratios(&body.body, inertia);
                let [allowed_smallest, allowed_largest] = INERTIA_RATIOS;
                let fits = smallest >= allowed_smallest && largest <= allowed_largest;
                fits.then_some(()).ok_or(FitError::Inertia {
                    smallest,
                    largest,
                    allowed_smallest,
                    allowed_largest,
                })
            }
            (None, System::TakagiSugeno(model)) => {
                let (states, inputs) = model.system.input_matrix.shape();
                let fits = (states, inputs) == (design_states, design_inputs);
                fits.then_some(()).ok_or(FitError::Size {
                    design_states,
                    design_inputs,
                    states,
                    inputs,
                })
            }
            (Some(_), System::TakagiSugeno(model)) => {
                let (states, inputs) = model.system.input_matrix.shape();
                Err(FitError::Kind {
                    design: spacecraft(),
                    scenario: fuzzy(states, inputs),
                })
            }
            (None, System::RigidBody(_)) => Err(FitError::Kind {
                design: fuzzy(design_states, design_inputs),
                scenario: spacecraft(),
            }),
        }
    }

    /// What of the scenario the proof does not cover, known before the run. What the model's imperfections may allow is
    /// compared with the run itself: see `run::imperfections`.
    pub fn not_covered(&self, scenario: &Scenario) -> Vec<String> {
        let mut out = Vec::new();
        if !self.proved() {
            out.push("the design is not proved".to_string());
        }
        let hbar = self.model.file.specs.hbar_s;
        match scenario.instants {
            Instants::Continuous { .. } => out.push(format!(
                "the trigger is watched continuously; the proof is for samples at most {hbar} s apart"
            )),
            _ => {
                if let Some(longest) = scenario.instants.longest_interval_s() {
                    if longest > hbar {
                        out.push(format!(
                            "samples are up to {longest} s apart; the proof allows {hbar} s"
                        ));
                    }
                }
            }
        }
        if scenario.dropout_probability > 0.0 {
            out.push(format!(
                "samples are lost (probability {}), so gaps may exceed {hbar} s",
                scenario.dropout_probability
            ));
        }
        if scenario.link.is_some() {
            out.push("the actuators get the torque over a link, not as commanded".to_string());
        }
        match (&self.model.plant, &scenario.system) {
            (Plant::Spacecraft(craft), System::RigidBody(body)) => {
                match self.model.plant.has_uncertain_inertia() {
                    true => out.extend(outside_inertia_set(craft, &body.body)),
                    false => out.extend(another_inertia(&craft.inertia, &body.body)),
                }
                rigid_body_not_covered(&craft.torque_limit, body, &mut out);
            }
            (Plant::Vertices(system), System::TakagiSugeno(model)) => {
                vertices_not_covered(system, model, &mut out);
            }
            (Plant::Rules(rules), System::TakagiSugeno(model)) => {
                vertices_not_covered(&rules.system, model, &mut out);
                let blend = matches!(model.mixing, Mixing::Model);
                if self.certificate.is_matched(&self.model) && !blend {
                    out.push(
                        "the plant's rules are not weighted by the model's memberships".into(),
                    );
                }
            }
            (Plant::Rules(rules), System::RigidBody(body)) => {
                let limits = rules.system.input_limit.as_slice();
                let limits = Vector3::from_column_slice(limits);
                if let Some(inertia) = self.model.plant.inertia() {
                    out.extend(another_inertia(inertia, &body.body));
                    rigid_body_not_covered(&limits, body, &mut out);
                }
                out.push(
                    "the plant is the rigid spacecraft; the proof is for the blend of the local rules"
                        .into(),
                );
            }
            _ => out.push("the design is for another kind of plant".to_string()),
        }
        out
    }
}

/// The trigger's threshold as a model's specifications have it; never above the proved one.
pub fn threshold_update(specs: &Specs) -> ThresholdUpdate {
    match &specs.threshold_update {
        None => ThresholdUpdate::Fixed {
            threshold: specs.nu,
        },
        Some(update) => {
            let [amplitude, slope, dead_band] = update.mu;
            ThresholdUpdate::Clamped {
                adaptation: Adaptation {
                    amplitude,
                    slope,
                    dead_band,
                },
                minimum: specs.nu_min.unwrap_or(specs.nu),
                maximum: specs.nu,
            }
        }
    }
}

/// Smallest and largest ratio of the moments of inertia about one axis, over all axes: the
/// generalised eigenvalues of the two matrices.
fn inertia_ratios(body: &RigidBody, model: &Matrix3<f64>) -> [f64; 2] {
    let Some(factor) = model.cholesky() else {
        return [0.0, f64::INFINITY];
    };
    let Some(inverse) = factor.l().try_inverse() else {
        return [0.0, f64::INFINITY];
    };
    let ratios = (inverse * body.inertia() * inverse.transpose()).symmetric_eigenvalues();
    [ratios.min(), ratios.max()]
}

fn another_inertia(inertia: &Matrix3<f64>, body: &RigidBody) -> Option<String> {
    let [smallest, largest] = inertia_ratios(body, inertia);
    let other = smallest < 1.0 - INERTIA_ROUNDING || largest > 1.0 + INERTIA_ROUNDING;
    other.then(|| {
        format!(
            "the plant's moments of inertia are {} to {} times the model's",
            precise(smallest),
            precise(largest)
        )
    })
}

/// The entry of the plant's inertia that is farthest outside of the set that the proof is for.
fn outside_inertia_set(craft: &ExactSpacecraft, body: &RigidBody) -> Option<String> {
    let (nominal, inertia) = (&craft.inertia, body.inertia());
    let beyond = |entry: (usize, usize)| {
        let width = craft.inertia_uncertainty.half_width(nominal, entry);
        (inertia[entry] - nominal[entry]).abs() - width
    };
    let worst = INERTIA_ENTRIES
        .into_iter()
        .max_by(|&a, &b| beyond(a).total_cmp(&beyond(b)))?;
    let outside = beyond(worst) > INERTIA_ROUNDING * nominal.amax();
    outside.then(|| {
        let width = craft.inertia_uncertainty.half_width(nominal, worst);
        format!(
            "the plant's inertia is outside of the set that the proof is for: entry ({}, {}) is {} \
             kg m^2, the set has {} to {}",
            worst.0 + 1,
            worst.1 + 1,
            precise(inertia[worst]),
            precise(nominal[worst] - width),
            precise(nominal[worst] + width)
        )
    })
}

fn rigid_body_not_covered(
    torque_limit: &Vector3<f64>,
    system: &RigidBodySystem,
    out: &mut Vec<String>,
) {
    let actuators = &system.actuators;
    for axis in 0..3 {
        let (limit, model) = (actuators.limit[axis], torque_limit[axis]);
        if limit < model {
            out.push(format!(
                "the torque limit of axis {} is {limit} N m; the proof is for {model} N m",
                axis + 1
            ));
        }
    }
    let dead_band = actuators.dead_band.amax();
    if dead_band > 0.0 {
        out.push(format!("a dead band of up to {dead_band} N m"));
    }
}

fn vertices_not_covered(
    design: &synth::fuzzy::VertexSystem,
    scenario: &TakagiSugenoSystem,
    out: &mut Vec<String>,
) {
    let plant = &scenario.system;
    let same = plant.state_matrices == design.state_matrices
        && plant.input_matrix == design.input_matrix
        && plant.disturbance_matrix == design.disturbance_matrix;
    if !same {
        out.push("the plant's vertex systems are not the model's".to_string());
    }
    let limits = plant.input_limit.iter().zip(design.input_limit.iter());
    for (input, (limit, model)) in limits.enumerate() {
        if limit < model {
            out.push(format!(
                "the limit of input {} is {limit}; the proof is for {model}",
                input + 1
            ));
        }
    }
}

/// Angle of the largest rotation at rest that is in the certified set, about any axis, rounded down, deg.
pub fn certified_angle_deg(vector_part: Option<f64>) -> Option<f64> {
    vector_part.map(angle_of_vector_part_deg)
}
