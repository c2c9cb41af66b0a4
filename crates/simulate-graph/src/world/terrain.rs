//! Hills, over which paths in the plane become paths in space.

use posecut_geometry::{SE2, SE3};
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

/// Height as a sum of waves.
pub(super) struct Terrain {
    waves: Vec<Wave>,
}

/// `height sin(x along[0] + y along[1] + phase)`.
struct Wave {
    height: f64,
    along: [f64; 2],
    phase: f64,
}

/// Lengths of waves, metres.
const LENGTHS: [f64; 3] = [60.0, 25.0, 9.0];
/// The steepest slope of a wave.
const SLOPE: f64 = 0.12;

impl Terrain {
    pub(super) fn draw(random: &mut ChaCha8Rng) -> Self {
        let wave = |length: f64| {
            let number = std::f64::consts::TAU / length;
            let direction = random.random_range(0.0..std::f64::consts::TAU);
            Wave {
                height: SLOPE / number,
                along: [number * direction.cos(), number * direction.sin()],
                phase: random.random_range(0.0..std::f64::consts::TAU),
            }
        };
        Self { waves: LENGTHS.into_iter().map(wave).collect() }
    }

    /// The pose on the ground, with the ground's slope along the path as pitch and that across it as roll.
    pub(super) fn lift(&self, pose: &SE2) -> SE3 {
        let (x, y) = (pose.translation.x, pose.translation.y);
        let (mut height, mut slope) = (0.0, [0.0; 2]);
        for wave in &self.waves {
            let angle = x * wave.along[0] + y * wave.along[1] + wave.phase;
            height += wave.height * angle.sin();
            slope[0] += wave.height * wave.along[0] * angle.cos();
            slope[1] += wave.height * wave.along[1] * angle.cos();
        }
        let (sine, cosine) = pose.angle().sin_cos();
        let ahead = slope[0] * cosine + slope[1] * sine;
        let left = slope[1] * cosine - slope[0] * sine;
        SE3::from_euler(x, y, height, left.atan(), -ahead.atan(), pose.angle())
    }
}
