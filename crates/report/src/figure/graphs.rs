//! Optimised graphs over their reference, with the false edges that survived and those that were found: the
//! paper's "Examples of pose-graph optimization".

use nalgebra::Vector3;
use posecut_evaluate::alignment::{Alignment, Freedom};
use posecut_graph::{EdgeKind, PoseGraph};

use super::{Frame, Panel, Polyline, colours};

/// An edge on paper: its ends, whether it is in use, whether it is correct.
struct Drawn {
    ends: [(f64, f64); 2],
    in_use: bool,
    correct: Option<bool>,
}

/// One panel for an estimate: the reference in grey, the experiences over it, landmark edges on top.
pub fn panel(title: &str, estimate: &PoseGraph, reference: Option<&PoseGraph>, frame: Frame) -> Panel {
    let places = aligned(estimate, reference);
    let mut lines = Vec::new();
    if let Some(reference) = reference {
        lines.extend(experiences(reference, &positions(reference), frame).into_iter().map(
            |(index, _, points)| Polyline {
                points,
                colour: colours::REFERENCE,
                width: 3.0,
                dashed: false,
                legend: (index == 0).then(|| "reference".to_owned()),
            },
        ));
    }
    lines.extend(experiences(estimate, &places, frame).into_iter().map(|(index, name, points)| Polyline {
        points,
        colour: colours::experience(index),
        width: 1.0,
        dashed: false,
        legend: Some(name),
    }));
    let edges = drawn_edges(estimate, &places, frame);
    let mut add = |wanted: fn(&Drawn) -> bool, colour, width, dashed, name: &str| {
        let chosen: Vec<&Drawn> = edges.iter().filter(|edge| wanted(edge)).collect();
        let count = chosen.len();
        lines.extend(chosen.into_iter().enumerate().map(|(index, edge)| Polyline {
            points: edge.ends.to_vec(),
            colour,
            width,
            dashed,
            legend: (index == 0).then(|| format!("{name} ({count})")),
        }));
    };
    add(|edge| edge.in_use && edge.correct != Some(false), colours::CORRECT, 1.2, false, "correct, in use");
    add(
        |edge| !edge.in_use && edge.correct == Some(false),
        colours::INCORRECT,
        0.6,
        true,
        "incorrect, rejected",
    );
    add(
        |edge| edge.in_use && edge.correct == Some(false),
        colours::INCORRECT,
        2.4,
        false,
        "incorrect, in use",
    );
    Panel { title: title.to_owned(), lines }
}

/// The number and name of an experience, and the points it passes.
type Way = (usize, String, Vec<(f64, f64)>);

fn positions(graph: &PoseGraph) -> Vec<Option<Vector3<f64>>> {
    let height = |pose: &[f64]| if pose.len() == 7 { pose[2] } else { 0.0 };
    graph
        .nodes
        .iter()
        .map(|node| node.pose.as_ref().map(|pose| Vector3::new(pose[0], pose[1], height(pose))))
        .collect()
}

/// The estimate's positions in the reference's frame.
fn aligned(estimate: &PoseGraph, reference: Option<&PoseGraph>) -> Vec<Option<Vector3<f64>>> {
    let own = positions(estimate);
    let Some(reference) = reference else { return own };
    let theirs = positions(reference);
    let (from, to): (Vec<_>, Vec<_>) = estimate
        .nodes
        .iter()
        .zip(&own)
        .filter_map(|(node, place)| Some(((*place)?, theirs[reference.node_index(node.id)?]?)))
        .unzip();
    let alignment = Alignment::best(&from, &to, Freedom::Se2);
    own.iter().map(|place| place.map(|place| alignment.apply(&place))).collect()
}

fn experiences(graph: &PoseGraph, places: &[Option<Vector3<f64>>], frame: Frame) -> Vec<Way> {
    graph
        .sessions()
        .into_iter()
        .enumerate()
        .map(|(index, session)| {
            let points = graph
                .nodes
                .iter()
                .zip(places)
                .filter(|(node, _)| node.session.as_deref() == Some(session))
                .filter_map(|(_, place)| place.map(|place| frame.place(place.x, place.y)))
                .collect();
            (index, session.to_owned(), points)
        })
        .collect()
}

fn drawn_edges(graph: &PoseGraph, places: &[Option<Vector3<f64>>], frame: Frame) -> Vec<Drawn> {
    graph
        .edges_of(EdgeKind::Landmark)
        .filter_map(|edge| {
            let end = |id| {
                let place = places[graph.node_index(id)?]?;
                Some(frame.place(place.x, place.y))
            };
            Some(Drawn {
                ends: [end(edge.from)?, end(edge.to)?],
                in_use: edge.in_use(),
                correct: edge.truth_correct(),
            })
        })
        .collect()
}
