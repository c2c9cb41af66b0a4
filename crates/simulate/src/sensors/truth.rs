//! `groundtruth_DATE.csv`.

use posecut_geometry::{LieGroup, SE3};
use posecut_random::ChaCha8Rng;

use super::{Row, six};
use crate::drive::Instant;
use crate::noise::Wander;
use crate::session::time;

/// NCLT's ground truth is itself a SLAM solution: over two seconds it differs from the odometry by a few centimetres
/// and about a hundredth of a radian. The difference changes within about a second.
const POSITION: f64 = 0.035;
const HEADING: f64 = 0.010;
const SECONDS: f64 = 1.0;

/// Number of rows of NaN at the start of NCLT's files.
const LEADING_NAN: usize = 3;

/// Poses at every instant, after some rows of NaN.
pub fn ground_truth(drive: &[Instant], start: i64, period: f64, draw: &mut ChaCha8Rng) -> Vec<Row> {
    let mut rows: Vec<Row> =
        (1..=LEADING_NAN).rev().map(|early| (start - early as i64 * 10_000, vec![f64::NAN; 6])).collect();
    let [mut x, mut y, mut z] = [(); 3].map(|()| Wander::new(draw, POSITION, SECONDS));
    let mut heading = Wander::new(draw, HEADING, SECONDS);
    rows.extend(drive.iter().map(|instant| {
        let mut next = |error: &mut Wander| error.step(draw, period);
        let error = SE3::from_euler(next(&mut x), next(&mut y), next(&mut z), 0.0, 0.0, next(&mut heading));
        (time(start, instant.seconds), six(&instant.pose.compose(&error)))
    }));
    rows
}
