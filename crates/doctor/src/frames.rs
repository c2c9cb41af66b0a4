//! Given poses: whether there are any, what made them, whether they and the measurements have one convention, and the axes.
//!
//! - [`convention`]: measurements in the wrong direction or in other units than the poses.
//! - [`axes`]: which axis is up, and planar data in space.

mod axes;
mod convention;

use posecut_geometry::LieGroup;
use posecut_graph::for_dimension;

use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Seen, Survey};
use crate::words::{counted, figure};

/// Costs per degree of freedom. Below the first, poses follow edges exactly. So they do below the second, with printed poses and
/// narrow covariances, unless they fit the landmark edges too. Below the third, poses fit edges.
const EXACT: f64 = 1e-6;
const NEARLY_EXACT: f64 = 1e-3;
const FITTED: f64 = 10.0;

pub(crate) fn check(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    let nodes = &survey.graph.nodes;
    let posed = nodes.iter().filter(|node| node.pose.is_some()).count();
    if nodes.is_empty() {
        return;
    }
    found.push(poses(survey, posed));
    let has_poses = posed == nodes.len();
    if has_poses {
        found.extend(convention::check(survey));
    }
    found.extend(axes::check(survey, has_poses));
}

fn poses(survey: &Survey<'_>, posed: usize) -> Finding {
    let nodes = survey.graph.nodes.len();
    let found = |severity, title: String| {
        Finding::new(severity, Topic::Frames, "poses", title).with("nodes", nodes).with("with_pose", posed)
    };
    if posed == 0 {
        return found(Severity::Note, "no poses are given: the optimiser starts from the edges".to_owned());
    }
    if posed < nodes {
        let title = format!("{posed} of {} have a pose", counted(nodes, "node"));
        return found(Severity::Warning, title).therefore(
            "poses are a start for the optimiser only if every node has one; pictures lack the others",
            "write a pose for every node, or for none; posecut-optimize computes all of them",
        );
    }
    if nodes > 1 && same_everywhere(survey) {
        let title = format!("all {} have the same pose", counted(nodes, "node"));
        return found(Severity::Note, title)
            .therefore("these poses are placeholders; the optimiser starts from the edges", "");
    }
    for_dimension!(survey.graph.header.dimension, |G, DOF| {
        let odometry = cost::<G, DOF>(survey, &survey.odometry);
        let landmark = cost::<G, DOF>(survey, &survey.landmark);
        found(Severity::Note, origin(odometry, landmark))
            .with("odometry_cost_per_freedom", odometry)
            .with("landmark_cost_per_freedom", landmark)
    })
}

fn same_everywhere(survey: &Survey<'_>) -> bool {
    let nodes = &survey.graph.nodes;
    nodes.iter().all(|node| node.pose == nodes[0].pose)
}

/// What made the poses, by their costs.
fn origin(odometry: Option<f64>, landmark: Option<f64>) -> String {
    let shown = |what: &str, cost: Option<f64>| {
        let cost = cost?;
        Some(format!("{what} {}", if cost < EXACT { "0".to_owned() } else { figure(cost) }))
    };
    let costs: Vec<String> =
        [shown("odometry", odometry), shown("landmark edges", landmark)].into_iter().flatten().collect();
    let costs = match costs.as_slice() {
        [] => String::new(),
        costs => format!(" (cost per degree of freedom: {})", costs.join(", ")),
    };
    let what = match (odometry, landmark) {
        (Some(odometry), _) if odometry < EXACT => "the given poses are dead reckoning",
        (Some(odometry), landmark)
            if odometry < NEARLY_EXACT && landmark.is_none_or(|cost| cost > FITTED) =>
        {
            "the given poses are dead reckoning"
        }
        (Some(odometry), Some(landmark)) if odometry < FITTED && landmark < FITTED => {
            "the given poses fit odometry and landmark edges, as after optimisation"
        }
        (Some(odometry), _) if odometry < FITTED => {
            "the given poses fit the odometry, but not all landmark edges"
        }
        (Some(_), _) => "the given poses do not fit the odometry",
        _ => "poses are given",
    };
    what.to_owned() + &costs
}

/// The mean cost of edges at the given poses, per degree of freedom; `None` without edges.
fn cost<G: LieGroup<DOF>, const DOF: usize>(survey: &Survey<'_>, edges: &[Seen<'_>]) -> Option<f64> {
    let graph = survey.graph;
    let pose = |node: usize| G::from_components(graph.nodes[node].pose.as_deref()?);
    let (mut sum, mut count) = (0.0, 0_usize);
    for edge in edges {
        let Some((motion, information)) = graph.measurement::<G, DOF>(edge.edge).ok().flatten() else {
            continue;
        };
        let (Some(from), Some(to)) = (pose(edge.ends.0), pose(edge.ends.1)) else { continue };
        let error = motion.between(&from.between(&to)).log();
        sum += error.dot(&(information * error));
        count += 1;
    }
    (count > 0 && sum.is_finite()).then(|| sum / (count * DOF) as f64)
}
