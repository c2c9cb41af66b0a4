//! Python's random numbers.
//!
//! The measured instances were first drawn by Python scripts. The same generator keeps the instances the same, so that
//! old measurements remain comparable with new ones.

use rand_mt::Mt;

/// Python's `random.Random`.
pub(crate) struct Twister {
    words: Mt,
    /// The second normal deviate of a pair, if it is unused.
    second: Option<f64>,
}

impl Twister {
    pub(crate) fn new(seed: u32) -> Self {
        Self { words: Mt::new_with_key([seed]), second: None }
    }

    /// A number from 0 to below 1, with 53 random bits.
    pub(crate) fn random(&mut self) -> f64 {
        let (high, low) = (self.words.next_u32() >> 5, self.words.next_u32() >> 6);
        (f64::from(high) * f64::from(1 << 26) + f64::from(low)) / (1_u64 << 53) as f64
    }

    /// A uniform number between two bounds.
    pub(crate) fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.random()
    }

    /// A whole number below a bound, which must not be 0.
    pub(crate) fn below(&mut self, bound: u32) -> u32 {
        // Python draws as many bits as the bound has, and rejects values that are too large.
        let spare = bound.leading_zeros();
        loop {
            let value = self.words.next_u32() >> spare;
            if value < bound {
                return value;
            }
        }
    }

    /// A normal number with mean 0 (Box and Muller).
    pub(crate) fn normal(&mut self, deviation: f64) -> f64 {
        let value = self.second.take().unwrap_or_else(|| {
            let angle = std::f64::consts::TAU * self.random();
            let radius = (-2.0 * (1.0 - self.random()).ln()).sqrt();
            self.second = Some(angle.sin() * radius);
            angle.cos() * radius
        });
        value * deviation
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_python() {
        // random.Random(1): random(), random(), randrange(5), randrange(1000), uniform(-1, 1)
        let mut draw = Twister::new(1);
        assert_eq!(draw.random(), 0.134_364_244_112_401_22);
        assert_eq!(draw.random(), 0.847_433_736_937_232_7);
        assert_eq!((draw.below(5), draw.below(1000)), (0, 261));
        assert_eq!(draw.uniform(-1.0, 1.0), -0.764_162_592_657_877_9);
        // random.Random(2): gauss(0, 0.5) three times
        let mut draw = Twister::new(2);
        for value in [1.169_083_368_087_951, -0.331_426_954_033_410_4, 0.197_429_810_615_581_5] {
            assert!((draw.normal(0.5) - value).abs() < 1e-15);
        }
    }
}
