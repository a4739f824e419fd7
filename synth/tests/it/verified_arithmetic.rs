//! Interval arithmetic against exact rational arithmetic.

use crate::exact::{exp_bounds, pi_bounds, quotient, rational, sine_bounds, Exact};
use num_rational::BigRational;
use num_traits::Signed;
use proptest::prelude::*;
use synth::certify::interval::{half_angle_sine_squared, Interval};
use synth::certify::rounding::{next_down, next_up};
use synth::certify::scalar::Scalar;

/// Whether an exact number is a member; an infinite bound holds for every number.
fn encloses(interval: Interval, value: &BigRational) -> bool {
    let above = interval.lo() == f64::NEG_INFINITY || &rational(interval.lo()) <= value;
    let below = interval.hi() == f64::INFINITY || value <= &rational(interval.hi());
    above && below
}

/// Whether the number in `[low, high]` may be a member.
fn may_enclose(interval: Interval, (low, high): &(BigRational, BigRational)) -> bool {
    let above = interval.lo() == f64::NEG_INFINITY || &rational(interval.lo()) <= high;
    let below = interval.hi() == f64::INFINITY || low <= &rational(interval.hi());
    above && below
}

/// Number of doubles from the lower to the upper bound, at most `limit`.
fn steps_wide(interval: Interval, limit: usize) -> usize {
    let mut bound = interval.lo();
    (0..limit)
        .find(|_| {
            let reached = bound >= interval.hi();
            bound = next_up(bound);
            reached
        })
        .unwrap_or(limit)
}

fn is_ordinary(value: &BigRational) -> bool {
    value.abs() > rational(1e-280) && value.abs() < rational(1e280)
}

/// The best that any enclosure can do: the two doubles around an ordinary number, or itself.
fn is_optimal(interval: Interval, value: &BigRational) -> bool {
    let one_member = interval.lo() == interval.hi();
    let neighbours = next_up(interval.lo()) == interval.hi();
    let strictly_inside =
        neighbours && &rational(interval.lo()) < value && value < &rational(interval.hi());
    encloses(interval, value) && (one_member || strictly_inside)
}

fn finite() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()),
        2 => -1e3..1e3_f64,
        1 => (-40_i32..40).prop_map(f64::from),
        1 => (-1074_i32..1024, any::<bool>()).prop_map(|(power, negative)| {
            let magnitude = if power < -1022 {
                f64::from_bits(1 << (power + 1074))
            } else {
                f64::from_bits(((power + 1023) as u64) << 52)
            };
            if negative { -magnitude } else { magnitude }
        }),
        1 => (0_u64..1 << 53).prop_map(f64::from_bits),
        1 => prop::sample::select(vec![0.0, -0.0, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324]),
    ]
}

fn ordinary() -> impl Strategy<Value = f64> {
    (-1.0..1.0_f64, -300_i32..300).prop_map(|(mantissa, power)| mantissa * 2_f64.powi(power))
}

/// An interval with a member.
fn interval_with_member() -> impl Strategy<Value = (Interval, f64)> {
    (finite(), finite(), finite(), any::<bool>()).prop_map(|(x, y, z, narrow)| {
        let mut sorted = if narrow {
            [next_down(x), x, next_up(next_up(x))]
        } else {
            [x, y, z]
        };
        sorted.sort_by(f64::total_cmp);
        (Interval::new(sorted[0], sorted[2]), sorted[1])
    })
}

