//! The conditions of Lei, Meng, Wang, Wang and Jin 2022, one function each, in the order of the paper:
//! section V-C, those of its proofs, and the bounds (69) and (80) on the times between events.

use super::bounds::{Bounds, Case, FUNNEL_USE};
use crate::base::condition::Condition;
use crate::base::condition::Origin::{Found, Paper, PaperCorrected};
use crate::base::condition::Relation::{Above, AtLeast};

/// Evaluates every condition.
pub fn conditions(case: &Case) -> Vec<Condition> {
    let bounds = Bounds::new(case);
    let all: [fn(&Case, &Bounds) -> Condition; 14] = [
        saturation_gain,
        virtual_rate,
        first_layer_decays,
        disturbance_compensated,
        second_layer_decays,
        lyapunov_faster_than_envelope,
        first_layer_faster_than_envelope,
        start_above_residual,
        envelope_above_start,
        envelope_above_residual,
        funnel_above_rate_error,
        on_time_at_the_start,
        on_time_in_the_end,
        off_time,
    ];
    all.iter()
        .map(|condition| condition(case, &bounds))
        .collect()
}

const SECTION: &str = "V-C";

/// Property 1, used in (17): k_m tanh(gamma x) >= x on [0, k_u]. The left side is concave, so it is
/// enough at k_u.
fn saturation_gain(case: &Case, _: &Bounds) -> Condition {
    let law = &case.law.virtual_law;
    let left = law.gain * (law.slope * FUNNEL_USE).tanh();
    Condition::new(
        ("gain of the virtual law", "k_m tanh(gamma k_u) >= k_u"),
        ("Property 1, for (17)", Paper),
        (left, AtLeast, FUNNEL_USE),
        format!("k_u = {FUNNEL_USE} as in section VI-A"),
    )
}

/// Remark 1: the virtual rate is bounded. Printed with the largest rho_i, which forgets that the three
/// hyperbolic tangents can all be near 1: the norm of rho is what bounds it.
fn virtual_rate(case: &Case, _: &Bounds) -> Condition {
    let strength = case.law.virtual_law.strength();
    let width = case.law.performance.value(0.0);
    let limit = case.rate_limit_rad_s.unwrap_or(f64::NAN);
    let printed = strength * width.amax();
    let mut note = format!("printed with (|rho_i|)_max, which would give {printed:.4e}");
    if case.rate_limit_rad_s.is_none() {
        note += "; the file requires no largest rate";
    }
    Condition::new(
        (
            "virtual rate within the limit",
            "rate limit >= k_m M_omega |rho(0)|",
        ),
        ("Remark 1", PaperCorrected),
        (limit, AtLeast, strength * width.norm()),
        note,
    )
}

/// Section V-C, 1: B_1 > 0.
fn first_layer_decays(case: &Case, bounds: &Bounds) -> Condition {
    let scale = case.law.virtual_law.rate_scale_rad_s;
    let left = case.error.scalar.abs() * scale;
    let right = 4.0 * bounds.funnel_contraction_per_s;
    let note = format!(
        "|q_e0| of the start; with |q_e0| = 1 the left side is {scale:.4e}. A funnel that narrows in time \
         for a slew at the rate M_omega narrows faster than this"
    );
    Condition::new(
        (
            "first layer decays",
            "|q_e0| M_omega > 4 max |rho_i'| / rho_i",
        ),
        (SECTION, Paper),
        (left, Above, right),
        match left > right {
            true => "|q_e0| of the start".to_string(),
            false => note,
        },
    )
}

/// Used in (26): D_m bounds every component of the disturbance.
fn disturbance_compensated(case: &Case, _: &Bounds) -> Condition {
    Condition::new(
        ("disturbance compensated", "D_m >= max |d_i|"),
        ("(26)", Paper),
        (
            case.law.disturbance.bound_nm,
            AtLeast,
            case.disturbance_nm.amax(),
        ),
        "max |d_i|: of the sums of the amplitudes of each component".to_string(),
    )
}

/// Below (28): B_2 > 0, that is K_2 > b / 2.
fn second_layer_decays(case: &Case, bounds: &Bounds) -> Condition {
    Condition::new(
        ("second layer decays", "K_2 > b / 2"),
        ("(28)", Paper),
        (case.law.rate_gain, Above, 0.5 * bounds.young_constant_nm_s),
        "b is free; the one that makes V2_inf smallest is used".to_string(),
    )
}

