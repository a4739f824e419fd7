//! The model file, as written.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bounded::{
    AngleDeg, As, BelowOne, Finite, InsideUnit, Margin, NonNegative, Percent, Positive, Ratio,
    ShortestInterval, Unit, UpToOne,
};
use super::command_trigger::CommandTriggerSpecs;
use super::imperfections::{Imperfections, TriggerFloor};
use super::objective::{Objective, OutputWeights};

/// The version this program reads and writes.
pub const MODEL_SCHEMA_VERSION: u32 = 1;

/// A plant and what its controller must achieve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModelFile {
    /// Version of this format: 1.
    pub schema_version: u32,
    /// A short name, used in reports.
    pub name: String,
    /// Where the numbers come from.
    #[serde(default)]
    pub source: String,
    /// The plant as a Takagi-Sugeno model.
    pub plant: PlantFile,
    /// What is required of the closed loop.
    pub specs: Specs,
    /// Bounds on what the loop that flies does otherwise than an ideal one; nothing when left out.
    #[serde(default, skip_serializing_if = "super::imperfections::is_none")]
    pub imperfections: Imperfections,
    /// Form of the gains.
    #[serde(default)]
    pub gains: GainForm,
    /// What is assumed about plant and controller memberships at different times.
    #[serde(default)]
    pub mismatch: Mismatch,
}

/// How the plant is given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PlantFile {
    /// The rigid spacecraft on a box of rates and attitudes: exact, 16 rules.
    Exact(ExactPlant),
    /// Vertex systems given by their matrices.
    Vertices(VerticesPlant),
    /// Local rules, blended by their memberships. The proof is about this blend.
    Rules(RulesPlant),
}

/// A rigid spacecraft; the state is [body rate (rad/s); vector part of the error quaternion].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExactPlant {
    /// Inertia matrix of a rigid body about its centre of mass, in body axes [kg m^2]: symmetric positive definite,
    /// no principal moment above the sum of the other two. Entries off the diagonal are those of the matrix, J_12 =
    /// - integral of x y dm: products of inertia with their signs reversed.
    #[serde(with = "As::<[[Finite; 3]; 3]>")]
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// How far the true inertia may be from it; known exactly when left out. The design is then proved for
    /// every inertia of the set.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia_uncertainty: Option<InertiaUncertaintyFile>,
    /// Torque limit of each axis, above 0 [N m].
    #[serde(with = "As::<[Positive; 3]>")]
    pub torque_limit_nm: [f64; 3],
    /// Bound on the norm of the disturbance torque, not negative [N m].
    #[serde(with = "As::<NonNegative>")]
    pub disturbance_bound_nm: f64,
    /// The box: bound on the magnitude of each rate, above 0 [rad/s].
    #[serde(with = "As::<[Positive; 3]>")]
    pub rate_rad_s: [f64; 3],
    /// The box: smallest scalar part q0 of the error quaternion, in (0, 1].
    #[serde(with = "As::<UpToOne>")]
    pub q0_min: f64,
    /// K of the form -(omega^x J - K omega^x) omega of the gyroscopic torque, 3 x 3 [kg m^2]: the same torque for every K,
    /// other conditions. Found by the program when left out, for the smallest gain or the largest region; 0 is the form
    /// of the paper. A design whose model leaves it out is one for 0, as are scheduled gains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[[Finite; 3]; 3]>>")]
    pub gyroscopic_form_kg_m2: Option<[[f64; 3]; 3]>,
    /// What the output y weighs, of which gain and gamma speak; the state itself when left out, and the attitude alone
    /// where the objective is `pointing`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_weights: Option<OutputWeights>,
}

/// A box of inertia matrices: each of the six entries, independently of the others, within its own
/// half-width of `inertia_kg_m2`. Every matrix of the box must be positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InertiaUncertaintyFile {
    /// Half-width of each diagonal entry, in percent of it, in [0, 100].
    #[serde(default, with = "As::<Percent>")]
    pub diagonal_percent: f64,
    /// Half-width of each off-diagonal entry, in percent of its magnitude, in [0, 100]; an entry that
    /// is 0 gets no width from it.
    #[serde(default, with = "As::<Percent>")]
    pub off_diagonal_percent: f64,
    /// Added to the half-width of each off-diagonal entry, not negative [kg m^2].
    #[serde(default, with = "As::<NonNegative>")]
    pub off_diagonal_kg_m2: f64,
}

