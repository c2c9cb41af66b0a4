//! What the tables need of pose graphs: poses, landmark edges, and whether a map agrees with them.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context as _, bail};
use nalgebra::{Matrix3, Rotation2, Vector2};
use serde::Deserialize;
use xtask::workspace::root;

/// x, y and heading, metres and radians.
pub(super) type Pose = [f64; 3];

/// A landmark edge.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct Landmark {
    pub(super) id: u64,
    from: u64,
    to: u64,
    measurement: Pose,
    /// The upper triangle of the information matrix, of x, y and heading in the frame of the end.
    information: [f64; 6],
    #[serde(default)]
    rejected_by: Option<String>,
    #[serde(default)]
    pub(super) score: f64,
    #[serde(default)]
    pub(super) appearance: f64,
}

impl Landmark {
    pub(super) fn accepted(&self) -> bool {
        self.rejected_by.is_none()
    }
}

/// The poses of a graph by the ids of their nodes.
pub(super) struct Map {
    poses: BTreeMap<u64, Pose>,
    /// A measurement is correct within these distances of the map, metres and radians.
    tolerance: (f64, f64),
}

/// The file with the options of posecut-label that say how far a correct measurement may be off.
const TOLERANCE: &str = "pipelines/laser-tolerance";
/// In a direction with a larger standard deviation than this, metres, a measurement claims nothing, and is correct within so many of them.
const VAGUE: (f64, f64) = (0.5, 3.0);
/// Two keyframes see the same place within this distance, metres.
pub(super) const SAME_PLACE: f64 = 3.0;

#[derive(Deserialize)]
struct Node {
    id: u64,
    pose: Pose,
    #[serde(default)]
    truth: Option<Truth>,
}

#[derive(Deserialize)]
struct Truth {
    pose: Pose,
}

/// The records of a kind in a graph.
fn records<T: for<'a> Deserialize<'a>>(path: &Path, kind: &str) -> anyhow::Result<Vec<T>> {
    let place = || format!("{}: cannot be read", path.display());
    let text = std::fs::read_to_string(path).with_context(place)?;
    let start = format!("{{\"kind\":\"{kind}\"");
    let lines = text.lines().filter(|line| line.starts_with(&start));
    lines.map(|line| serde_json::from_str(line).with_context(place)).collect()
}

/// The landmark edges of a graph.
pub(super) fn landmarks(path: &Path) -> anyhow::Result<Vec<Landmark>> {
    records(path, "landmark")
}

impl Map {
    /// The map of an optimised graph.
    pub(super) fn read(path: &Path) -> anyhow::Result<Self> {
        Self::of_nodes(path, |node| Some(node.pose))
    }

    /// The ground truth that posecut-label wrote into a graph.
    pub(super) fn of_truth(path: &Path) -> anyhow::Result<Self> {
        Self::of_nodes(path, |node| node.truth.as_ref().map(|truth| truth.pose))
    }

    fn of_nodes(path: &Path, pose: impl Fn(&Node) -> Option<Pose>) -> anyhow::Result<Self> {
        let nodes: Vec<Node> = records(path, "node")?;
        let poses = nodes.iter().filter_map(|node| Some((node.id, pose(node)?))).collect();
        Ok(Self { poses, tolerance: tolerance()? })
    }

    /// The pose of the end of an edge in the frame of its start.
    fn relative(&self, edge: &Landmark) -> Option<Pose> {
        let (from, to) = (self.poses.get(&edge.from)?, self.poses.get(&edge.to)?);
        let (sine, cosine) = from[2].sin_cos();
        let (x, y) = (to[0] - from[0], to[1] - from[1]);
        Some([cosine * x + sine * y, cosine * y - sine * x, to[2] - from[2]])
    }