/// Section V-C, 2: C_1 against beta.
fn lyapunov_faster_than_envelope(case: &Case, bounds: &Bounds) -> Condition {
    let rate = total_decay(bounds);
    let beta = case.trigger.decay_rate_per_s;
    Condition::new(
        (
            "Lyapunov function decays faster than its envelope",
            "C_1 > beta",
        ),
        (SECTION, PaperCorrected),
        (rate, Above, beta),
        reversed("C_1 < beta", "(33)", rate < beta),
    )
}

/// Section V-C, 2: C_eps against beta / 2.
fn first_layer_faster_than_envelope(case: &Case, bounds: &Bounds) -> Condition {
    let rate = bounds.first_layer_decay_per_s;
    let half = 0.5 * case.trigger.decay_rate_per_s;
    Condition::new(
        (
            "first layer decays faster than its envelope",
            "C_eps > beta / 2",
        ),
        (SECTION, PaperCorrected),
        (rate, Above, half),
        reversed("C_eps < beta / 2", "(47)", rate < half),
    )
}

fn reversed(printed: &str, needs: &str, printed_holds: bool) -> String {
    let as_printed = if printed_holds { "holds" } else { "fails" };
    format!("printed the wrong way round, {printed} (which {as_printed}); {needs} needs this side")
}

/// Below (33): V_0 > 0 at the start.
fn start_above_residual(case: &Case, bounds: &Bounds) -> Condition {
    let rate = total_decay(bounds);
    let (trigger, young) = (&case.trigger, bounds.young_constant_nm_s);
    let excess = rate - trigger.decay_rate_per_s;
    let defined = rate > 0.0 && excess > 0.0;
    let residual = bounds.disturbance_residual_w + 0.5 * trigger.held_error_terminal / young;
    let right = trigger.held_error_initial / (2.0 * young * excess) + residual / rate;
    let (first, second) = bounds.start_energy_j;
    Condition::new(
        (
            "start above what the disturbance leaves",
            "V(0) > s / (2 b (C_1 - beta)) + V_inf",
        ),
        ("(33)", Paper),
        (
            first + second,
            Above,
            if defined { right } else { f64::NAN },
        ),
        match defined {
            true => "at the first turn-on, t = 0".to_string(),
            false => "the right side is not defined, because C_1 is not above beta".to_string(),
        },
    )
}

/// Section V-C, 2: S2(0) >= V2(0).
fn envelope_above_start(case: &Case, bounds: &Bounds) -> Condition {
    Condition::new(
        ("envelope starts above", "S2(0) >= V2(0)"),
        (SECTION, Paper),
        (
            case.trigger.envelope_initial_j,
            AtLeast,
            bounds.start_energy_j.1,
        ),
        String::new(),
    )
}

/// Section V-C, 2: S2_inf > V2_inf.
fn envelope_above_residual(case: &Case, bounds: &Bounds) -> Condition {
    Condition::new(
        (
            "envelope ends above what the disturbance leaves",
            "S2_inf > V2_inf",
        ),
        (SECTION, Paper),
        (
            case.trigger.envelope_terminal_j,
            Above,
            bounds.second_layer_residual_j,
        ),
        "V2_inf = (D_0 + m / (2 b)) / B_2 with the b that makes it smallest".to_string(),
    )
}

/// Not in the paper: at the edge of the narrow funnel the virtual rate must exceed the rate error that
/// the trigger tolerates, or the attitude leaves the funnel unseen, because the trigger watches V2 only.
fn funnel_above_rate_error(case: &Case, bounds: &Bounds) -> Condition {
    let strength = case.law.virtual_law.strength();
    let trigger = &case.trigger;
    let tolerated =
        (1.0 - trigger.relative_buffer) * trigger.envelope_terminal_j - trigger.buffer_j;
    let (least, _) = bounds.inertia_kg_m2;
    Condition::new(
        (
            "virtual rate above the tolerated rate error",
            "k_m M_omega rho_inf >= sqrt(2 (S2_inf - delta_m) / lambda_min)",
        ),
        ("not in the paper", Found),
        (
            strength * bounds.narrowest_funnel,
            AtLeast,
            (2.0 * tolerated / least).sqrt(),
        ),
        String::new(),
    )
}

