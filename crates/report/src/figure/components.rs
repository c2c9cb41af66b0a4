//! Draws landmarks: the components of the multicut.

use std::collections::BTreeMap;

use posecut_evaluate::alignment::Freedom;
use posecut_graph::{EdgeKind, PoseGraph};

use super::graphs::{Estimate, onto_truth};
use super::{Axes, Dash, Frame, Marks, Panel, Polyline, Shape, colours};

/// Node indices of the landmarks of several viewpoints, largest first; `None` if no node belongs to a landmark.
pub fn landmarks(graph: &PoseGraph) -> Option<Vec<Vec<usize>>> {
    let mut members: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (index, node) in graph.nodes.iter().enumerate() {
        if let Some(landmark) = node.landmark {
            members.entry(landmark).or_default().push(index);
        }
    }
    if members.is_empty() {
        return None;
    }
    let mut landmarks: Vec<Vec<usize>> = members.into_values().filter(|nodes| nodes.len() > 1).collect();
    landmarks.sort_by_key(|nodes| (std::cmp::Reverse(nodes.len()), nodes[0]));
    Some(landmarks)
}

/// Two panels. The first shows landmark edges by the frames that they join, so that edges which support each other are
/// neighbours. The second shows the landmarks on the map.
pub fn panels(title: &str, graph: &PoseGraph, landmarks: &[Vec<usize>], frame: Frame) -> [Panel; 2] {
    let mut label = vec![None; graph.nodes.len()];
    for (landmark, nodes) in landmarks.iter().enumerate() {
        for &node in nodes {
            label[node] = Some(landmark);
        }
    }
    [plane(title, graph, &label), map(title, graph, landmarks, frame)]
}

fn hue(landmark: usize) -> &'static str {
    colours::HUES[landmark % colours::HUES.len()]
}

fn plane(title: &str, graph: &PoseGraph, label: &[Option<usize>]) -> Panel {
    let number = |node: usize| graph.nodes[node].frame.unwrap_or(node as i64) as f64;
    let mut kept: BTreeMap<&'static str, Vec<(f64, f64)>> = BTreeMap::new();
    let (mut cut, mut earlier, mut wrong) = (Vec::new(), Vec::new(), Vec::new());
    for edge in graph.edges_of(EdgeKind::Landmark) {
        let Some((from, to)) = graph.ends(edge) else { continue };
        let place = (number(from), number(to));
        match edge.rejected_by.as_deref() {
            None => kept.entry(label[from].map_or(colours::UNKNOWN, hue)).or_default().push(place),
            Some("multicut") => cut.push(place),
            Some(_) => earlier.push(place),
        }
        if edge.truth_correct() == Some(false) {
            wrong.push(place);
        }
    }
    let count: usize = kept.values().map(Vec::len).sum();
    let mut marks: Vec<Marks> = kept
        .into_iter()
        .enumerate()
        .map(|(index, (colour, points))| Marks {
            points,
            colour,
            shape: Shape::Disc,
            size: 3.5,
            legend: (index == 0).then(|| format!("kept, one colour per landmark ({count})")),
        })
        .collect();
    let mut add = |points: Vec<(f64, f64)>, colour, shape, size, text: &str| {
        let legend = Some(format!("{text} ({})", points.len()));
        marks.push(Marks { points, colour, shape, size, legend });
    };
    add(cut, colours::UNKNOWN, Shape::Ring, 4.0, "cut by the multicut");
    add(earlier, colours::REFERENCE, Shape::Disc, 2.5, "rejected by another stage");
    add(wrong, colours::INCORRECT, Shape::Cross, 5.0, "incorrect");
    let sessions = graph.sessions();
    let axis = |index: usize, else_named: &str| match sessions.as_slice() {
        [_, _] => format!("frame in {}", sessions[index]),
        _ => else_named.to_owned(),
    };
    Panel {
        title: format!("{title}: edges by their frames"),
        axes: Axes {
            right: axis(0, "frame of the first viewpoint"),
            up: axis(1, "frame of the second viewpoint"),
            equal: true,
            logarithmic_right: false,
            logarithmic_up: false,
        },
        lines: Vec::new(),
        marks,
    }
}

fn map(title: &str, graph: &PoseGraph, landmarks: &[Vec<usize>], frame: Frame) -> Panel {
    let places = Estimate::new(graph, None, Freedom::None).moved(&onto_truth(graph)).places(frame);
    let line = |points: Vec<(f64, f64)>, colour, width, dash, legend| Polyline {
        points,
        colour,
        width,
        dash,
        band: Vec::new(),
        legend,
    };
    let mut lines: Vec<Polyline> = graph
        .sessions()
        .into_iter()
        .map(|session| {
            let own = graph.nodes.iter().zip(&places);
            let points = own
                .filter(|(node, _)| node.session.as_deref() == Some(session))
                .filter_map(|(_, place)| *place)
                .collect();
            line(points, colours::REFERENCE, 1.2, Dash::Solid, None)
        })
        .collect();
    let mut cut = 0;
    for edge in graph.edges_of(EdgeKind::Landmark) {
        if edge.rejected_by.as_deref() != Some("multicut") {
            continue;
        }
        let end = |id| places[graph.node_index(id)?];
        if let (Some(from), Some(to)) = (end(edge.from), end(edge.to)) {
            let colour =
                if edge.truth_correct() == Some(false) { colours::INCORRECT } else { colours::UNKNOWN };
            let legend = (cut == 0).then(|| "cut by the multicut".to_owned());
            lines.push(line(vec![from, to], colour, 0.8, Dash::Dashed, legend));
            cut += 1;
        }
    }
    let mut by_colour: BTreeMap<&'static str, Vec<(f64, f64)>> = BTreeMap::new();
    for (landmark, nodes) in landmarks.iter().enumerate() {
        by_colour.entry(hue(landmark)).or_default().extend(nodes.iter().filter_map(|&node| places[node]));
    }
    let marks = by_colour
        .into_iter()
        .enumerate()
        .map(|(index, (colour, points))| Marks {
            points,
            colour,
            shape: Shape::Disc,
            size: 2.6,
            legend: (index == 0).then(|| format!("landmarks, colours repeat ({})", landmarks.len())),
        })
        .collect();
    Panel { title: format!("{title}: landmarks on the map"), axes: frame.axes(), lines, marks }
}
