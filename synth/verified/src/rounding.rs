//! Directed rounding without changing the rounding mode of the processor.
//!
//! Every `*_down` function returns a double that is not above the exact result and every `*_up`
//! function one that is not below it. The sign of the error of the round-to-nearest operation is
//! found exactly (Knuth's two-sum; Dekker's product with Veltkamp's splitting), so an exact result
//! is returned as it is and an inexact one moves by one unit in the last place at most. Where the
//! error cannot be represented (near overflow and underflow) the result always moves outward.
//!
//! IEEE 754 binary64 arithmetic with gradual underflow is assumed: no flush-to-zero and no
//! extended precision, which is what Rust gives on every 64-bit target.
//!
//! Infinite operands are bounds of unbounded intervals. For them, and for NaN, the functions
//! return the limit of the operation where it has one and the outward infinity where it has none.
//!
//! Source: T. J. Dekker, "A floating-point technique for extending the available precision",
//! Numer. Math. 18 (1971) 224-242; S. M. Rump, T. Ogita, S. Oishi, "Accurate floating-point
//! summation", SIAM J. Sci. Comput. 31 (2008) 189-224.

/// Smallest positive double, `2^-1074`.
pub const SMALLEST_POSITIVE: f64 = f64::from_bits(1);

/// Half the distance from 1 to the next double, `u = 2^-53`.
pub const UNIT_ROUNDOFF: f64 = 0.5 * f64::EPSILON;

/// Results above this magnitude may have an error term that underflows when computed below it.
const ERROR_EXACT_ABOVE: f64 = power_of_two(-960);
const ERROR_EXACT_BELOW: f64 = power_of_two(990);

/// The double `2^exponent`; exponents outside `-1022..=1023` are clamped to that range.
#[inline]
pub const fn power_of_two(exponent: i32) -> f64 {
    let clamped = match exponent {
        ..=-1023 => -1022,
        1024.. => 1023,
        _ => exponent,
    };
    f64::from_bits(((clamped + 1023) as u64) << 52)
}

/// `floor(log2(value))` of a positive finite double, subnormal ones included.
///
/// For any other argument the result is meaningless (but there is one).
#[inline]
pub fn binary_exponent(value: f64) -> i32 {
    if value < f64::MIN_POSITIVE {
        binary_exponent_of_normal(value * power_of_two(64)) - 64
    } else {
        binary_exponent_of_normal(value)
    }
}