/// (69) at the start: the shortest time on is above 0.
fn on_time_at_the_start(case: &Case, bounds: &Bounds) -> Condition {
    let time = shortest_on_time(case, bounds, case.trigger.held_error_initial);
    on_time("time on, at the start", time)
}

/// (69) in the limit of late times.
fn on_time_in_the_end(case: &Case, bounds: &Bounds) -> Condition {
    on_time("time on, in the end", shortest_on_time(case, bounds, 0.0))
}

fn on_time(name: &'static str, time_s: f64) -> Condition {
    Condition::new(
        (
            name,
            "(s e^(-beta t) + m) / (s beta e^(-beta t) + M_1 + M_2) > 0",
        ),
        ("(69)", PaperCorrected),
        (time_s, Above, 0.0),
        "in s; with 2 / lambda_min in Q_2 of (60), printed 2 / lambda_max".to_string(),
    )
}

/// (80): the shortest time off has a positive solution when N_k > delta_m.
fn off_time(case: &Case, bounds: &Bounds) -> Condition {
    let trigger = &case.trigger;
    let beta = trigger.decay_rate_per_s;
    let on = shortest_on_time(case, bounds, 0.0);
    let gap = trigger.envelope_terminal_j - bounds.second_layer_residual_j;
    let decrease = gap * -(-beta * on).exp_m1();
    let excess = decrease - trigger.buffer_j;
    let note = match excess > 0.0 {
        true => format!(
            "the time off is at least {:.4e} s",
            shortest_off_time(case, bounds, decrease)
        ),
        false => "(80) has no positive solution, so it bounds no time off".to_string(),
    };
    Condition::new(
        ("time off", "N_k > delta_m"),
        ("(80)", Paper),
        (decrease, Above, trigger.buffer_j),
        note,
    )
}

/// C_1 of (29).
fn total_decay(bounds: &Bounds) -> f64 {
    let (first, second) = (
        bounds.first_layer_decay_per_s,
        bounds.second_layer_decay_per_s,
    );
    first.min(second)
}

/// (69) with s e^(-beta t) given, s.
fn shortest_on_time(case: &Case, bounds: &Bounds, transient: f64) -> f64 {
    let (law, trigger) = (&case.law, &case.trigger);
    let (least, most) = bounds.inertia_kg_m2;
    let disturbance = &law.disturbance;
    let damping = law.rate_gain + disturbance.bound_nm / disturbance.smoothing_rad_s;
    // R_1, R_2 of (58) with B_c of (55).
    let slope = most * bounds.rate_rad_s / least + bounds.rate_rad_s + damping / least;
    let torque = (1.0 + 3f64.sqrt()) * disturbance.bound_nm
        + most * bounds.virtual_acceleration_rad_s2
        + bounds.compensation_nm;
    let offset = damping * bounds.virtual_acceleration_rad_s2
        + most * bounds.virtual_jerk_rad_s3
        + torque * slope
        + bounds.compensation_rate_nm_s;
    // Q_1 to Q_3, G_1, G_2, M_1 and M_2 of (60), with V2 at its envelope.
    let weight = slope * law.rate_gain + 2.0 * slope + 1.0;
    let energy = 2.0 / least * slope * law.rate_gain;
    let residual = bounds.second_layer_residual_j;
    let above = (trigger.envelope_initial_j - residual).max(0.0);
    let m1 = weight * trigger.held_error_initial + energy * above;
    let m2 = weight * trigger.held_error_terminal + energy * residual + offset * offset;
    let allowed = transient + trigger.held_error_terminal;
    allowed / (transient * trigger.decay_rate_per_s + m1 + m2)
}

/// The positive root of (80), s, at the start, where |S2'| and W_1 are largest.
fn shortest_off_time(case: &Case, bounds: &Bounds, decrease: f64) -> f64 {
    let trigger = &case.trigger;
    let fall = trigger.envelope_initial_j - trigger.envelope_terminal_j;
    let drift = bounds.drift_rate;
    let quadratic = 0.25 * drift * drift;
    // (a_0^2 / 2) W_1 with W_1 = (2 / a_0) sqrt(S2 - N_k).
    let linear = trigger.decay_rate_per_s * fall
        + drift * (trigger.envelope_initial_j - decrease).max(0.0).sqrt();
    let constant = decrease - trigger.buffer_j;
    let root = (linear * linear + 4.0 * quadratic * constant).sqrt();
    2.0 * constant / (linear + root)
}
