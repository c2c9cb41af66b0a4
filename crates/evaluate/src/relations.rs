//! Errors of relative motions that somebody measured by hand (Kuemmerle et al., *On measuring the accuracy of SLAM algorithms*,
//! Autonomous Robots 27, 2009).
//!
//! A relation says that the robot at time `t2` was at `d*` in the frame of the robot at time `t1`. With the motion `d` of the estimate
//! between the same times, its error is `e = d*^-1 d`. The measure is the mean and the standard deviation of the length of the
//! translation of `e` and of the angle of its rotation (equation 3 of the paper, without its squares, as in its tables).
//!
//! A graph has poses at keyframes only. Between two keyframes of a session the estimate is interpolated: along the geodesic by time,
//! or along a [`Track`] that the log has at each scan. With poses `X` of the estimate and `P` of the track at the keyframes `a`, `b` and
//! at the time,
//!
//! ```text
//! X_t = X_a (P_a^-1 P_t) Exp(s log((P_a^-1 P_b)^-1 (X_a^-1 X_b)))
//! ```
//!
//! where `s` is the share of the path from `a` to `b` that lies before `t`.

mod reading;
mod track;

use posecut_geometry::{LieGroup, SE3};
use posecut_graph::PoseGraph;
use serde::Serialize;

use crate::summary::Summary;

pub use reading::{Relation, RelationError, relations};
pub use track::Track;

/// How far the relative motions of an estimate are from measured ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RelationErrors {
    /// Relations compared.
    pub compared: usize,
    /// Relations with a time at which the estimate has no pose.
    pub skipped: usize,
    /// How poses between keyframes were found: `geodesic` or `trajectory`.
    pub interpolation: &'static str,
    /// Lengths of the errors' translations, metres.
    pub translation_m: Option<Summary>,
    /// Angles of the errors' rotations, radians.
    pub rotation_rad: Option<Summary>,
}

/// Compares an estimate with relations. A time up to `tolerance` seconds before the first or after the last keyframe of a session has
/// the pose of that keyframe. O((nodes + relations) log nodes).
pub fn relation_errors(
    estimate: &PoseGraph,
    relations: &[Relation],
    track: Option<&Track>,
    tolerance: f64,
) -> RelationErrors {
    let keyframes = Keyframes::of(estimate, track, (tolerance * 1e6) as i64);
    let (mut distances, mut angles) = (Vec::new(), Vec::new());
    for relation in relations {
        let Some((first, last)) = keyframes.at(relation.times[0]).zip(keyframes.at(relation.times[1])) else {
            continue;
        };
        let error = relation.motion.between(&first.between(&last));
        distances.push(error.translation.norm());
        angles.push(error.rotation.angle());
    }
    RelationErrors {
        compared: distances.len(),
        skipped: relations.len() - distances.len(),
        interpolation: if track.is_some() { "trajectory" } else { "geodesic" },
        translation_m: Summary::of(&distances),
        rotation_rad: Summary::of(&angles),
    }
}

/// Times and poses of the nodes of a session, in the order of time.
struct Session {
    times: Vec<i64>,
    poses: Vec<SE3>,
}

struct Keyframes<'a> {
    sessions: Vec<Session>,
    track: Option<&'a Track>,
    tolerance: i64,
}

impl<'a> Keyframes<'a> {
    fn of(graph: &PoseGraph, track: Option<&'a Track>, tolerance: i64) -> Self {
        let dimension = graph.header.dimension;
        let mut names: Vec<Option<&str>> = graph.nodes.iter().map(|node| node.session.as_deref()).collect();
        names.sort_unstable();
        names.dedup();
        let session = |name: Option<&str>| {
            let mut timed: Vec<(i64, SE3)> = graph
                .nodes
                .iter()
                .filter(|node| node.session.as_deref() == name)
                .filter_map(|node| Some((node.utime?, dimension.spatial(node.pose.as_deref()?)?)))
                .collect();
            timed.sort_by_key(|(time, _)| *time);
            timed.dedup_by_key(|(time, _)| *time);
            let (times, poses) = timed.into_iter().unzip();
            Session { times, poses }
        };
        let sessions: Vec<Session> = names.into_iter().map(session).collect();
        Self { sessions, track, tolerance }
    }

    /// The pose at a time: of the session that has keyframes before and after it, or else of the one whose end is nearest.
    fn at(&self, time: i64) -> Option<SE3> {
        let inside = |session: &&Session| {
            session.times.first().is_some_and(|first| *first <= time)
                && session.times.last().is_some_and(|last| time <= *last)
        };
        if let Some(session) = self.sessions.iter().find(inside) {
            return Some(self.between(session, time));
        }
        let ends = |session: &'_ Session| {
            [0, session.times.len().checked_sub(1)?].map(|at| (session.times[at], session.poses[at])).into()
        };
        let near = self.sessions.iter().filter_map(ends).flat_map(|ends: [(i64, SE3); 2]| ends);
        let (end, pose) = near.min_by_key(|(end, _)| end.abs_diff(time))?;
        if end.abs_diff(time) > self.tolerance.unsigned_abs() {
            return None;
        }
        let moved = self.track.and_then(|track| Some(track.at(end)?.between(&track.at(time)?)));
        Some(moved.map_or(pose, |moved| pose.compose(&moved)))
    }

    fn between(&self, session: &Session, time: i64) -> SE3 {
        let after = session.times.partition_point(|&stamp| stamp < time);
        if session.times[after] == time {
            return session.poses[after];
        }
        let (before, after) = (after - 1, after);
        let times = [session.times[before], time, session.times[after]];
        let ends = [session.poses[before], session.poses[after]];
        if let Some(track) = self.track
            && let [Some(first), Some(now), Some(last)] = times.map(|time| track.at(time))
        {
            let misfit = first.between(&last).between(&ends[0].between(&ends[1]));
            let ways = [(first, now), (now, last)].map(|(one, other)| length(&one.between(&other)));
            let share = ways[0] / (ways[0] + ways[1]).max(f64::MIN_POSITIVE);
            return ends[0].compose(&first.between(&now)).compose(&SE3::exp(&(misfit.log() * share)));
        }
        let share = (times[1] - times[0]) as f64 / (times[2] - times[0]) as f64;
        ends[0].interpolate(&ends[1], share)
    }
}

/// The size of a motion, with a radian as a metre.
fn length(motion: &SE3) -> f64 {
    motion.translation.norm() + motion.rotation.angle()
}
