//! Whether the printed digits of an information matrix distinguish it from a singular one.

use posecut_graph::{Dimension, negative_eigenvalue};

/// Whether some matrix within the rounding of these printed terms is singular, that is, whether the smallest eigenvalue
/// is no larger than the possible effect of rounding. By Weyl's inequality an eigenvalue changes by no more than the
/// norm of the change, which is no more than its largest row sum. O(terms).
///
/// `fields` are the terms of the upper triangle as printed, `packed` their values.
pub(crate) fn leave_singularity_open(dimension: Dimension, fields: &[&str], packed: &[f64]) -> bool {
    let rounding = roundings(fields);
    let side = dimension.degrees_of_freedom();
    let places = || (0..side).flat_map(|row| (row..side).map(move |column| (row, column)));
    let mut rows = vec![0.0; side];
    for ((row, column), term) in places().zip(&rounding) {
        rows[row] += term;
        if column > row {
            rows[column] += term;
        }
    }
    // The largest row sum bounds the norm of the rounding errors.
    let shift = rows.into_iter().fold(0.0, f64::max);
    if shift == 0.0 {
        return false;
    }
    // Subtracting a multiple of the identity lowers every eigenvalue by that multiple.
    let lowered: Vec<f64> = places()
        .zip(packed)
        .map(|((row, column), term)| if row == column { term - shift } else { *term })
        .collect();
    negative_eigenvalue(dimension, &lowered).is_some()
}

/// The rounding of each term: half a unit of its last printed digit.
///
/// If all terms have the same number of decimals (`%f`), that is the last decimal. Otherwise all terms have the same
/// number of significant digits (`%g`, which omits trailing zeros): that of the longest term. If all terms are whole
/// numbers, they are exact; zero is always exact.
fn roundings(fields: &[&str]) -> Vec<f64> {
    let decimals = |field: &&str| {
        let (mantissa, _) = field.split_once(['e', 'E']).unwrap_or((field, ""));
        mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len())
    };
    let has_exponent = fields.iter().any(|field| field.contains(['e', 'E']));
    let first = fields.first().map_or(0, decimals);
    if !has_exponent && fields.iter().all(|field| decimals(field) == first) {
        let half = if first == 0 { 0.0 } else { half_unit(-(first as f64)) };
        return vec![half; fields.len()];
    }
    let longest = fields.iter().map(|field| significant_digits(field)).max().unwrap_or(0);
    fields
        .iter()
        .map(|field| field.parse::<f64>().map_or(0.0, f64::abs))
        .map(|size| if size > 0.0 { half_unit(size.log10().floor() + 1.0 - longest as f64) } else { 0.0 })
        .collect()
}

fn half_unit(exponent: f64) -> f64 {
    0.5 * 10.0_f64.powf(exponent)
}

/// The number of digits from the first that is not zero to the last printed one, without the trailing zeros of a whole
/// number.
fn significant_digits(field: &str) -> usize {
    let mantissa = field.split_once(['e', 'E']).map_or(field, |(mantissa, _)| mantissa);
    let digits: String = mantissa.chars().filter(char::is_ascii_digit).collect();
    let digits = digits.trim_start_matches('0');
    if mantissa.contains('.') { digits.len() } else { digits.trim_end_matches('0').len() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_open(text: &str) -> bool {
        let fields: Vec<&str> = text.split_whitespace().collect();
        let packed: Vec<f64> = fields.iter().map(|field| field.parse().unwrap()).collect();
        leave_singularity_open(Dimension::Two, &fields, &packed)
    }

    #[test]
    fn the_last_digit_tells_what_is_known() {
        // The smallest eigenvalue of the first block is 1e-6: half a unit of the sixth decimal could make it zero, half
        // a unit of the eighth could not.
        assert!(is_open("1.000000 0.999999 0.000000 1.000000 0.000000 1.000000"));
        assert!(!is_open("1.00000000 0.99999900 0.00000000 1.00000000 0.00000000 1.00000000"));
        assert!(is_open("1 0.999999 0 1 0 1"), "six significant digits, trailing zeros left out");
        assert!(!is_open("1 0.99999900 0 1 0 1"), "eight digits");
        assert!(!is_open("1 0 0 1 0 1") && !is_open("4000000 0 0 1 0 1"), "whole numbers are exact");
        assert!(
            !is_open("1000000.5 0 0 0.25 0 1"),
            "zeros are exact, and large terms leave small blocks alone"
        );
        assert!(is_open("2.5e-3 2.49999e-3 0 2.5e-3 0 7"));
    }

    #[test]
    fn roundings_are_half_a_unit_of_the_last_digit() {
        let close = |found: Vec<f64>, expected: &[f64]| {
            found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-12 * b)
        };
        assert!(close(roundings(&["11.111271", "-0.249667"]), &[5e-7, 5e-7]));
        assert!(close(roundings(&["1", "4.00073", "-8.5017e-05", "0"]), &[5e-6, 5e-6, 5e-11, 0.0]));
        assert_eq!(significant_digits("-0.0120"), 3);
        assert_eq!(significant_digits("120"), 2);
    }
}
