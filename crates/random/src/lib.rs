//! Random numbers that a seed fixes on every machine.

use rand::SeedableRng;

// Re-exported, so that callers need no dependency of their own.
pub use rand;
pub use rand_chacha::ChaCha8Rng;

/// A ChaCha8 generator for one purpose. Each purpose has a stream of its own: drawing more for one (a higher rate of false
/// edges, say) does not change the numbers of another (the noise of the true ones).
pub fn random(seed: u64, purpose: &str) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    // FNV-1a never changes, unlike the standard library's hash.
    let stream = purpose.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    generator.set_stream(stream);
    generator
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng as _;

    #[test]
    fn a_seed_and_a_purpose_fix_the_numbers() {
        assert_eq!(random(7, "noise").next_u64(), random(7, "noise").next_u64());
        assert_ne!(random(7, "noise").next_u64(), random(8, "noise").next_u64());
        assert_ne!(random(7, "noise").next_u64(), random(7, "incorrect edges").next_u64());
    }

    #[test]
    fn the_first_number_is_the_same_on_every_machine() {
        // This value was printed by the test once. A change would silently change every published result.
        assert_eq!(random(1, "noise").next_u64(), 13_670_758_585_516_955_643);
    }
}
