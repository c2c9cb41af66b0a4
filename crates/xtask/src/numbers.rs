//! Formats numbers for tables.

/// A number with this many significant digits and no trailing zeros, in scientific notation if that is shorter (C's
/// `%g`).
pub(crate) fn general(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return value.to_string().to_lowercase();
    }
    let digits = digits.max(1);
    let scientific = format!("{value:.*e}", digits - 1);
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    let exponent: i32 = exponent.parse().unwrap_or_default();
    if (-4..digits as i32).contains(&exponent) {
        return without_zeros(&format!("{value:.*}", (digits as i32 - 1 - exponent) as usize)).to_owned();
    }
    format!("{}{}", without_zeros(mantissa), written(exponent))
}

/// A number in scientific notation with this many decimals (C's `%e`).
pub(crate) fn scientific(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => format!("{mantissa}{}", written(exponent.parse().unwrap_or_default())),
        None => text.to_lowercase(),
    }
}

fn written(exponent: i32) -> String {
    format!("e{}{:02}", if exponent < 0 { '-' } else { '+' }, exponent.abs())
}

fn without_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A whole number with commas between thousands.
pub(crate) fn thousands(value: u64) -> String {
    let digits = value.to_string();
    let first = (digits.len() + 2) % 3 + 1;
    let groups = digits.as_bytes()[first..].chunks(3).map(String::from_utf8_lossy);
    groups.fold(digits[..first].to_owned(), |text, group| text + "," + &group)
}

/// The median: the middle value, or the mean of the middle two.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut ordered = values.to_vec();
    ordered.sort_by(f64::total_cmp);
    let middle = ordered.len() / 2;
    match ordered.as_slice() {
        [] => f64::NAN,
        all if all.len() % 2 == 1 => all[middle],
        all => f64::midpoint(all[middle - 1], all[middle]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_in_c() {
        // printf '%.10g %.10g …'
        for (value, digits, text) in [
            (0.0, 10, "0"),
            (-14786.0058, 10, "-14786.0058"),
            (-37.604_006_05, 10, "-37.60400605"),
            (1129.6, 3, "1.13e+03"),
            (2.13, 3, "2.13"),
            (0.000_012_34, 3, "1.23e-05"),
            (0.000_123_4, 3, "0.000123"),
            (999.9, 3, "1e+03"),
            (100.0, 2, "1e+02"),
            (99.4, 2, "99"),
            (137.914_878_247_05, 12, "137.914878247"),
            (f64::INFINITY, 3, "inf"),
        ] {
            assert_eq!(general(value, digits), text);
        }
        assert_eq!(scientific(3.24e-4, 1), "3.2e-04");
        assert_eq!(scientific(-1e-12, 0), "-1e-12");
        assert_eq!(scientific(12.0, 0), "1e+01");
    }

    #[test]
    fn thousands_have_commas() {
        for (value, text) in
            [(0, "0"), (999, "999"), (1000, "1,000"), (300_000, "300,000"), (1_000_000, "1,000,000")]
        {
            assert_eq!(thousands(value), text);
        }
    }

    #[test]
    fn the_median_is_in_the_middle() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&[]).is_nan());
    }
}
