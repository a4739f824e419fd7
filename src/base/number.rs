//! Numbers as text.

/// How a number is rounded and when it gets an exponent.
struct Format {
    /// Significant digits.
    digits: i32,
    /// Magnitudes below are written as zero.
    zero_below: f64,
    /// Smallest power of ten that is written without an exponent; the largest is 10^5.
    least_power: i32,
    /// Whether zeros at the end of the digits before an exponent are left out.
    trims: bool,
}

const SHORT: Format = Format {
    digits: 5,
    zero_below: f64::from_bits(1),
    least_power: -4,
    trims: false,
};
const PRECISE: Format = Format {
    digits: 12,
    trims: true,
    ..SHORT
};
const LABEL: Format = Format {
    digits: 4,
    zero_below: 1e-300,
    least_power: -3,
    trims: true,
};

impl Format {
    fn write(&self, value: f64) -> String {
        let magnitude = value.abs();
        if magnitude < self.zero_below {
            return "0".to_string();
        }
        let power = magnitude.log10().floor();
        if !(f64::from(self.least_power)..6.0).contains(&power) {
            let text = format!("{value:.*e}", self.digits as usize - 1);
            return match text.split_once('e') {
                Some((digits, power)) if self.trims => format!("{}e{power}", trimmed(digits)),
                _ => text,
            };
        }
        let places = (self.digits - 1 - power as i32).max(0) as usize;
        trimmed(&format!("{value:.places$}")).to_string()
    }
}

/// Without zeros after the last digit that counts.
fn trimmed(text: &str) -> &str {
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => text,
    }
}

/// Twelve significant digits: what differs in more than rounding is told apart.
pub fn precise(value: f64) -> String {
    PRECISE.write(value)
}

/// Five significant digits.
pub fn short(value: f64) -> String {
    SHORT.write(value)
}

/// Five significant digits, or `none`.
pub fn short_or_none(value: Option<f64>) -> String {
    value.map_or("none".to_string(), short)
}

/// As short as a number can be and still differ from its neighbours on an axis; four significant digits at most.
pub fn label(value: f64) -> String {
    LABEL.write(value)
}

/// A tick's number without the rounding of its multiplication, with as many digits as tell it from one that is
/// `apart` away.
pub fn tick(value: f64, apart: f64) -> String {
    let magnitude = value.abs();
    if magnitude < 1e-6 * apart || magnitude < f64::MIN_POSITIVE {
        return "0".to_string();
    }
    let last = if apart > 0.0 {
        apart.log10().floor()
    } else {
        -6.0
    };
    if !(1e-3..1e6).contains(&magnitude) {
        let digits = (magnitude.log10().floor() - last + 1.0).clamp(1.0, 15.0);
        let text = format!("{value:.*e}", digits as usize);
        return match text.split_once('e') {
            Some((digits, power)) => format!("{}e{power}", trimmed(digits)),
            None => text,
        };
    }
    let places = (1.0 - last).clamp(0.0, 15.0) as usize;
    trimmed(&format!("{value:.places$}")).to_string()
}

/// The number of a tick at its decimal logarithm, with two significant digits.
pub fn tick_of_logarithm(exponent: f64) -> String {
    let value = 10f64.powf(exponent);
    if !(1e-3..1e4).contains(&value) {
        return with_exponent(value);
    }
    let digits = (1 - (exponent + 1e-9).floor() as i32).clamp(0, 6) as usize;
    trimmed(&format!("{value:.digits$}")).to_string()
}

fn with_exponent(value: f64) -> String {
    format!("{value:.1e}").replace(".0e", "e")
}

/// A fraction in percent. Only all is 100 % and only none is 0 %.
pub fn percent(fraction: f64) -> String {
    let text = format!("{:.3}", 100.0 * fraction);
    let text = match text.as_str() {
        "100.000" if fraction < 1.0 => "99.999",
        "0.000" if fraction > 0.0 => "0.001",
        text => text,
    };
    format!("{} %", trimmed(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_written_short() {
        assert_eq!(tick(0.30000000000000004, 0.1), "0.3");
        assert_eq!(tick(-1.5e-4, 5e-5), "-1.5e-4");
        assert_eq!(tick(1e-17, 0.1), "0");
        assert_eq!(tick(200.0, 50.0), "200");
    }

    #[test]
    fn ticks_that_are_close_to_each_other_differ() {
        let ticks = |first: f64, apart: f64| {
            let ticks = (0..5).map(|index| tick(first + apart * f64::from(index), apart));
            ticks.collect::<Vec<_>>()
        };
        assert_eq!(ticks(1.2e-4, 1e-7)[1], "1.201e-4");
        assert_eq!(ticks(63.0, 1e-8)[3], "63.00000003");
        assert_eq!(ticks(2.5e7, 1.0)[4], "2.5000004e7");
        for (first, apart) in [(1.2e-4, 1e-7), (63.0, 1e-8), (2.5e7, 1.0), (1e-9, 2e-10)] {
            let mut ticks = ticks(first, apart);
            ticks.dedup();
            assert_eq!(ticks.len(), 5, "{ticks:?}");
        }
    }

    #[test]
    fn ticks_at_equal_ratios_are_written_short() {
        assert_eq!(tick_of_logarithm(-1.0), "0.1");
        assert_eq!(tick_of_logarithm(-5.0), "1e-5");
        assert_eq!(tick_of_logarithm(2.0), "100");
        assert_eq!(tick_of_logarithm(0.5), "3.2");
    }

    #[test]
    fn only_all_is_100_percent() {
        assert_eq!(percent(1.0), "100 %");
        assert_eq!(percent(0.999_999_9), "99.999 %");
        assert_eq!(percent(0.9988), "99.88 %");
        assert_eq!(percent(1e-9), "0.001 %");
        assert_eq!(percent(0.0), "0 %");
    }

    #[test]
    fn numbers_in_tables_have_five_digits_and_those_on_axes_four() {
        let values = [0.0, 0.1, -1234.5678, 1e-4, 2.5e7, f64::NAN, f64::INFINITY];
        let short_ones = ["0", "0.1", "-1234.6", "0.0001", "2.5000e7", "NaN", "inf"];
        let labels = ["0", "0.1", "-1235", "1e-4", "2.5e7", "NaN", "inf"];
        assert_eq!(values.map(short), short_ones);
        assert_eq!(values.map(label), labels);
    }
}