/// x' = A(t) x + B sat(u) + B_w tau, y = C x, with A(t) in the convex hull of the state matrices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VerticesPlant {
    /// State matrices A_i, each n x n.
    pub state_matrices: Vec<Vec<Vec<f64>>>,
    /// Input matrix B, n x m.
    pub input_matrix: Vec<Vec<f64>>,
    /// Disturbance matrix B_w, n x d; B when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbance_matrix: Option<Vec<Vec<f64>>>,
    /// Output matrix C, p x n; the identity when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_matrix: Option<Vec<Vec<f64>>>,
    /// Saturation level of each input, above 0.
    #[serde(with = "As::<Vec<Positive>>")]
    pub input_limit: Vec<f64>,
    /// Bound on the norm of the disturbance, not negative.
    #[serde(with = "As::<NonNegative>")]
    pub disturbance_bound: f64,
    /// The region in which the model holds, |row x| <= bound each; everywhere when empty.
    #[serde(default, rename = "box")]
    pub region: Vec<LinearBound>,
}

/// x' = sum_i zeta_i(x) A_i x + B sat(u) + B_w tau, y = C x: rules "IF x_1 is about this AND ..., THEN
/// x' = A_i x + ...", weighted by the product of the grades of their premises, divided by its sum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RulesPlant {
    /// What the rules have in common.
    pub system: RulesSystem,
    /// The box in which the rules hold: |x_k| <= bound of each of the n states, each above 0.
    #[serde(with = "As::<Vec<Positive>>")]
    pub state_bounds: Vec<f64>,
    /// The rules. At every point of the box at least one must have a weight above 0.
    pub rules: Vec<LocalRuleFile>,
}

/// What local rules have in common.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RulesSystem {
    /// The rigid spacecraft; each rule names an `operating_point` at which A(x) is frozen.
    Spacecraft(RulesSpacecraft),
    /// Given matrices; each rule has its `state_matrix`.
    Linear(RulesLinear),
}

/// A rigid spacecraft; the state is [body rate (rad/s); vector part of the error quaternion].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RulesSpacecraft {
    /// Inertia matrix of a rigid body about its centre of mass, in body axes [kg m^2]: symmetric positive definite,
    /// no principal moment above the sum of the other two. Entries off the diagonal are those of the matrix, J_12 =
    /// - integral of x y dm: products of inertia with their signs reversed.
    #[serde(with = "As::<[[Finite; 3]; 3]>")]
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// Torque limit of each axis, above 0 [N m].
    #[serde(with = "As::<[Positive; 3]>")]
    pub torque_limit_nm: [f64; 3],
    /// Bound on the norm of the disturbance torque, not negative [N m].
    #[serde(with = "As::<NonNegative>")]
    pub disturbance_bound_nm: f64,
}

/// Input, disturbance and output matrices common to all rules.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RulesLinear {
    /// Input matrix B, n x m.
    pub input_matrix: Vec<Vec<f64>>,
    /// Disturbance matrix B_w, n x d; B when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbance_matrix: Option<Vec<Vec<f64>>>,
    /// Output matrix C, p x n; the identity when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_matrix: Option<Vec<Vec<f64>>>,
    /// Saturation level of each input, above 0.
    #[serde(with = "As::<Vec<Positive>>")]
    pub input_limit: Vec<f64>,
    /// Bound on the norm of the disturbance, not negative.
    #[serde(with = "As::<NonNegative>")]
    pub disturbance_bound: f64,
}

/// One rule; exactly one of `operating_point` and `state_matrix`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LocalRuleFile {
    /// The premises, at most one for each state; a state without one does not matter.
    #[serde(rename = "if")]
    pub premises: Vec<PremiseFile>,
    /// The state at which A(x) is frozen (spacecraft): 3 rates [rad/s], 3 vector parts with norm at
    /// most 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub operating_point: Option<Vec<f64>>,
    /// State matrix A_i, n x n (linear).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state_matrix: Option<Vec<Vec<f64>>>,
}

/// "x_state is ...".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PremiseFile {
    /// Number of the state, from 1.
    pub state: usize,
    /// The fuzzy set.
    pub is: FuzzySetFile,
}

