//! What all checks look at: sessions in the order of their frames, and the edges in use with their motions and standard deviations.

use std::collections::BTreeMap;

use nalgebra::SMatrix;
use posecut_geometry::covariance::{covariance_from_information, unpack_upper_triangle};
use posecut_geometry::{LieGroup as _, SE3, translations};
use posecut_graph::{Dimension, Edge, EdgeKind, PoseGraph, for_dimension};

/// A graph, prepared for the checks.
pub(crate) struct Survey<'a> {
    pub(crate) graph: &'a PoseGraph,
    pub(crate) sessions: Vec<Session<'a>>,
    /// For each node, its session and its position there.
    pub(crate) places: Vec<(usize, usize)>,
    /// Odometry edges in use.
    pub(crate) odometry: Vec<Seen<'a>>,
    /// Landmark edges in use.
    pub(crate) landmark: Vec<Seen<'a>>,
}

/// A session.
pub(crate) struct Session<'a> {
    /// Its name; empty for nodes without one.
    pub(crate) name: &'a str,
    /// Its nodes by frame, nodes without a frame by id.
    pub(crate) nodes: Vec<usize>,
}

/// An edge in use.
pub(crate) struct Seen<'a> {
    pub(crate) edge: &'a Edge,
    /// Indices of its nodes.
    pub(crate) ends: (usize, usize),
    /// What it measures, in space.
    pub(crate) motion: Option<SE3>,
    pub(crate) information: Option<&'a [f64]>,
    /// Its standard deviations; `None` without an information matrix that has an inverse.
    pub(crate) deviation: Option<Deviation>,
}

/// Standard deviations per axis: the root of the mean variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Deviation {
    /// Metres.
    pub(crate) translation: f64,
    /// Degrees.
    pub(crate) rotation: f64,
}

impl<'a> Survey<'a> {
    /// O(size), with a logarithmic factor.
    pub(crate) fn of(graph: &'a PoseGraph) -> Self {
        let mut by_name: BTreeMap<&str, usize> = BTreeMap::new();
        let mut sessions: Vec<Session<'_>> = Vec::new();
        for (index, node) in graph.nodes.iter().enumerate() {
            let name = node.session.as_deref().unwrap_or_default();
            let number = *by_name.entry(name).or_insert_with(|| {
                sessions.push(Session { name, nodes: Vec::new() });
                sessions.len() - 1
            });
            sessions[number].nodes.push(index);
        }
        let mut places = vec![(0, 0); graph.nodes.len()];
        for (number, session) in sessions.iter_mut().enumerate() {
            // Stable: nodes of equal frame stay in the order of their ids.
            session.nodes.sort_by_key(|&node| graph.nodes[node].frame);
            for (position, &node) in session.nodes.iter().enumerate() {
                places[node] = (number, position);
            }
        }
        let seen =
            |kind| graph.edges_of(kind).filter(|edge| edge.in_use()).filter_map(|edge| see(graph, edge));
        let (odometry, landmark) = (seen(EdgeKind::Odometry).collect(), seen(EdgeKind::Landmark).collect());
        Self { graph, sessions, places, odometry, landmark }
    }

    /// The edges in use of one kind.
    pub(crate) fn of_kind(&self, kind: EdgeKind) -> &[Seen<'a>] {
        if kind == EdgeKind::Odometry { &self.odometry } else { &self.landmark }
    }

    /// The name of a session for messages, without control characters.
    pub(crate) fn name(&self, session: usize) -> String {
        match self.sessions[session].name {
            "" => "without a name".to_owned(),
            name => name.chars().filter(|character| !character.is_control()).collect(),
        }
    }
}

impl Seen<'_> {
    /// Length of the measured translation, metres.
    pub(crate) fn length(&self) -> Option<f64> {
        self.motion.map(|motion| length(&motion))
    }

    /// Angle of the measured rotation, degrees.
    pub(crate) fn turn(&self) -> Option<f64> {
        self.motion.map(|motion| motion.rotation_angle().to_degrees())
    }

    /// Whether it measures exactly the identity.
    pub(crate) fn is_zero(&self) -> bool {
        self.length() == Some(0.0) && self.turn() == Some(0.0)
    }
}

/// Length of a translation, metres.
pub(crate) fn length(motion: &SE3) -> f64 {
    motion.translation().iter().fold(0.0, |length: f64, axis| length.hypot(*axis))
}

/// The lower median, or `None` of nothing. Numbers that are not finite sort last.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len().checked_sub(1)? / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

fn see<'a>(graph: &'a PoseGraph, edge: &'a Edge) -> Option<Seen<'a>> {
    let dimension = graph.header.dimension;
    let ends = graph.ends(edge)?;
    let motion = edge.measurement.as_deref().and_then(|components| dimension.spatial(components));
    let information = graph.information(edge).filter(|_| edge.measurement.is_some());
    let deviation = information.and_then(|terms| deviation(dimension, terms));
    Some(Seen { edge, ends, motion, information, deviation })
}

/// The standard deviations of an information matrix, given by its upper triangle.
pub(crate) fn deviation(dimension: Dimension, terms: &[f64]) -> Option<Deviation> {
    for_dimension!(dimension, |_G, DOF| deviation_of::<DOF>(terms))
}

fn deviation_of<const DOF: usize>(terms: &[f64]) -> Option<Deviation> {
    let information: SMatrix<f64, DOF, DOF> = unpack_upper_triangle(terms).ok()?;
    let variances = covariance_from_information(&information).ok()?.diagonal();
    let root = |variances: &[f64]| (variances.iter().sum::<f64>() / variances.len() as f64).sqrt();
    let (translation, rotation) = variances.as_slice().split_at(translations(DOF));
    let deviation = Deviation { translation: root(translation), rotation: root(rotation).to_degrees() };
    (deviation.translation.is_finite() && deviation.rotation.is_finite()).then_some(deviation)
}