    /// Whether the measurement of an edge agrees with the map, in the directions that it measures.
    pub(super) fn correct(&self, edge: &Landmark) -> bool {
        let Some(pose) = self.relative(edge) else { return false };
        let measured = edge.measurement;
        let off = Vector2::new(pose[0] - measured[0], pose[1] - measured[1]);
        // The covariance is in the frame of the end.
        let off = Rotation2::new(-measured[2]) * off;
        let [xx, xy, xt, yy, yt, tt] = edge.information;
        let information = Matrix3::new(xx, xy, xt, xy, yy, yt, xt, yt, tt);
        let Some(covariance) = information.try_inverse() else { return false };
        let along = covariance.fixed_view::<2, 2>(0, 0).into_owned().symmetric_eigen();
        let mut squared = 0.0;
        for (variance, direction) in along.eigenvalues.iter().zip(along.eigenvectors.column_iter()) {
            let (error, deviation) = (direction.dot(&off).abs(), variance.max(0.0).sqrt());
            match deviation > VAGUE.0 {
                true if error > VAGUE.1 * deviation => return false,
                true => (),
                false => squared += error * error,
            }
        }
        let (sine, cosine) = (pose[2] - measured[2]).sin_cos();
        squared.sqrt() < self.tolerance.0 && sine.atan2(cosine).abs() < self.tolerance.1
    }

    /// Whether both ends of an edge are at the same place of the map.
    pub(super) fn same_place(&self, edge: &Landmark) -> bool {
        self.relative(edge).is_some_and(|pose| pose[0].hypot(pose[1]) < SAME_PLACE)
    }
}

/// How far a correct measurement may be off, metres and radians.
fn tolerance() -> anyhow::Result<(f64, f64)> {
    let text = std::fs::read_to_string(root().join(TOLERANCE)).context(TOLERANCE)?;
    let words: Vec<&str> = text.split_whitespace().collect();
    let ["--tolerance-translation", metres, "--tolerance-rotation", degrees] = words[..] else {
        bail!(
            "{TOLERANCE}: expected --tolerance-translation METRES --tolerance-rotation DEGREES, found {text}"
        );
    };
    Ok((metres.parse().context(TOLERANCE)?, degrees.parse::<f64>().context(TOLERANCE)?.to_radians()))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn map(poses: [(u64, Pose); 2]) -> Map {
        let (metres, radians) = tolerance().unwrap();
        assert!(metres == 0.5 && (radians - 0.1).abs() < 1e-4, "0.5 m and 0.1 rad, as the documents say");
        Map { poses: poses.into(), tolerance: (metres, radians) }
    }

    fn edge(measurement: Pose) -> Landmark {
        let information = [1e4, 0.0, 0.0, 1e4, 0.0, 1e5];
        Landmark {
            id: 0,
            from: 3,
            to: 7,
            measurement,
            information,
            rejected_by: None,
            score: 0.0,
            appearance: 0.0,
        }
    }

    /// The end looks along the y axis of the start, so its y axis is the negative x axis of the start.
    #[test]
    fn a_direction_that_is_not_measured_does_not_count() {
        let map = map([(3, [0.0, 0.0, 0.0]), (7, [2.0, 0.0, FRAC_PI_2])]);
        let vague =
            |measurement| Landmark { information: [1e4, 0.0, 0.0, 0.2, 0.0, 1e5], ..edge(measurement) };
        assert!(map.correct(&vague([4.0, 0.4, FRAC_PI_2])));
        assert!(!map.correct(&vague([4.0, 0.6, FRAC_PI_2])));
        assert!(!map.correct(&vague([9.0, 0.0, FRAC_PI_2])));
        assert!(!map.correct(&edge([4.0, 0.4, FRAC_PI_2])));
    }

    #[test]
    fn a_measurement_is_correct_in_the_frame_of_its_start() {
        let map = map([(3, [1.0, 2.0, FRAC_PI_2]), (7, [1.0, 4.0, -PI])]);
        assert!(map.correct(&edge([2.0, 0.0, FRAC_PI_2])));
        assert!(map.correct(&edge([2.4, 0.0, FRAC_PI_2 + 0.09])));
        assert!(map.correct(&edge([2.0, 0.0, FRAC_PI_2 - 4.0 * PI])));
        assert!(!map.correct(&edge([2.0, 0.6, FRAC_PI_2])));
        assert!(!map.correct(&edge([2.0, 0.0, FRAC_PI_2 + 0.11])));
        assert!(map.same_place(&edge([90.0, 0.0, 0.0])));
    }

    #[test]
    fn ends_that_are_far_apart_are_not_one_place() {
        let map = map([(3, [0.0, 0.0, 0.0]), (7, [2.0, 2.3, 0.0])]);
        assert!(!map.same_place(&edge([0.0, 0.0, 0.0])));
    }
}
