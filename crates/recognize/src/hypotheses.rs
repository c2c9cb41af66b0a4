//! How probable a measurement is beside the others of the same keyframes.
//!
//! A keyframe is at one place. Measurements that put it at different places are rival hypotheses, of which at most one is correct, and none
//! if it sees a new place: the probability of one is its odds `o`, by its agreement alone, over the sum for all,
//!
//! ```text
//! p = o / (1 + o + sum_rivals o_r)
//! ```
//!
//! as FAB-MAP normalises over places (Cummins and Newman, IJRR 2008, equation 3). Where corridors look alike, scans agree well at many
//! places, and each of them is improbable. A robot that often passes a place has several measurements that agree: two of them are rivals
//! only if odometry contradicts them together.

use posecut_geometry::{LieGroup, SE2};

use crate::Routes;
use crate::measure::Measurement;

/// The log-odds of a correct measurement without rivals are linear in its agreement: offset and slope, fitted to intel and mit-csail with
/// their agreed maps.
const ODDS: [f64; 2] = [-10.75, 19.3];

/// Odometry contradicts two measurements that are together off by more than this distance, metres, and this share of the path between
/// them. Chosen on intel, where at 2 % passages of one place counted as rivals.
const DRIFT: [f64; 2] = [1.0, 0.05];

/// Rivals within this path length of each other are one hypothesis, metres: the likeliest counts.
const ONE_RIVAL: f64 = 6.0;

/// The odds that a measurement is correct, by its agreement alone.
pub fn odds(agreement: f64) -> f64 {
    let [offset, slope] = ODDS;
    (offset + slope * agreement).exp()
}

/// A measurement between two keyframes.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// The reference.
    pub from: usize,
    /// The query.
    pub to: usize,
    /// Where the query is in the frame of the reference.
    pub measurement: &'a Measurement,
}

/// A measurement as seen from one of its keyframes.
struct Hypothesis {
    /// The other keyframe.
    place: usize,
    /// Its pose in the frame of the one.
    pose: SE2,
    odds: f64,
}

/// For each measurement the sum of the odds of its rivals, of both keyframes. O(n m log m) with m measurements of a keyframe.
pub fn rivals(routes: &Routes, measured: &[Measured<'_>]) -> Vec<f64> {
    let mut hypotheses: Vec<Vec<Hypothesis>> = (0..routes.len()).map(|_| Vec::new()).collect();
    for &Measured { from, to, measurement } in measured {
        let odds = odds(measurement.agreement);
        hypotheses[from].push(Hypothesis { place: to, pose: measurement.pose, odds });
        hypotheses[to].push(Hypothesis { place: from, pose: measurement.pose.inverse(), odds });
    }
    for of_keyframe in &mut hypotheses {
        of_keyframe.sort_by(|one, other| routes.order(one.place, other.place));
    }
    let rivals_of = |&Measured { from, to, measurement }: &Measured<'_>| {
        competing(routes, &hypotheses[from], to, &measurement.pose)
            + competing(routes, &hypotheses[to], from, &measurement.pose.inverse())
    };
    measured.iter().map(rivals_of).collect()
}

/// The sum of the odds of the hypotheses that are incompatible with this one, the likeliest of each place.
fn competing(routes: &Routes, hypotheses: &[Hypothesis], place: usize, pose: &SE2) -> f64 {
    let mut sum = 0.0;
    let mut group: Option<(usize, f64)> = None;
    for other in hypotheses {
        let length = routes.path_length(place, other.place);
        // Of keyframes of different routes, odometry knows nothing.
        if other.place == place || length.is_infinite() {
            continue;
        }
        let off = routes.between(place, other.place).between(&pose.between(&other.pose)).translation.norm();
        if off < DRIFT[0] + DRIFT[1] * length {
            continue;
        }
        group = match group {
            Some((first, most)) if routes.path_length(first, other.place) <= ONE_RIVAL => {
                Some((first, most.max(other.odds)))
            }
            _ => {
                sum += group.map_or(0.0, |(_, most)| most);
                Some((other.place, other.odds))
            }
        };
    }
    sum + group.map_or(0.0, |(_, most)| most)
}
