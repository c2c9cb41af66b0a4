//! Encodes series of numbers as short text. Values are rounded to a step, and differences of successive values are
//! stored in as few bytes as possible (7 bits a byte, lowest first; signs by zigzag encoding), in base 64.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use sha2::{Digest as _, Sha256};

/// Encodes values rounded to multiples of `step`. Rounding errors do not accumulate, because differences are taken
/// between rounded values.
pub fn series(values: impl IntoIterator<Item = f64>, step: f64) -> String {
    differences(values.into_iter().map(|value| (value / step).round() as i64))
}

/// Encodes whole numbers.
pub fn differences(values: impl IntoIterator<Item = i64>) -> String {
    let mut bytes = Vec::new();
    let mut last = 0_i64;
    for value in values {
        let difference = value.wrapping_sub(last);
        last = value;
        // Zigzag maps 0, -1, 1, -2 to 0, 1, 2, 3, so that small differences of either sign stay small.
        let mut rest = ((difference << 1) ^ (difference >> 63)) as u64;
        while rest >= 0x80 {
            bytes.push((rest & 0x7f) as u8 | 0x80);
            rest >>= 7;
        }
        bytes.push(rest as u8);
    }
    STANDARD.encode(bytes)
}

/// Encodes truth values, eight a byte, lowest bit first.
pub fn bits(values: impl IntoIterator<Item = bool>) -> String {
    let mut bytes = Vec::new();
    for (index, value) in values.into_iter().enumerate() {
        if index % 8 == 0 {
            bytes.push(0_u8);
        }
        if let (true, Some(byte)) = (value, bytes.last_mut()) {
            *byte |= 1 << (index % 8);
        }
    }
    STANDARD.encode(bytes)
}

/// Whole numbers of 64 bits. Scripts count exactly to 2^53 only, so larger numbers are marked.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Whole {
    series: String,
    /// Whether a script needs more than a double: `unsigned`, `signed`, or absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    wide: Option<&'static str>,
}

/// The largest whole number up to which a script counts exactly, 2^53.
const EXACT: u64 = 1 << 53;

impl Whole {
    /// Encodes ids.
    pub fn of(values: &[u64]) -> Self {
        let wide = values.iter().any(|value| *value > EXACT).then_some("unsigned");
        Self { series: differences(values.iter().map(|value| *value as i64)), wide }
    }

    /// Encodes numbers that may be negative.
    pub fn of_signed(values: &[i64]) -> Self {
        let wide = values.iter().any(|value| value.unsigned_abs() > EXACT).then_some("signed");
        Self { series: differences(values.iter().copied()), wide }
    }
}

/// The SHA-256 of a text in the notation of content security policies.
pub fn policy_digest(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}

/// Decodes [`series`], as the page's script does.
pub fn decoded(text: &str, step: f64) -> Option<Vec<f64>> {
    let bytes = STANDARD.decode(text).ok()?;
    let mut values = Vec::new();
    let (mut last, mut rest, mut shift) = (0_i64, 0_u64, 0);
    for byte in bytes {
        rest |= u64::from(byte & 0x7f) << shift;
        shift += 7;
        if byte < 0x80 {
            last += ((rest >> 1) as i64) ^ -((rest & 1) as i64);
            values.push(last as f64 * step);
            (rest, shift) = (0, 0);
        }
    }
    Some(values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_encoded_is_read_back_to_half_a_step(
            values in proptest::collection::vec(-1e6_f64..1e6, 0..50),
        ) {
            let back = decoded(&series(values.iter().copied(), 0.1), 0.1).unwrap();
            prop_assert_eq!(back.len(), values.len());
            for (value, back) in values.iter().zip(back) {
                prop_assert!((value - back).abs() <= 0.05 + 1e-9);
            }
        }
    }

    #[test]
    fn small_steps_take_a_byte_each() {
        assert_eq!(series([0.0, 0.1, -0.1], 0.1), STANDARD.encode([0, 2, 3]));
        assert_eq!(
            bits([true, false, false, false, false, false, false, false, true]),
            STANDARD.encode([1, 1])
        );
    }

    #[test]
    fn digests_are_those_of_the_policy() {
        // The digest of the empty text, as browsers print it.
        assert_eq!(policy_digest(""), "'sha256-47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU='");
    }
}
