//! Optimised graphs over their reference, with the false edges that were kept and those that were rejected, as in the
//! paper's "Examples of pose-graph optimization".

use nalgebra::Vector3;
use posecut_evaluate::alignment::{Alignment, Freedom};
use posecut_graph::{Dimension, EdgeKind, PoseGraph};

use super::{Dash, Frame, Marks, Panel, Polyline, Shape, colours};

/// An estimate in the frame of its reference.
pub struct Estimate {
    places: Vec<Option<Vector3<f64>>>,
    errors: Option<Vec<f64>>,
}

impl Estimate {
    /// Aligns an estimate to a reference, matched by node ids. Without a reference the estimate is unchanged.
    pub fn new(estimate: &PoseGraph, reference: Option<&PoseGraph>, freedom: Freedom) -> Self {
        let own = positions(estimate);
        let Some(reference) = reference else { return Self { places: own, errors: None } };
        let theirs = positions(reference);
        let matched: Vec<Option<Vector3<f64>>> =
            estimate.nodes.iter().map(|node| theirs[reference.node_index(node.id)?]).collect();
        let (from, to): (Vec<_>, Vec<_>) =
            own.iter().zip(&matched).filter_map(|(own, theirs)| Some(((*own)?, (*theirs)?))).unzip();
        let alignment = Alignment::best(&from, &to, freedom);
        let places: Vec<_> = own.iter().map(|place| place.map(|place| alignment.apply(&place))).collect();
        let errors = places.iter().zip(&matched).map(|(own, theirs)| Some(((*own)? - (*theirs)?).norm()));
        Self { errors: errors.collect(), places }
    }

    /// Moves the estimate and its reference by one motion: errors do not change.
    #[must_use]
    pub fn moved(mut self, motion: &Alignment) -> Self {
        for place in self.places.iter_mut().flatten() {
            *place = motion.apply(place);
        }
        self
    }

    /// Positions of the nodes on paper.
    pub fn places(&self, frame: Frame) -> Vec<Option<(f64, f64)>> {
        self.places.iter().map(|place| place.map(|place| frame.place(place.x, place.y))).collect()
    }

    /// The distance of each node from the reference, metres; `None` unless a reference has all nodes.
    pub fn errors(&self) -> Option<Vec<f64>> {
        self.errors.clone()
    }
}

/// The planar motion that brings a graph closest to its ground truth, so that its map has the orientation of the truth;
/// the identity if no truth is known.
pub fn onto_truth(graph: &PoseGraph) -> Alignment {
    let height = |pose: &[f64]| if pose.len() == 7 { pose[2] } else { 0.0 };
    let truth = graph.nodes.iter().map(|node| {
        let pose = node.truth.as_ref()?.pose.as_ref()?;
        Some(Vector3::new(pose[0], pose[1], height(pose)))
    });
    let (from, to): (Vec<_>, Vec<_>) =
        positions(graph).into_iter().zip(truth).filter_map(|(own, truth)| Some((own?, truth?))).unzip();
    Alignment::best(&from, &to, Freedom::Se2)
}

/// The motions that evaluation allows by default.
pub fn usual_freedom(graph: &PoseGraph) -> Freedom {
    match graph.header.dimension {
        Dimension::Two => Freedom::Se2,
        Dimension::Three => Freedom::Se3,
    }
}

/// An edge on paper: its ends, and whether it is in use and correct.
struct Drawn {
    ends: [(f64, f64); 2],
    in_use: bool,
    correct: Option<bool>,
}

/// How the edges of one kind are drawn.
struct Style {
    wanted: fn(&Drawn) -> bool,
    colour: &'static str,
    width: f64,
    dash: Dash,
    name: &'static str,
}

impl Style {
    /// Styles in drawing order: the most important edges are drawn last, on top.
    const ALL: [Self; 4] = [
        Self {
            wanted: |edge| edge.in_use && edge.correct != Some(false),
            colour: colours::CORRECT,
            width: 1.2,
            dash: Dash::Solid,
            name: "correct, in use",
        },
        Self {
            wanted: |edge| !edge.in_use && edge.correct == Some(true),
            colour: colours::CORRECT,
            width: 0.8,
            dash: Dash::Dashed,
            name: "correct, rejected",
        },
        Self {
            wanted: |edge| !edge.in_use && edge.correct == Some(false),
            colour: colours::INCORRECT,
            width: 0.6,
            dash: Dash::Dashed,
            name: "incorrect, rejected",
        },
        Self {
            wanted: |edge| edge.in_use && edge.correct == Some(false),
            colour: colours::INCORRECT,
            width: 2.4,
            dash: Dash::Solid,
            name: "incorrect, in use",
        },
    ];

    /// One line for each edge of this kind; only the first has a legend entry.
    fn lines(&self, edges: &[Drawn]) -> Vec<Polyline> {
        let chosen: Vec<&Drawn> = edges.iter().filter(|edge| (self.wanted)(edge)).collect();
        let line = |(index, edge): (usize, &&Drawn)| Polyline {
            points: edge.ends.to_vec(),
            colour: self.colour,
            width: self.width,
            dash: self.dash,
            band: Vec::new(),
            legend: (index == 0).then(|| format!("{} ({})", self.name, chosen.len())),
        };
        chosen.iter().enumerate().map(line).collect()
    }
}

/// One panel for an estimate: the reference in grey, then the experiences, then the landmark edges on top.
pub fn panel(title: &str, estimate: &PoseGraph, reference: Option<&PoseGraph>, frame: Frame) -> Panel {
    let motion = onto_truth(reference.unwrap_or(estimate));
    let places = Estimate::new(estimate, reference, Freedom::Se2).moved(&motion).places;
    let mut lines = Vec::new();
    if let Some(reference) = reference {
        let known = Estimate::new(reference, None, Freedom::None).moved(&motion).places;
        lines.extend(experiences(reference, &known, frame).into_iter().map(|(index, _, points)| Polyline {
            points,
            colour: colours::REFERENCE,
            width: 3.0,
            legend: (index == 0).then(|| "reference".to_owned()),
            ..Polyline::default()
        }));
    }
    lines.extend(experiences(estimate, &places, frame).into_iter().map(|(index, name, points)| Polyline {
        points,
        colour: colours::experience(index),
        width: 1.0,
        legend: Some(name),
        ..Polyline::default()
    }));
    let edges = drawn_edges(estimate, &places, frame);
    lines.extend(Style::ALL.iter().flat_map(|style| style.lines(&edges)));
    // Optimisation pulls the two ends of a false edge in use together: discs keep it visible.
    let kept = edges.iter().filter(|edge| edge.in_use && edge.correct == Some(false));
    let ends = Marks {
        points: kept.flat_map(|edge| edge.ends).collect(),
        colour: colours::INCORRECT,
        shape: Shape::Disc,
        size: 4.5,
        legend: None,
    };
    Panel { title: title.to_owned(), axes: frame.axes(), lines, marks: vec![ends] }
}

/// An experience: its number, its name and the points of its trajectory.
type Way = (usize, String, Vec<(f64, f64)>);

fn positions(graph: &PoseGraph) -> Vec<Option<Vector3<f64>>> {
    let height = |pose: &[f64]| if pose.len() == 7 { pose[2] } else { 0.0 };
    graph
        .nodes
        .iter()
        .map(|node| node.pose.as_ref().map(|pose| Vector3::new(pose[0], pose[1], height(pose))))
        .collect()
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
