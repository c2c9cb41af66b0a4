//! Draws the trajectories of sessions: the paper's figure of the environment.

use std::collections::BTreeMap;

use posecut_graph::PoseGraph;

use super::{Frame, Panel, Polyline, colours};

/// One panel a graph, with one line a session: the ground truth if known, otherwise the estimate.
pub fn panels(graphs: &[(String, PoseGraph)], frame: Frame) -> Vec<Panel> {
    graphs
        .iter()
        .map(|(name, graph)| {
            let mut sessions: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
            for node in &graph.nodes {
                let truth = node.truth.as_ref().and_then(|truth| truth.pose.as_ref());
                if let Some(pose) = truth.or(node.pose.as_ref()) {
                    let session = node.session.clone().unwrap_or_default();
                    sessions.entry(session).or_default().push(frame.place(pose[0], pose[1]));
                }
            }
            let several = sessions.len() > 1;
            let lines = sessions
                .into_iter()
                .enumerate()
                .map(|(index, (session, points))| Polyline {
                    points,
                    colour: colours::experience(index),
                    width: 1.2,
                    legend: several.then_some(session),
                    ..Polyline::default()
                })
                .collect();
            Panel { title: name.clone(), axes: frame.axes(), lines, marks: Vec::new() }
        })
        .collect()
}
