//! How numbers and units are written: for people with some digits, in tables of comma-separated values with all digits.

/// Digits of a quantity for people.
const DIGITS: usize = 6;
/// Powers of ten that are written without an exponent.
const ORDINARY: std::ops::Range<i32> = -3..6;

/// A number with six digits.
pub fn number(value: f64) -> String {
    rounded(value, DIGITS)
}

/// A number with so many digits; only very small and very large ones have an exponent. What is no number is a dash.
pub fn rounded(value: f64, digits: usize) -> String {
    if value == 0.0 || value.is_nan() {
        return if value.is_nan() { "–" } else { "0" }.into();
    }
    let text = format!("{value:.*e}", digits - 1);
    let power = text.rsplit('e').next().and_then(|power| power.parse::<i32>().ok());
    match power {
        Some(power) if ORDINARY.contains(&power) => {
            format!("{value:.*}", usize::try_from(digits as i32 - 1 - power).unwrap_or(0))
        }
        _ => text,
    }
}

/// A number with all its digits, at most 17, and without a sign before zero: for comma-separated values.
pub fn exact(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-5..1e17).contains(&size) => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// A change in per cent with its sign, none before zero.
pub fn percent(change: f64) -> String {
    match format!("{change:+.1}").as_str() {
        "+0.0" | "-0.0" => "0.0 %".into(),
        text => format!("{} %", text.replace('-', "−")),
    }
}

/// How many times less the end is than the start; none where the ratio says nothing: a compliance may change its sign,
/// and a deviation may vanish up to rounding.
pub fn reduction(start: f64, end: f64) -> Option<f64> {
    /// Reduction from which on the rest is rounding.
    const MEANINGLESS_REDUCTION: f64 = 1e12;
    Some(start / end).filter(|ratio| *ratio > 0.0 && *ratio < MEANINGLESS_REDUCTION)
}

/// A unit such as `MPa^{4}` in plain text, as JSON and VTK have it: `MPa^4`.
pub fn plain_unit(unit: &str) -> String {
    unit.replace(['{', '}'], "")
}

/// A unit or a formula such as `MPa^{4}` for people: MPa⁴. An exponent that is no whole number stays behind `^`.
pub fn raised(text: &str) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let plain = plain_unit(text);
    let mut parts = plain.split('^');
    let mut raised = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let power: String = part.chars().take_while(char::is_ascii_digit).collect();
        let rest = &part[power.len()..];
        if power.is_empty() || rest.starts_with('.') {
            raised += "^";
            raised += part;
        } else {
            raised.extend(power.chars().filter_map(|c| c.to_digit(10)).map(|digit| RAISED[digit as usize]));
            raised += rest;
        }
    }
    raised
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people_have_six_digits_and_no_exponent_where_none_is_needed() {
        let texts =
            [12_082.04, 0.012_345_678, 800_000.0, 99.999_999_99, 2.5e-9, 1.8e16, -0.0, 8.0779, 0.689_02].map(number);
        let expected =
            ["12082.0", "0.0123457", "800000", "100.000", "2.50000e-9", "1.80000e16", "0", "8.07790", "0.689020"];
        assert_eq!(texts, expected);
        assert_eq!((rounded(4.04e-17, 2), rounded(f64::NAN, 2)), ("4.0e-17".into(), "–".into()));
        assert_eq!([-0.04, 0.0, -10.04, 156.0].map(percent), ["0.0 %", "0.0 %", "−10.0 %", "+156.0 %"]);
    }

    #[test]
    fn numbers_of_tables_read_back_and_have_at_most_17_digits() {
        assert_eq!([-0.0, -6.28e-17, 0.1, 30.0, 1e300].map(exact), ["0", "-6.28e-17", "0.1", "30", "1e300"]);
        for value in [std::f64::consts::PI * 1e-20, f64::MIN_POSITIVE, 1.0 / 3.0, -9.999_999_999_999_999e-6, 1.7e308] {
            let text = exact(value);
            let digits = text.chars().take_while(|c| *c != 'e').filter(char::is_ascii_digit).collect::<String>();
            assert_eq!(text.parse::<f64>(), Ok(value));
            assert!(digits.trim_start_matches('0').len() <= 17, "{text}");
        }
    }

    #[test]
    fn units_have_raised_powers() {
        let units = ["MPa^{4}", "MPa", "mm^{2}", "MPa^{2.5}", "MPa^{16}", "(Σσ^4)^(1/4)"].map(raised);
        assert_eq!(units, ["MPa⁴", "MPa", "mm²", "MPa^2.5", "MPa¹⁶", "(Σσ⁴)^(1/4)"]);
    }
}
