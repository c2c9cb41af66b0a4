//! The axes of a spatial map.

use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::Dimension;
use posecut_pcm::chain::{Chains, Covariances};

use crate::finding::{Finding, Severity, Topic};
use crate::survey::Survey;
use crate::words::figure;

/// The extent along the vertical axis of a map, as a share of the next larger one.
const FLAT: f64 = 0.3;
/// The same for a map without any height: rounding of printed numbers.
const PLANAR: f64 = 1e-3;

pub(super) fn check(survey: &Survey<'_>, has_poses: bool) -> Option<Finding> {
    if survey.graph.header.dimension != Dimension::Three {
        return None;
    }
    let (positions, whose) = if has_poses {
        (given(survey), "given poses")
    } else {
        (reckoned(survey)?, "dead reckoning of the longest chain")
    };
    let extent = |axis: usize| {
        let values = positions.iter().map(|position| position[axis]);
        let (least, most) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
            (f64::min(least, value), f64::max(most, value))
        });
        most - least
    };
    let extents = [extent(0), extent(1), extent(2)];
    let mut order = [0, 1, 2];
    order.sort_by(|&one: &usize, &other| extents[one].total_cmp(&extents[other]));
    let [up, middle, _] = order;
    if !(extents[middle] > 0.0 && extents[middle].is_finite()) {
        return None;
    }
    let name = ["x", "y", "z"][up];
    let shown = format!("x {} m, y {} m, z {} m", figure(extents[0]), figure(extents[1]), figure(extents[2]));
    let share = extents[up] / extents[middle];
    let found = |name, title: String| {
        Finding::new(Severity::Note, Topic::Frames, name, title)
            .with("extents", extents)
            .with("up", (share < FLAT).then_some(["x", "y", "z"][up]))
    };
    Some(if share < PLANAR {
        let title = format!(
            "planar data in a spatial graph: {name} varies by {} m only ({shown})",
            figure(extents[up])
        );
        found("planar-data", title).therefore(
            "a planar graph is smaller and faster to judge",
            "posecut convert --dimension 2 projects trajectories; edges must be projected by the program that writes them",
        )
    } else if share < FLAT {
        found("up-axis", format!("{name} is up by the extents of the {whose}: {shown}"))
    } else {
        found("no-up-axis", format!("no axis is up by the extents of the {whose}: {shown}"))
    })
}

fn given(survey: &Survey<'_>) -> Vec<[f64; 3]> {
    let dimension = survey.graph.header.dimension;
    let pose = |pose: &Vec<f64>| dimension.spatial(pose).map(|pose| pose.translation());
    survey.graph.nodes.iter().filter_map(|node| node.pose.as_ref().and_then(pose)).collect()
}

fn reckoned(survey: &Survey<'_>) -> Option<Vec<[f64; 3]>> {
    let chains = Chains::<SE3, 6>::with(survey.graph, Covariances::Ignored).ok()?;
    // The first of the longest.
    let longest = chains.chains.iter().rev().max_by_key(|chain| chain.poses.len())?;
    Some(longest.poses.iter().map(SE3::translation).collect())
}
