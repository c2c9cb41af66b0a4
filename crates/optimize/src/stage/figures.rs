//! Numbers in messages.

/// Significant digits.
const DIGITS: i32 = 6;

/// A cost in six significant digits, without trailing zeros: `912.192`, `9.12192e-10`, `0`.
pub fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return if value == 0.0 { "0".to_owned() } else { value.to_string() };
    }
    // The exponent is taken after rounding: 999999.7 rounds to a number with one digit more.
    let scientific = format!("{value:.*e}", (DIGITS - 1) as usize);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let short = |text: &str| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text.to_owned()
        }
    };
    if (-4..DIGITS).contains(&exponent) {
        short(&format!("{value:.*}", (DIGITS - 1 - exponent).max(0) as usize))
    } else {
        format!("{}e{exponent}", short(mantissa))
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn costs_have_six_significant_digits() {
        let cases = [
            (0.0, "0"),
            (912.191_624_430, "912.192"),
            (9.121_916e-10, "9.12192e-10"),
            (1.268_384_8, "1.26838"),
            (2_988_337.5, "2.98834e6"),
            (999_999.7, "1e6"),
            (24235.2737, "24235.3"),
            (0.000_25, "0.00025"),
            (1.0, "1"),
            (120.0, "120"),
        ];
        for (value, text) in cases {
            assert_eq!(significant(value), text);
        }
    }
}