/// A fuzzy set, in the unit of its state. Corners stand in order and are not all equal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum FuzzySetFile {
    /// 0 up to `left`, 1 at `peak`, 0 from `right` on; an end that equals the peak is a step.
    Triangular {
        /// Where the grade begins to rise.
        #[serde(with = "As::<Finite>")]
        left: f64,
        /// Where it is 1.
        #[serde(with = "As::<Finite>")]
        peak: f64,
        /// Where it is 0 again.
        #[serde(with = "As::<Finite>")]
        right: f64,
    },
    /// 0 up to `left`, 1 from `left_top` to `right_top`, 0 from `right` on.
    Trapezoidal {
        /// Where the grade begins to rise.
        #[serde(with = "As::<Finite>")]
        left: f64,
        /// Where it is first 1.
        #[serde(with = "As::<Finite>")]
        left_top: f64,
        /// Where it is last 1.
        #[serde(with = "As::<Finite>")]
        right_top: f64,
        /// Where it is 0 again.
        #[serde(with = "As::<Finite>")]
        right: f64,
    },
    /// exp(-((x - centre) / width)^2 / 2).
    Gaussian {
        /// Where the grade is 1.
        #[serde(with = "As::<Finite>")]
        centre: f64,
        /// Standard deviation, above 0.
        #[serde(with = "As::<Positive>")]
        width: f64,
    },
}

/// |row x| <= bound.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LinearBound {
    /// Row, n entries.
    pub row: Vec<f64>,
    /// Bound, above 0.
    #[serde(with = "As::<Positive>")]
    pub bound: f64,
}

/// Requirements and design parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Specs {
    /// Decay rate phi of the Lyapunov functional, above 0 [1/s].
    #[serde(with = "As::<Positive>")]
    pub phi_per_s: f64,
    /// Longest sampling interval, above 0 (s).
    #[serde(with = "As::<Positive>")]
    pub hbar_s: f64,
    /// Shortest sampling interval, above 0 and at most `hbar_s` (s); unknown when left out: the proof does not need
    /// it, and nothing is then said of the number of messages.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<ShortestInterval>>")]
    pub hmin_s: Option<f64>,
    /// Largest trigger threshold nu, in [0, 1).
    #[serde(with = "As::<BelowOne>")]
    pub nu: f64,
    /// Absolute part of the trigger, not negative, in units of the Lyapunov function; or "auto": from the bounds on the
    /// measurement, so that their errors alone send few messages. 0 when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trigger_floor: Option<TriggerFloor>,
    /// Smallest trigger threshold, at most nu; nu when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<BelowOne>>")]
    pub nu_min: Option<f64>,
    /// How the threshold moves between its bounds; it stays at nu when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub threshold_update: Option<ThresholdUpdate>,
    /// Weights eps_1, eps_2, eps_3 of the multiplier; the second above 0.
    #[serde(default = "unit_weights", with = "As::<[Finite; 3]>")]
    pub eps: [f64; 3],
    /// Largest disturbance weight xi, above 0; when left out, whatever keeps xi taubar^2 within phi. A larger one
    /// would gain nothing.
    #[serde(default = "unlimited", skip_serializing_if = "is_unlimited")]
    #[serde(with = "As::<Positive>")]
    pub xi_max: f64,
    /// What is optimised.
    #[serde(default)]
    pub objective: Objective,
    /// The gain to be proved, above 0, in the place of the smallest: of the objective gain the guaranteed gain, of
    /// the objective gamma the bound gamma.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub gamma: Option<f64>,
    /// Largest such gain that is accepted, above 0; the smallest is sought.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub gamma_max: Option<f64>,
    /// States x0 that the certified set must contain, each of n entries.
    #[serde(default)]
    pub must_contain: Vec<Vec<f64>>,
    /// The larger set of a design with two certificates; only with an `exact` plant and a constant gain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outer: Option<OuterSpecs>,
    /// The proof of given gains that come with a trigger on the command.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command_trigger: Option<CommandTriggerSpecs>,
    /// What a search may vary, and between which limits; with the objective gain and without it nothing is
    /// searched.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub search: Option<SearchFile>,
    /// Margin of every strict inequality in scaled units, in (0, 0.01].
    #[serde(default = "default_margin", with = "As::<Margin>")]
    pub margin: f64,
}

