//! Lengths in 16 bits: `length = value * 0.005 - 100` metres.

/// Steps for each metre.
const STEPS: f64 = 200.0;

/// The length of value 0, metres.
const LOWEST: f64 = -100.0;

/// The length of a value, metres: the nearest `f64` to its millimetres, so that it prints with three digits.
pub fn length(value: u16) -> f64 {
    f64::from(i32::from(value) * 5 - 100_000) / 1000.0
}

/// The value nearest to a length, metres; the smallest or largest for lengths beyond -100 m and 227.675 m.
pub fn value(length: f64) -> u16 {
    // A cast from float to integer saturates.
    ((length - LOWEST) * STEPS).round() as u16
}