fn cases(count: u32) -> ProptestConfig {
    ProptestConfig {
        cases: count,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn point(value: f64) -> Interval {
    Interval::from(value)
}

proptest! {
    #![proptest_config(cases(4000))]

    #[test]
    fn operations_on_numbers_enclose_the_exact_result(x in finite(), y in finite()) {
        let (p, q) = (rational(x), rational(y));
        prop_assert!(encloses(point(x) + point(y), &(&p + &q)));
        prop_assert!(encloses(point(x) - point(y), &(&p - &q)));
        prop_assert!(encloses(point(x) * point(y), &(&p * &q)));
        prop_assert!(encloses(point(x).sqr(), &(&p * &p)));
        prop_assert!(encloses(-point(x), &-p.clone()));
        if y == 0.0 {
            prop_assert!((point(x) / point(y)).is_entire());
        } else {
            prop_assert!(encloses(point(x) / point(y), &(&p / &q)));
        }
    }

    #[test]
    fn no_finite_bound_is_more_than_two_steps_from_the_other(x in finite(), y in finite()) {
        let results = [point(x) + point(y), point(x) * point(y), point(x).sqr()];
        for result in results {
            if result.is_bounded() {
                prop_assert!(steps_wide(result, 9) <= 2, "{result:?}");
            }
        }
        let quotient = point(x) / point(y);
        if quotient.is_bounded() {
            prop_assert!(steps_wide(quotient, 9) <= 2, "{quotient:?}");
        }
    }

    #[test]
    fn ordinary_results_are_optimal(x in ordinary(), y in ordinary()) {
        let (p, q) = (rational(x), rational(y));
        prop_assert!(is_optimal(point(x) + point(y), &(&p + &q)));
        if is_ordinary(&(&p * &q)) {
            prop_assert!(is_optimal(point(x) * point(y), &(&p * &q)));
        }
        if y != 0.0 && is_ordinary(&p) && is_ordinary(&(&p / &q)) {
            prop_assert!(is_optimal(point(x) / point(y), &(&p / &q)));
        }
    }

    #[test]
    fn exact_results_are_not_widened(m in -90_000_000_i64..90_000_000, n in 1_i64..90_000_000) {
        let (x, y) = (point(m as f64), point(n as f64));
        prop_assert_eq!(x * y, point((m * n) as f64));
        prop_assert_eq!(x + y, point((m + n) as f64));
        prop_assert_eq!(x * y / y, x);
        prop_assert_eq!((y * y).sqrt(), y);
    }

    #[test]
    fn operations_on_intervals_enclose_those_on_members(
        (left, x) in interval_with_member(),
        (right, y) in interval_with_member(),
    ) {
        let (p, q) = (rational(x), rational(y));
        prop_assert!(left.contains(x) && right.contains(y));
        prop_assert!(encloses(left + right, &(&p + &q)));
        prop_assert!(encloses(left - right, &(&p - &q)));
        prop_assert!(encloses(left * right, &(&p * &q)));
        prop_assert!(encloses(left.sqr(), &(&p * &p)));
        let greater = if p > q { &p } else { &q };
        prop_assert!(encloses(left.max(right), greater));
        prop_assert!(encloses(left.hull(right), &p) && encloses(left.hull(right), &q));
        if right.contains(0.0) {
            prop_assert!((left / right).is_entire());
        } else {
            prop_assert!(encloses(left / right, &(&p / &q)));
        }
    }

    #[test]
    fn the_radius_reaches_every_member_from_the_midpoint((interval, x) in interval_with_member()) {
        let (middle, radius) = (interval.midpoint(), interval.radius());
        prop_assert_eq!(radius.is_finite(), interval.is_bounded());
        if interval.is_bounded() {
            prop_assert!(interval.contains(middle));
            let distance = (rational(x) - rational(middle)).abs();
            prop_assert!(distance <= rational(radius));
        }
    }

    #[test]
    fn the_square_root_encloses_by_squaring(x in finite()) {
        let root = point(x).sqrt();
        if x < 0.0 {
            prop_assert!(root.is_entire());
        } else {
            let (low, high) = (rational(root.lo()), rational(root.hi()));
            prop_assert!(!low.is_negative() && &low * &low <= rational(x));
            prop_assert!(&high * &high >= rational(x));
            let allowed = if x > 1e-280 && x < 1e297 { 1 } else { 2 };
            prop_assert!(steps_wide(root, 9) <= allowed);
        }
    }

    #[test]
    fn the_scalar_interface_encloses_the_exact_evaluation(
        x in -50.0..50.0_f64, y in 0.1..9.0_f64, z in finite(),
    ) {
        fn evaluate<T: Scalar>(x: f64, y: f64, z: f64) -> T {
            let (x, y, z) = (T::from_f64(x), T::from_f64(y), T::from_f64(z));
            let ratio = (x.clone() * y.clone() - T::one()) / (y.clone() + T::one());
            (ratio.clone() + z.max(T::zero())) * -(ratio - x) + y
        }
        let enclosure: Interval = evaluate(x, y, z);
        let exact: Exact = evaluate(x, y, z);
        prop_assert!(encloses(enclosure, &exact.0));
    }
}

proptest! {
    #![proptest_config(cases(400))]

    #[test]
    fn the_exponential_encloses_the_exact_one(x in -700.0..=700.0_f64) {
        let enclosure = point(x).exp();
        prop_assert!(may_enclose(enclosure, &exp_bounds(&rational(x))));
        prop_assert!(steps_wide(enclosure, 30) <= 8, "{x:e} {enclosure:?}");
    }

    #[test]
    fn the_exponential_of_a_small_number_encloses_the_exact_one(
        x in -1.0..1.0_f64, p in 0..1000_i32,
    ) {
        let argument = x * 2_f64.powi(-p);
        let enclosure = point(argument).exp();
        prop_assert!(may_enclose(enclosure, &exp_bounds(&rational(argument))));
        prop_assert!(steps_wide(enclosure, 30) <= 6, "{argument:e} {enclosure:?}");
    }

    #[test]
    fn an_upper_bound_of_the_exponential_is_one_number_above_it(x in -700.0..700.0_f64) {
        let bound = point(x).exp_upper();
        prop_assert_eq!(bound.lo(), bound.hi());
        let (low, high) = exp_bounds(&rational(x));
        prop_assert!(low <= rational(bound.lo()));
        let oracle = Exact(rational(x)).exp_upper().0;
        prop_assert!(low <= oracle && oracle <= high);
        let forty_digits = BigRational::from_integer(num_bigint::BigInt::from(10).pow(40));
        prop_assert!((&high - &low) * forty_digits <= low);
    }

    #[test]
    fn the_half_angle_sine_encloses_the_exact_one(
        theta in 0.0..=std::f64::consts::PI, p in 0..99_i32,
    ) {
        for angle in [theta, theta * 2_f64.powi(-p)] {
            let (low, high) = sine_bounds(&(rational(angle) / num_bigint::BigInt::from(2)));
            let enclosure = half_angle_sine_squared(angle);
            prop_assert!(may_enclose(enclosure, &(&low * &low, &high * &high)));
            prop_assert!(steps_wide(enclosure, 30) <= 24, "{angle:e} {enclosure:?}");
        }
    }

    #[test]
    fn the_half_angle_sine_of_an_interval_encloses_its_members(
        x in 0.0..4.0_f64, y in 0.0..4.0_f64, weight in 0.0..1.0_f64,
    ) {
        let member = (x + weight * (y - x)).clamp(x.min(y), x.max(y));
        let (low, high) = sine_bounds(&(rational(member) / num_bigint::BigInt::from(2)));
        let enclosure = half_angle_sine_squared(Interval::new(x.min(y), x.max(y)));
        prop_assert!(may_enclose(enclosure, &(&low * &low, &high * &high)));
    }
}

#[test]
fn an_invalid_number_gives_the_entire_line() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(point(value).is_entire());
        assert!(!point(value).contains(value));
    }
    for (lo, hi) in [
        (1.0, 0.0),
        (f64::NAN, 1.0),
        (0.0, f64::NAN),
        (f64::INFINITY, f64::INFINITY),
    ] {
        assert!(Interval::new(lo, hi).is_entire());
    }
    assert!(Interval::new(f64::NEG_INFINITY, f64::NEG_INFINITY).is_entire());
    assert!((point(1.0) / Interval::new(-1.0, 1.0)).is_entire());
    assert!(Interval::new(-1e-300, 4.0).sqrt().is_entire());
}

