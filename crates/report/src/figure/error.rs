//! Draws the error of every pose along a session.

use posecut_graph::PoseGraph;

use super::graphs::{Estimate, usual_freedom};
use super::{Axes, Dash, Panel, Polyline, colours};

/// Errors below this are drawn at this value, metres.
pub const FLOOR: f64 = 0.01;

/// One line an estimate, named by its method. The error is the distance from the reference after one alignment of the
/// whole. The axis is in minutes if all nodes have times that keep increasing, otherwise it is the index of the pose.
pub fn panel(title: &str, estimates: &[(String, PoseGraph)], reference: &PoseGraph) -> anyhow::Result<Panel> {
    let time = minutes(reference);
    let mut lines = Vec::new();
    let mut others = 0;
    for (name, graph) in estimates {
        let Some(errors) = Estimate::new(graph, Some(reference), usual_freedom(graph)).errors() else {
            anyhow::bail!(
                "{name}: some nodes have no pose in the reference; name the reference of this graph"
            );
        };
        let rmse =
            (errors.iter().map(|error| error * error).sum::<f64>() / errors.len().max(1) as f64).sqrt();
        let (colour, dash) = colours::method(&name.to_lowercase(), others);
        others += usize::from(colours::method(&name.to_lowercase(), others + 1).0 != colour);
        let time = time.as_ref().filter(|time| time.len() == errors.len());
        let along = |index: usize| time.map_or(index as f64, |time| time[index]);
        lines.push(Polyline {
            points: errors
                .iter()
                .enumerate()
                .map(|(index, error)| (along(index), error.max(FLOOR)))
                .collect(),
            colour,
            width: 1.6,
            dash,
            band: Vec::new(),
            legend: Some(format!("{name} (RMSE {} m)", crate::table::metres(rmse))),
        });
    }
    if let (Some(start), Some(last)) = (second_experience(reference), lines.first()) {
        let place = last.points.get(start).map(|point| point.0);
        let top = lines.iter().flat_map(|line| &line.points).map(|point| point.1).fold(FLOOR, f64::max);
        lines.extend(place.map(|place| Polyline {
            points: vec![(place, FLOOR), (place, top)],
            colour: colours::INK,
            width: 0.8,
            dash: Dash::Dashed,
            band: Vec::new(),
            legend: None,
        }));
    }
    let right = if time.is_some() { "minutes since the start" } else { "index of the pose" };
    Ok(Panel {
        title: title.to_owned(),
        axes: Axes {
            right: right.to_owned(),
            up: "error (m)".to_owned(),
            equal: false,
            logarithmic_right: false,
            logarithmic_up: true,
        },
        lines,
        marks: Vec::new(),
    })
}

/// Minutes since the first node; `None` if a node has no time, if time runs backwards, or after a gap of half an hour
/// (sessions of different days).
pub fn minutes(graph: &PoseGraph) -> Option<Vec<f64>> {
    let times: Vec<i64> = graph.nodes.iter().map(|node| node.utime).collect::<Option<_>>()?;
    let steady = times.windows(2).all(|pair| (0..1_800_000_000).contains(&(pair[1] - pair[0])));
    let first = *times.first()?;
    steady.then(|| times.iter().map(|time| (time - first) as f64 / 6e7).collect())
}

/// The first node that is in another session than the first node.
fn second_experience(graph: &PoseGraph) -> Option<usize> {
    let first = &graph.nodes.first()?.session;
    graph.nodes.iter().position(|node| node.session != *first)
}
