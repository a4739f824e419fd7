//! Numbers that are claimed, rounded to the side on which the claim stays true.

use std::fmt;

/// Significant digits of a claim where the format names none.
const DIGITS: usize = 6;

/// A number that something is proved or stated to stay below or above. It is written with six significant digits, or as
/// many as the precision of the format says, and rounded so that what is written is still true: a bound up, a set or an
/// angle down. What is rounded is the number as files have it, the shortest decimal that reads back as the same double.
/// A number other than zero is never written as zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Claim {
    /// The quantity is at most this, such as a gain: rounded up.
    AtMost(f64),
    /// The quantity is at least this, such as a certified angle: rounded down.
    AtLeast(f64),
}

impl fmt::Display for Claim {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (value, upwards) = match *self {
            Claim::AtMost(value) => (value, true),
            Claim::AtLeast(value) => (value, false),
        };
        if value == 0.0 || !value.is_finite() {
            return write!(formatter, "{}", value + 0.0);
        }
        let digits = formatter.precision().unwrap_or(DIGITS).max(1);
        let (mut shown, power) = rounded(value.abs(), digits, upwards == (value > 0.0));
        while shown.len() > 1 && shown.ends_with('0') {
            shown.pop();
        }
        let sign = if value < 0.0 { "-" } else { "" };
        formatter.write_str(sign)?;
        formatter.write_str(&placed(&shown, power))
    }
}

/// The first digits of a number above zero, rounded away from zero or towards it, and the power of ten of the first.
fn rounded(value: f64, digits: usize, away: bool) -> (String, i32) {
    let whole = format!("{value:e}");
    let (mantissa, power) = whole.split_once('e').unwrap_or((&whole, "0"));
    let mut power: i32 = power.parse().unwrap_or(0);
    let all: Vec<u8> = mantissa.bytes().filter(|byte| *byte != b'.').collect();
    let (kept, rest) = all.split_at(digits.min(all.len()));
    let mut kept = kept.to_vec();
    if away && rest.iter().any(|digit| *digit != b'0') {
        let last = kept.iter().rposition(|digit| *digit != b'9');
        let nines = last.map_or(0, |last| last + 1);
        kept[nines..].fill(b'0');
        match last {
            Some(last) => kept[last] += 1,
            None => {
                kept[0] = b'1';
                power += 1;
            }
        }
    }
    (kept.into_iter().map(char::from).collect(), power)
}

/// Digits with the first at a power of ten: plain from 0.0001 to 999999, with an exponent otherwise.
fn placed(digits: &str, power: i32) -> String {
    let split = |places: usize| match digits.split_at_checked(places) {
        Some((whole, rest)) if !rest.is_empty() => format!("{whole}.{rest}"),
        _ => format!("{digits:0<places$}"),
    };
    match power {
        0..=5 => split(power as usize + 1),
        -4..=-1 => format!("0.{}{digits}", "0".repeat((-power - 1) as usize)),
        _ => format!("{}e{power}", split(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_up_and_sets_down() {
        let cases = [
            (0.152_224_781, "0.152225", "0.152224"),
            (8.013_999_9, "8.014", "8.01399"),
            (61.061_234, "61.0613", "61.0612"),
            (0.999_999_99, "1", "0.999999"),
            (-2.5, "-2.5", "-2.5"),
            (-1.234_567_8, "-1.23456", "-1.23457"),
            (459_270_611.0, "4.59271e8", "4.5927e8"),
            (999_999.5, "1e6", "999999"),
            (123_456.0, "123456", "123456"),
            (1200.0, "1200", "1200"),
        ];
        for (value, up, down) in cases {
            assert_eq!(Claim::AtMost(value).to_string(), up);
            assert_eq!(Claim::AtLeast(value).to_string(), down);
        }
    }

    #[test]
    fn small_guarantees_are_not_written_as_zero() {
        assert_eq!(Claim::AtMost(4.2e-7).to_string(), "4.2e-7");
        assert_eq!(Claim::AtMost(4.200_000_1e-7).to_string(), "4.20001e-7");
        assert_eq!(Claim::AtMost(5e-324).to_string(), "5e-324");
        assert_eq!(Claim::AtMost(0.000_123).to_string(), "0.000123");
        assert_eq!(Claim::AtMost(-0.0).to_string(), "0");
        assert_eq!(Claim::AtMost(f64::INFINITY).to_string(), "inf");
    }

    #[test]
    fn the_precision_is_the_number_of_significant_digits() {
        assert_eq!(format!("{:.1}", Claim::AtMost(0.31)), "0.4");
        assert_eq!(format!("{:.1}", Claim::AtLeast(0.39)), "0.3");
        assert_eq!(format!("{:.1}", Claim::AtMost(0.3)), "0.3");
        assert_eq!(format!("{:.4}", Claim::AtLeast(2.777_9e-6)), "2.777e-6");
        assert_eq!(format!("{:.2}", Claim::AtMost(0.999)), "1");
    }

    #[test]
    fn what_is_written_is_never_on_the_unsafe_side() {
        let mut value = 1e-9;
        while value < 1e9 {
            value *= 1.037_219_4;
            for signed in [value, -value] {
                let read = |claim: Claim| claim.to_string().parse::<f64>().unwrap();
                assert!(read(Claim::AtMost(signed)) >= signed, "{signed}");
                assert!(read(Claim::AtLeast(signed)) <= signed, "{signed}");
            }
        }
    }
}