#[test]
fn an_invalid_number_survives_every_operation() {
    let invalid = point(f64::NAN);
    let zero = Interval::ZERO;
    let results = [
        invalid * zero,
        zero * invalid,
        zero / invalid,
        invalid / point(2.0),
        invalid + zero,
        zero - invalid,
        -invalid,
        invalid.max(point(3.0)),
        point(3.0).max(invalid),
        invalid.sqr(),
        invalid.sqrt(),
        invalid.exp(),
        invalid.exp_upper(),
        invalid.hull(zero),
        half_angle_sine_squared(invalid),
        [zero, invalid, zero].into_iter().sum(),
    ];
    for (index, result) in results.iter().enumerate() {
        assert!(result.is_entire(), "operation {index} gave {result:?}");
    }
    assert_eq!(invalid.radius(), f64::INFINITY);
}

#[test]
fn overflow_is_enclosed_from_the_greatest_double_to_infinity() {
    let greatest = point(f64::MAX);
    let above = Interval::new(f64::MAX, f64::INFINITY);
    assert_eq!(greatest + greatest, above);
    assert_eq!(greatest * point(2.0), above);
    assert_eq!(greatest / point(0.5), above);
    assert_eq!(greatest.sqr(), above);
    assert_eq!(
        -greatest - greatest,
        Interval::new(f64::NEG_INFINITY, f64::MIN)
    );
    // A bound of a real number, so multiplication by zero and division by it are settled.
    assert_eq!(above * Interval::ZERO, Interval::ZERO);
    assert_eq!(
        point(1.0) / above,
        Interval::new(0.0, next_up(1.0 / f64::MAX))
    );
    assert!((above - above).is_entire());
    assert_eq!(above / above, Interval::new(0.0, f64::INFINITY));
}

