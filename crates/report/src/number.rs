//! Numbers for people.

/// With thousands separators: `1,234,567`.
pub fn thousands(n: u64) -> String {
    group_digits(&n.to_string())
}

/// A whole number as [`thousands`], any other with up to six decimals; the same on every host.
pub fn real(x: f64) -> String {
    let sign = if x < 0.0 { "-" } else { "" };
    let text = format!("{:.6}", x.abs());
    let (whole, decimals) = text.split_once('.').unwrap_or((&text, ""));
    let decimals = decimals.trim_end_matches('0');
    let point = if decimals.is_empty() { "" } else { "." };
    format!("{sign}{}{point}{decimals}", group_digits(whole))
}

/// With `decimals` decimals: `5.00`. Below 0.1 with three significant digits, so that a small rate is not shown as 0; from 1,000 on as a
/// whole number. Exactly 0 has `decimals` decimals too.
pub fn decimal(x: f64, decimals: usize) -> String {
    let sign = if x < 0.0 { "-" } else { "" };
    let size = x.abs();
    let fixed = format!("{size:.decimals$}");
    let text = match size {
        _ if !size.is_finite() || size == 0.0 => fixed,
        _ if size < LEAST => format!("{size:.2e}"),
        _ if size < 0.1 => three_digits(size),
        // Rounded first: 999.996 is 1,000.
        _ if fixed.parse().unwrap_or(size) < 1e3 => fixed,
        _ => group_digits(&format!("{size:.0}")),
    };
    format!("{sign}{text}")
}

/// Numbers below have an exponent.
const LEAST: f64 = 1e-6;

/// A number from [`LEAST`] to 0.1, with three significant digits.
fn three_digits(x: f64) -> String {
    let exponent = format!("{x:.2e}").split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    let decimals = usize::try_from(2 - exponent).unwrap_or(0);
    format!("{x:.decimals$}")
}

/// Formats like [`real`], with about five significant digits; below 0.1 like [`decimal`].
pub fn rounded(x: f64) -> String {
    match x.abs() {
        a if a >= 1e4 => real(x.round()),
        a if a >= 10.0 => real((x * 100.0).round() / 100.0),
        a if a >= 0.1 || a == 0.0 => real((x * 1e4).round() / 1e4),
        a if a >= LEAST => without_zeros(&decimal(x, 0)),
        _ => decimal(x, 0),
    }
}