#[inline]
fn binary_exponent_of_normal(value: f64) -> i32 {
    ((value.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// The least double above `value`; infinity and NaN are returned unchanged.
#[inline]
pub fn next_up(value: f64) -> f64 {
    if value.is_nan() || value == f64::INFINITY {
        value
    } else if value == 0.0 {
        SMALLEST_POSITIVE
    } else if value > 0.0 {
        f64::from_bits(value.to_bits() + 1)
    } else {
        f64::from_bits(value.to_bits() - 1)
    }
}

/// The greatest double below `value`; minus infinity and NaN are returned unchanged.
#[inline]
pub fn next_down(value: f64) -> f64 {
    -next_up(-value)
}

/// Where the exact result lies relative to the rounded one.
#[derive(Clone, Copy, PartialEq)]
enum Exact {
    Below,
    Equal,
    Above,
    Unknown,
}

impl Exact {
    #[inline]
    fn from_error(error: f64) -> Self {
        if !error.is_finite() {
            Exact::Unknown
        } else if error == 0.0 {
            Exact::Equal
        } else if error < 0.0 {
            Exact::Below
        } else {
            Exact::Above
        }
    }
}

/// A round-to-nearest result with the side on which the exact result lies.
#[derive(Clone, Copy)]
struct Rounded {
    value: f64,
    exact: Exact,
}

impl Rounded {
    #[inline]
    fn exactly(value: f64) -> Self {
        Rounded {
            value,
            exact: Exact::Equal,
        }
    }

    /// A rounded value with the sign of what the exact result is above it.
    #[inline]
    fn with_error(value: f64, error: f64) -> Self {
        Rounded {
            value,
            exact: Exact::from_error(error),
        }
    }

    /// A lower bound of the exact result. A rounded `+inf` marked inexact is an overflow, so the
    /// exact result is finite and above the greatest double.
    #[inline]
    fn down(self) -> f64 {
        match self.exact {
            _ if self.value.is_nan() => f64::NEG_INFINITY,
            Exact::Equal | Exact::Above => self.value,
            Exact::Below | Exact::Unknown => next_down(self.value),
        }
    }

    #[inline]
    fn up(self) -> f64 {
        match self.exact {
            _ if self.value.is_nan() => f64::INFINITY,
            Exact::Equal | Exact::Below => self.value,
            Exact::Above | Exact::Unknown => next_up(self.value),
        }
    }
}

#[inline]
fn is_unbounded(left: f64, right: f64) -> bool {
    !left.is_finite() || !right.is_finite()
}

#[inline]
fn rounded_sum(left: f64, right: f64) -> Rounded {
    let sum = left + right;
    if is_unbounded(left, right) {
        return Rounded::exactly(sum);
    }
    if sum.is_infinite() {
        return overflowed(sum);
    }
    let right_part = sum - left;
    let left_part = sum - right_part;
    Rounded::with_error(sum, (left - left_part) + (right - right_part))
}

#[inline]
fn overflowed(value: f64) -> Rounded {
    Rounded::with_error(value, -value.signum())
}

/// Veltkamp's splitting into two parts of 26 bits each.
#[inline]
fn split(value: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * value;
    let high = scaled - (scaled - value);
    (high, value - high)
}

/// The error `left * right - product` of the rounded product, exact if nothing under- or
/// overflows; `None` if that is not certain.
#[inline]
fn product_error(left: f64, right: f64, product: f64) -> Option<f64> {
    let safe = left.abs() < ERROR_EXACT_BELOW
        && right.abs() < ERROR_EXACT_BELOW
        && product.abs() < ERROR_EXACT_BELOW
        && product.abs() > ERROR_EXACT_ABOVE;
    if !safe {
        return None;
    }
    let (left_high, left_low) = split(left);
    let (right_high, right_low) = split(right);
    let partial =
        (left_high * right_high - product) + left_high * right_low + left_low * right_high;
    Some(partial + left_low * right_low)
}

#[inline]
fn is_normal_power_of_two(value: f64) -> bool {
    value.is_normal() && value.to_bits() & ((1 << 52) - 1) == 0
}

/// The rounded result of an operation on nonzero finite numbers whose error is not computable:
/// an underflow to zero has a known sign, and anything else may lie on either side.
#[inline]
fn undecided(value: f64, negative: bool) -> Rounded {
    let exact = match (value == 0.0, negative) {
        (true, true) => Exact::Below,
        (true, false) => Exact::Above,
        _ => Exact::Unknown,
    };
    Rounded { value, exact }
}

#[inline]
fn rounded_product(left: f64, right: f64) -> Rounded {
    if left == 0.0 || right == 0.0 {
        return Rounded::exactly(0.0);
    }
    let product = left * right;
    if is_unbounded(left, right) {
        return Rounded::exactly(product);
    }
    if product.is_infinite() {
        return overflowed(product);
    }
    let scaling = is_normal_power_of_two(left) || is_normal_power_of_two(right);
    if left.abs() == 1.0 || right.abs() == 1.0 || (scaling && product.abs() > f64::MIN_POSITIVE) {
        return Rounded::exactly(product);
    }
    match product_error(left, right, product) {
        Some(error) => Rounded::with_error(product, error),
        None => undecided(product, (left < 0.0) != (right < 0.0)),
    }
}

#[inline]
fn rounded_quotient(dividend: f64, divisor: f64) -> Rounded {
    if divisor == 0.0 || dividend.is_nan() || divisor.is_nan() {
        return Rounded::exactly(f64::NAN);
    }
    if dividend == 0.0 || (divisor.is_infinite() && dividend.is_infinite()) {
        return Rounded::exactly(0.0);
    }
    let quotient = dividend / divisor;
    if is_unbounded(dividend, divisor) || divisor.abs() == 1.0 {
        return Rounded::exactly(quotient);
    }
    if quotient.is_infinite() {
        return overflowed(quotient);
    }
    let negative = (dividend < 0.0) != (divisor < 0.0);
    let product = quotient * divisor;
    match product_error(quotient, divisor, product) {
        Some(error) if quotient.abs() > ERROR_EXACT_ABOVE => {
            let remainder = (dividend - product) - error;
            Rounded::with_error(quotient, remainder * divisor.signum())
        }
        _ => undecided(quotient, negative),
    }
}

#[inline]
fn rounded_root(value: f64) -> Rounded {
    if value == 0.0 || value == f64::INFINITY {
        return Rounded::exactly(value);
    }
    let root = value.sqrt();
    let square = root * root;
    match product_error(root, root, square) {
        Some(error) => Rounded::with_error(root, (value - square) - error),
        None => undecided(root, false),
    }
}

/// Lower bound of `left + right`.
#[inline]
pub fn add_down(left: f64, right: f64) -> f64 {
    rounded_sum(left, right).down()
}

/// Upper bound of `left + right`.
#[inline]
pub fn add_up(left: f64, right: f64) -> f64 {
    rounded_sum(left, right).up()
}

/// Lower bound of `left - right`.
#[inline]
pub fn sub_down(left: f64, right: f64) -> f64 {
    rounded_sum(left, -right).down()
}

/// Upper bound of `left - right`.
#[inline]
pub fn sub_up(left: f64, right: f64) -> f64 {
    rounded_sum(left, -right).up()
}

/// Lower bound of `left * right`; zero times infinity is zero.
#[inline]
pub fn mul_down(left: f64, right: f64) -> f64 {
    rounded_product(left, right).down()
}

/// Upper bound of `left * right`; zero times infinity is zero.
#[inline]
pub fn mul_up(left: f64, right: f64) -> f64 {
    rounded_product(left, right).up()
}

/// Lower bound of `dividend / divisor`; minus infinity if the divisor is zero.
#[inline]
pub fn div_down(dividend: f64, divisor: f64) -> f64 {
    rounded_quotient(dividend, divisor).down()
}

/// Upper bound of `dividend / divisor`; infinity if the divisor is zero.
#[inline]
pub fn div_up(dividend: f64, divisor: f64) -> f64 {
    rounded_quotient(dividend, divisor).up()
}

/// Lower bound of the square root; minus infinity if `value` is negative.
#[inline]
pub fn sqrt_down(value: f64) -> f64 {
    rounded_root(value).down()
}

/// Upper bound of the square root; infinity if `value` is negative.
#[inline]
pub fn sqrt_up(value: f64) -> f64 {
    rounded_root(value).up()
}