/// The update rule below (10): mu = (mu_1, mu_2, mu_3), each not negative.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ThresholdUpdate {
    /// mu_1, mu_2, mu_3.
    #[serde(with = "As::<[NonNegative; 3]>")]
    pub mu: [f64; 3],
}

/// Form of the gains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GainForm {
    /// One gain for all rules: no membership is needed at run time.
    #[default]
    Constant,
    /// One gain for each rule, weighted by the memberships of the state sent last. It needs `exact`
    /// or `rules` and a mismatch `kappa`: without that bound it can never beat a constant gain.
    Scheduled,
}

/// What is assumed about memberships of plant and controller.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mismatch {
    /// Nothing: a constant gain does not depend on memberships.
    #[default]
    None,
    /// Bound kappa on |zeta_i(t) - zeta_i(t_k)| of every rule i, in [0, 1]. Assumed, not proved.
    #[serde(with = "As::<Unit>")]
    Kappa(f64),
}

fn unit_weights() -> [f64; 3] {
    [1.0; 3]
}

/// No limit of its own.
fn unlimited() -> f64 {
    f64::INFINITY
}

fn is_unlimited(value: &f64) -> bool {
    value.is_infinite()
}

fn default_margin() -> f64 {
    1e-6
}

/// What the large-set certificate of the objective `both` is for: the same controller on a larger box. The
/// rest (limits, sampling, threshold, multiplier weights) is that of the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OuterSpecs {
    /// Decay rate phi of the large-set functional, above 0 [1/s].
    #[serde(with = "As::<Positive>")]
    pub phi_per_s: f64,
    /// The box of the large set: bound on the magnitude of each rate, above 0 [rad/s].
    #[serde(with = "As::<[Positive; 3]>")]
    pub rate_rad_s: [f64; 3],
    /// The box of the large set: smallest scalar part q0 of the error quaternion, in (0, 1].
    #[serde(with = "As::<UpToOne>")]
    pub q0_min: f64,
    /// Largest disturbance weight xi of the large-set certificate, above 0; when left out, whatever keeps
    /// xi taubar^2 within phi.
    #[serde(default = "unlimited", skip_serializing_if = "is_unlimited")]
    #[serde(with = "As::<Positive>")]
    pub xi_max: f64,
    /// States x0 that the large set must contain, each of 6 entries; at least one.
    pub must_contain: Vec<Vec<f64>>,
    /// Size of the inner set over that of the large one, in (0, 1]; searched when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Ratio>>")]
    pub inner_scale: Option<f64>,
    /// Weight rho of the containment condition in scaled units, above 0; searched when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub containment_weight: Option<f64>,
}

/// Limits of a search: [lowest, highest] each. What the model gives (phi, nu, the box) stays as it is where no
/// range is given; the multiplier weights eps and xi up to xi_max, which only the proof needs, are then free.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SearchFile {
    /// Decay rate phi [1/s]; fixed when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[Positive; 2]>>")]
    pub phi_per_s: Option<[f64; 2]>,
    /// Trigger threshold nu, in (0, 1); fixed when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[InsideUnit; 2]>>")]
    pub nu: Option<[f64; 2]>,
    /// The box of a spacecraft: bound on the rate about each axis [rad/s]; fixed when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[Positive; 2]>>")]
    pub rate_rad_s: Option<[f64; 2]>,
    /// The box of a spacecraft: smallest scalar part q0, in (0, 1); fixed when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[InsideUnit; 2]>>")]
    pub q0_min: Option<[f64; 2]>,
    /// Multiplier weight eps_1, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[Positive; 2]>>")]
    pub eps_1: Option<[f64; 2]>,
    /// Multiplier weight eps_3, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[Positive; 2]>>")]
    pub eps_3: Option<[f64; 2]>,
    /// Largest disturbance weight xi; up to the model's xi_max when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<[Positive; 2]>>")]
    pub xi_max: Option<[f64; 2]>,
    /// Largest gain bound gamma that is accepted, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub gamma_max: Option<f64>,
    /// Largest guaranteed gain that is accepted, above 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<Positive>>")]
    pub guaranteed_gain_max: Option<f64>,
    /// Every attitude at rest up to this angle, in (0, 180), must be in the certified set (deg). Spacecraft only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(with = "As::<Option<AngleDeg>>")]
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