/// A number with a decimal point, without the zeros at its end.
fn without_zeros(number: &str) -> String {
    number.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Formats like [`real`], with a sign for positive numbers too.
pub fn signed(x: f64) -> String {
    if x > 0.0 { format!("+{}", real(x)) } else { real(x) }
}

/// Percent with one decimal, for tables: `12.5`. Empty for exactly 0, so that other values stand out.
pub fn percent(part: u64, whole: u64) -> String {
    match (part, whole) {
        (0, _) | (_, 0) => String::new(),
        _ => format!("{:.1}", 100.0 * part as f64 / whole as f64),
    }
}

/// A relative change in a sentence, with a sign and at most one decimal: `+12.5 %`.
pub fn change_in_words(share: f64) -> String {
    format!("{} %", signed((1000.0 * share).round() / 10.0))
}

/// Percent in a sentence: `97 %`.
pub fn percent_in_words(share: f64) -> String {
    match 100.0 * share {
        p if p <= 0.0 || p.is_nan() => "0 %".into(),
        p if p < 1.0 => "under 1 %".into(),
        p if p > 99.0 && p < 100.0 => "over 99 %".into(),
        p => format!("{p:.0} %"),
    }
}

/// Returns the distance of two ticks of an axis: the smallest of 1, 2 and 5 times a power of ten that is at least `least`, as digit and
/// exponent. `least` is positive.
pub fn round_step(least: f64) -> (u32, i32) {
    let exponent = format!("{least:e}").split_once('e').and_then(|(_, exponent)| exponent.parse().ok()).unwrap_or(0);
    let digit = [1, 2, 5].into_iter().find(|digit| round_number(*digit, exponent) >= least);
    digit.map_or((1, exponent + 1), |digit| (digit, exponent))
}

/// Returns a digit times a power of ten, exactly as the number is written. A product of the two may be a little off.
pub fn round_number(digit: u32, exponent: i32) -> f64 {
    format!("{digit}e{exponent}").parse().unwrap_or(f64::MAX)
}

/// Rounds to 6 decimals, halves away from zero.
pub fn round6(x: f64) -> f64 {
    let scaled = x * 1e6;
    if scaled.abs() < 9e15 { scaled.round() / 1e6 } else { x }
}

fn group_digits(digits: &str) -> String {
    let mut out = String::with_capacity(digits.len() * 4 / 3);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_separated() {
        let written = [0, 999, 1_000, 123_456, u64::MAX].map(thousands);
        assert_eq!(written, ["0", "999", "1,000", "123,456", "18,446,744,073,709,551,615"]);
    }

    #[test]
    fn decimals_end_where_they_say_nothing() {
        let written = [0.5, 1234.0, -1234.25, 1.0 / 3.0, 1e15].map(real);
        assert_eq!(written, ["0.5", "1,234", "-1,234.25", "0.333333", "1,000,000,000,000,000"]);
        assert_eq!([signed(2.0), signed(-2.0), signed(0.0)], ["+2", "-2", "0"]);
        let written = [223.288549, 12_345.678, 0.123456, -9.87654].map(rounded);
        assert_eq!(written, ["223.29", "12,346", "0.1235", "-9.8765"]);
    }

    #[test]
    fn small_rates_have_digits_and_large_ones_separators() {
        let written = [5.0, 0.67, 0.1, 0.05, 0.001_234_5, 0.099_99, 2e-6, 3.456e-9, 0.0].map(|x| decimal(x, 2));
        assert_eq!(written, ["5.00", "0.67", "0.10", "0.0500", "0.00123", "0.100", "0.00000200", "3.46e-9", "0.00"]);
        let written = [999.994, 999.996, 16_470.034, -16_470.5, 1e15].map(|x| decimal(x, 2));
        assert_eq!(written, ["999.99", "1,000", "16,470", "-16,470", "1,000,000,000,000,000"]);
        assert_eq!([decimal(5.0, 3), decimal(0.25, 1), decimal(-0.012, 3)], ["5.000", "0.2", "-0.0120"]);
        assert_eq!([f64::INFINITY, f64::NAN].map(|x| decimal(x, 2)), ["inf", "NaN"]);
        assert_eq!([0.001_234_5, 0.05, -0.002, 3e-9].map(rounded), ["0.00123", "0.05", "-0.002", "3.00e-9"]);
    }

    #[test]
    fn shares_are_never_rounded_to_nothing_or_to_all() {
        assert_eq!(
            [
                percent_in_words(0.0),
                percent_in_words(0.004),
                percent_in_words(0.5),
                percent_in_words(0.999),
                percent_in_words(1.0)
            ],
            ["0 %", "under 1 %", "50 %", "over 99 %", "100 %"]
        );
        assert_eq!([percent(0, 10), percent(1, 0), percent(1, 8)], ["", "", "12.5"]);
    }

    #[test]
    fn steps_of_an_axis_are_round() {
        let steps = [0.03, 1.0, 1.5, 4.2, 7.0, 13_000.0].map(round_step).map(|(digit, exponent)| round_number(digit, exponent));
        assert_eq!(steps, [0.05, 1.0, 2.0, 5.0, 10.0, 20_000.0]);
    }

    #[test]
    fn rounding_is_to_six_decimals() {
        assert_eq!(round6(1.0 / 3.0), 0.333333);
        assert_eq!(round6(-2.0 / 3.0), -0.666667);
        assert_eq!(round6(1e300), 1e300);
    }
}