#[test]
fn underflow_is_enclosed_and_keeps_its_sign() {
    let least = point(5e-324);
    assert_eq!(least * point(0.25), Interval::new(0.0, 5e-324));
    assert_eq!(-least * point(0.25), Interval::new(-5e-324, 0.0));
    assert_eq!(least / point(4.0), Interval::new(0.0, 5e-324));
    assert_eq!(least.sqr(), Interval::new(0.0, 5e-324));
    assert_eq!(least - least, Interval::ZERO);
    assert_eq!(least * point(-1.0), -least);
}

#[test]
fn exact_zeros_ones_and_powers_of_two_do_not_widen() {
    for value in [0.1, -7.3e-305, 1.7e308, 5e-324] {
        assert_eq!(point(value) * Interval::ZERO, Interval::ZERO);
        assert_eq!(point(value) + Interval::ZERO, point(value));
        assert_eq!(point(value) * Interval::ONE, point(value));
        assert_eq!(point(value) / point(-1.0), point(-value));
    }
    assert_eq!(point(0.1) * point(1e308_f64.powi(0) * 1024.0), point(102.4));
    assert_eq!(
        point(1e-300) * point(2_f64.powi(-20)),
        point(1e-300 / 1048576.0)
    );
}

#[test]
fn the_exponential_is_safe_beyond_its_range() {
    let far_below = point(-1e300).exp();
    assert!(far_below.lo() == 0.0 && far_below.hi() > 0.0 && far_below.hi() < 1e-303);
    let far_above = point(701.0).exp();
    assert!(far_above.hi() == f64::INFINITY && far_above.lo() > 1e303);
    assert!(far_above.lo().is_finite());
    assert!(point(1e300).exp_upper().is_entire());
    assert_eq!(Interval::ZERO.exp(), Interval::ONE);
    let half_line = Interval::new(f64::NEG_INFINITY, 0.0).exp();
    assert_eq!(half_line, Interval::new(0.0, 1.0));
}

#[test]
fn the_half_angle_sine_is_monotone_to_pi_and_bounded_by_one() {
    assert_eq!(half_angle_sine_squared(0.0), Interval::ZERO);
    let at_pi = half_angle_sine_squared(Interval::PI);
    assert!(at_pi.hi() == 1.0 && at_pi.lo() > 1.0 - 1e-14);
    let right_angle = half_angle_sine_squared(Interval::PI * point(0.5));
    assert!(right_angle.contains(0.5) && right_angle.radius() < 1e-15);
    let degrees = half_angle_sine_squared(point(120.0) * Interval::PI / point(180.0));
    assert!(degrees.contains(0.75) && degrees.radius() < 2e-15);
    assert_eq!(half_angle_sine_squared(-0.5), Interval::new(0.0, 1.0));
    assert_eq!(half_angle_sine_squared(50.0), Interval::new(0.0, 1.0));
    assert_eq!(half_angle_sine_squared(Interval::new(3.0, 3.5)).hi(), 1.0);
    let beyond = half_angle_sine_squared(Interval::new(3.0, 4.0));
    assert!(beyond.lo() <= 2_f64.sin().powi(2) && beyond.lo() > 0.82);
}

#[test]
fn pi_is_enclosed() {
    let (low, high) = pi_bounds();
    assert!(rational(Interval::PI.lo()) < low && high < rational(Interval::PI.hi()));
    assert!(&high - &low < quotient(1, i64::MAX));
}

#[test]
fn sums_of_intervals_accumulate() {
    let terms = [0.1, 0.2, -0.3];
    let total: Interval = terms.iter().map(|&term| point(term)).sum();
    let exact: BigRational = terms.iter().map(|&term| rational(term)).sum();
    assert!(encloses(total, &exact) && total.radius() < 1e-16);
    let mut running = Interval::ONE;
    running += point(0.1);
    running -= point(0.1);
    assert!(running.contains(1.0) && running.radius() < 1e-15);
}
