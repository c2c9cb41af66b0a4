//! True motions between pairs of times.

use std::io::Write;

use posecut_carmen::seconds;
use posecut_geometry::{LieGroup, SE2};

/// Successive poses of the pairs are this far apart, metres or radians.
const SPACING: f64 = 0.5;

/// Poses that meet again are at most this far apart, metres, and this long after each other, microseconds.
const NEAR: f64 = 2.0;
const LATER: i64 = 60_000_000;

/// A motion between two times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relation {
    /// The times, microseconds.
    pub times: [i64; 2],
    /// The second pose in the frame of the first.
    pub motion: SE2,
}

/// Relations between successive poses half a metre or half a radian apart, and between each such pose and the first of an earlier visit
/// that is near. O((length / spacing)^2).
pub fn relations(times: &[i64], poses: &[SE2]) -> Vec<Relation> {
    let mut chosen: Vec<usize> = Vec::new();
    for (index, pose) in poses.iter().enumerate() {
        let far = |last: &usize| {
            let motion = poses[*last].between(pose);
            motion.translation.norm() >= SPACING || motion.angle().abs() >= SPACING
        };
        if chosen.last().is_none_or(far) {
            chosen.push(index);
        }
    }
    let relation = |one: usize, other: usize| Relation {
        times: [times[one], times[other]],
        motion: poses[one].between(&poses[other]),
    };
    let mut relations: Vec<Relation> = chosen.windows(2).map(|pair| relation(pair[0], pair[1])).collect();
    for &later in &chosen {
        let earlier = chosen.iter().copied().find(|&earlier| {
            times[later] - times[earlier] > LATER
                && (poses[later].translation - poses[earlier].translation).norm() < NEAR
        });
        relations.extend(earlier.map(|earlier| relation(earlier, later)));
    }
    relations
}

/// Writes relations, a line `t1 t2 x y z roll pitch yaw` each, in seconds, metres and radians.
pub fn write_relations(relations: &[Relation], writer: &mut dyn Write) -> std::io::Result<()> {
    for Relation { times, motion } in relations {
        let [first, second] = times.map(seconds);
        let (x, y, yaw) = (motion.translation.x, motion.translation.y, motion.angle());
        writeln!(writer, "{first} {second} {x:.6} {y:.6} 0.000000 0.000000 0.000000 {yaw:.6}")?;
    }
    Ok(())
}
