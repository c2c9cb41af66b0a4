//! TUM trajectories: `seconds x y z qx qy qz qw`, one pose a line; `#` starts a comment.

use std::fmt::Write as _;
use std::io::BufRead;

use posecut_geometry::SE2;
use posecut_graph::{Dimension, Header, Node, PoseGraph};

use crate::ConvertError;
use crate::trajectory_lines::{Layout, numbers};

/// Which poses of a graph are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Poses {
    /// The estimates
    Estimate,
    /// The ground truth
    Truth,
}

const LAYOUT: Layout =
    Layout { count: 8, described: "8 numbers (seconds x y z qx qy qz qw)", format: "TUM", comments: true };

/// Seconds as microseconds; `None` if they do not fit into 64 bits.
pub(crate) fn microseconds(seconds: f64) -> Option<i64> {
    // 2^63, the first number that is too large.
    const END: f64 = 9_223_372_036_854_775_808.0;
    let time = (seconds * 1e6).round();
    (-END..END).contains(&time).then_some(time as i64)
}

/// Reads a trajectory as a graph of dimension 3 without edges. Times must increase.
pub fn read(file: &str, reader: impl BufRead, session: &str) -> Result<PoseGraph, ConvertError> {
    let mut graph = PoseGraph::new(Header::new(Dimension::Three));
    // Time and line of the last pose.
    let mut last: Option<(i64, u64)> = None;
    for line in numbers(file, reader, &LAYOUT) {
        let (place, numbers) = line?;
        let norm = numbers[4..].iter().map(|component| component * component).sum::<f64>().sqrt();
        if (norm - 1.0).abs() > 1e-3 {
            return Err(ConvertError::line(
                file,
                place,
                format!("the quaternion has norm {norm}, not 1"),
                "the order is qx qy qz qw",
            ));
        }
        let time = microseconds(numbers[0]).ok_or_else(|| {
            let problem = format!("the time {:?} s does not fit into 64 bits of microseconds", numbers[0]);
            ConvertError::line(
                file,
                place,
                problem,
                "correct the first number of the line, the time in seconds",
            )
        })?;
        if let Some((before, line)) = last.replace((time, place))
            && time <= before
        {
            let relation = if time == before { "the same as in" } else { "before that of" };
            return Err(ConvertError::line(
                file,
                place,
                format!("the time {} s is {relation} line {line}, in microseconds", numbers[0]),
                "sort the lines by time, and keep one pose for each time",
            ));
        }
        let id = graph.nodes.len() as u64;
        graph.nodes.push(Node {
            id,
            session: Some(session.to_owned()),
            frame: Some(id as i64),
            utime: Some(time),
            pose: Some(numbers[1..].to_vec()),
            ..Node::default()
        });
    }
    Ok(graph)
}

/// Writes the nodes that have a time and a pose, in the order of time.
pub fn write(graph: &PoseGraph, poses: Poses, session: Option<&str>) -> Result<Vec<u8>, ConvertError> {
    let mut lines: Vec<(i64, Vec<f64>)> =
        spatial_poses(graph, poses, session).filter_map(|(node, pose)| Some((node.utime?, pose))).collect();
    if lines.is_empty() {
        return Err(ConvertError::graph(
            "no node has both a time (utime) and a pose of the kind that --poses selects",
            "TUM files need times; write g2o or KITTI instead",
        ));
    }
    lines.sort_by_key(|(time, _)| *time);
    let mut text = String::new();
    for (time, pose) in lines {
        text += &seconds(time);
        for number in pose {
            // Writing to a string cannot fail.
            let _ = write!(text, " {number}");
        }
        text.push('\n');
    }
    Ok(text.into_bytes())
}

/// Microseconds as seconds, exact to the last digit; a division would round.
pub(crate) fn seconds(utime: i64) -> String {
    let sign = if utime < 0 { "-" } else { "" };
    format!("{sign}{}.{:06}", utime.unsigned_abs() / 1_000_000, utime.unsigned_abs() % 1_000_000)
}

/// Nodes with the requested poses, as spatial poses.
pub(crate) fn spatial_poses<'a>(
    graph: &'a PoseGraph,
    poses: Poses,
    session: Option<&'a str>,
) -> impl Iterator<Item = (&'a Node, Vec<f64>)> + 'a {
    graph.nodes.iter().filter(move |node| session.is_none() || node.session.as_deref() == session).filter_map(
        move |node| {
            let pose = match poses {
                Poses::Estimate => node.pose.as_ref(),
                Poses::Truth => node.truth.as_ref().and_then(|truth| truth.pose.as_ref()),
            }?;
            Some((node, spatial(graph.header.dimension, pose)?))
        },
    )
}

fn spatial(dimension: Dimension, pose: &[f64]) -> Option<Vec<f64>> {
    use posecut_geometry::LieGroup as _;
    match dimension {
        Dimension::Two => Some(SE2::from_components(pose)?.to_spatial().components()),
        Dimension::Three => Some(pose.to_vec()),
    }
}
