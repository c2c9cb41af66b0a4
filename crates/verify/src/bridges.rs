//! Bridges over interrupted odometry: how far the robot usually moves in such a time.
//!
//! A landmark edge that alone joins two components of a graph has no loop to be judged by. But if the components follow each
//! other in one session, or a session begins after another one has ended, the motion over the interruption is roughly known:
//! it is as in other stretches of the same duration. Such a bridge is weak and rejects nothing by itself, because somebody
//! may have carried the robot, or the sessions may belong to different robots. A bridge between two sessions joins the map
//! only after other edges have confirmed it.

use std::collections::BTreeMap;

use nalgebra::{SMatrix, SVector};
use posecut_geometry::covariance::to_body;
use posecut_graph::PoseGraph;
use posecut_optimize::{Edge, EdgeKind};
use posecut_pcm::chain::Chains;

use crate::calibration::Calibration;
use crate::evidence::{Evidence, compare};
use crate::map::Map;
use crate::model::{Model, Motion};
use crate::usual::usual_motion;

/// Largest duration of a stretch that shows the motion over an interruption, relative to the interruption.
const LONGER: f64 = 1.5;

/// A motion that replaces the missing odometry between two chains.
pub(crate) struct Bridge<G, const DOF: usize> {
    pub(crate) chains: [usize; 2],
    pub(crate) edge: Edge<G, DOF>,
    /// Length of the interruption: frames or microseconds.
    length: i64,
}

/// The bridges between sessions: those that no map has confirmed yet, and those that later maps use like odometry.
pub(crate) struct Seams<G, const DOF: usize> {
    pub(crate) open: Vec<Bridge<G, DOF>>,
    pub(crate) confirmed: Vec<Edge<G, DOF>>,
}

impl<G: Motion<DOF>, const DOF: usize> Seams<G, DOF> {
    /// Confirms the bridges within one component whose squared distance from the map's prediction is usual. Returns whether
    /// there are any.
    pub(crate) fn confirm(&mut self, map: &mut Map<'_, G, DOF>, part: &[usize], usual: f64) -> bool {
        let before = self.confirmed.len();
        self.open.retain(|bridge| {
            let [one, other] = bridge.chains;
            let distance = if part[one] == part[other] { map.distance(&bridge.edge) } else { None };
            let confirmed = distance.is_some_and(|distance| distance <= usual);
            self.confirmed.extend(confirmed.then_some(bridge.edge));
            !confirmed
        });
        self.confirmed.len() > before
    }
}

/// The bridges within sessions, shortest interruption first, and those between sessions.
pub(crate) fn bridges<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    chains: &Chains<G, DOF>,
) -> [Vec<Bridge<G, DOF>>; 2] {
    let mut sessions: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (place, node) in graph.nodes.iter().enumerate() {
        if let Some(session) = &node.session {
            sessions.entry(session).or_default().push(place);
        }
    }
    let mut within: Vec<_> = sessions
        .values()
        .filter_map(|nodes| in_order(graph, nodes))
        .flat_map(|nodes| of(&nodes, chains))
        .collect();
    within.sort_by_key(|bridge| (bridge.length, bridge.chains));
    [within, between(graph, &sessions, chains)]
}

/// The bridges between the last position of a session and the first of the session that starts next. A robot that lost its
/// map and began another one has not moved far.
fn between<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    sessions: &BTreeMap<&str, Vec<usize>>,
    chains: &Chains<G, DOF>,
) -> Vec<Bridge<G, DOF>> {
    let timed: Vec<Vec<(i64, usize)>> =
        sessions.values().filter_map(|nodes| by(nodes, |node| graph.nodes[node].utime)).collect();
    let (start, end) =
        (|nodes: &[(i64, usize)]| nodes[0].0, |nodes: &[(i64, usize)]| nodes[nodes.len() - 1].0);
    timed
        .iter()
        .filter_map(|later| {
            let before =
                timed.iter().filter(|nodes| end(nodes) < start(later)).max_by_key(|nodes| end(nodes))?;
            let ends = [before[before.len() - 1], later[0]];
            let mut known = BTreeMap::new();
            over(ends, &[before.as_slice(), later].concat(), chains, &mut known)
        })
        .collect()
}

/// Nodes with their frames, or with their times if a frame is missing; `None` if neither gives an order.
fn in_order(graph: &PoseGraph, nodes: &[usize]) -> Option<Vec<(i64, usize)>> {
    by(nodes, |node| graph.nodes[node].frame).or_else(|| by(nodes, |node| graph.nodes[node].utime))
}

/// Nodes in the order of a key; `None` if a node has none, or two have the same.
fn by(nodes: &[usize], key: impl Fn(usize) -> Option<i64>) -> Option<Vec<(i64, usize)>> {
    let mut keys = nodes.iter().map(|&node| Some((key(node)?, node))).collect::<Option<Vec<_>>>()?;
    keys.sort_unstable();
    keys.windows(2).all(|pair| pair[0].0 < pair[1].0).then_some(keys)
}

/// For each candidate, the strongest evidence of a bridge between its chains, where there is one.
pub(crate) fn bridged<'a, G: Motion<DOF>, const DOF: usize>(
    bridges: impl Iterator<Item = &'a Bridge<G, DOF>>,
    model: &Model<G, DOF>,
    calibration: &Calibration,
) -> Vec<Option<Evidence>> {
    let mut of: BTreeMap<(usize, usize), Vec<&Bridge<G, DOF>>> = BTreeMap::new();
    for bridge in bridges {
        let [one, other] = bridge.chains;
        of.entry((one.min(other), one.max(other))).or_default().push(bridge);
    }
    (0..model.closures.len())
        .map(|closure| {
            let span = model.span(closure);
            let near = of.get(&(span.a, span.b))?;
            near.iter()
                .filter_map(|bridge| bridge.evidence(model, closure, calibration))
                .max_by(|one, other| one.weight().total_cmp(&other.weight()))
        })
        .collect()
}

impl<G: Motion<DOF>, const DOF: usize> Bridge<G, DOF> {
    fn evidence(&self, model: &Model<G, DOF>, closure: usize, calibration: &Calibration) -> Option<Evidence> {
        let covariance = self.edge.information.cholesky()?.inverse();
        let (closed, own) =
            model.beside(closure, [self.edge.from, self.edge.to], &self.edge.measurement, &covariance);
        let correct = calibration.covariance(&closed) + own;
        let local = calibration.local(&closed.landmark, &closed.translation);
        compare(&closed.error, &correct, &closed.apart, &local, calibration.tail)
    }
}

/// The bridges of a session.
fn of<G: Motion<DOF>, const DOF: usize>(
    nodes: &[(i64, usize)],
    chains: &Chains<G, DOF>,
) -> Vec<Bridge<G, DOF>> {
    let mut known = BTreeMap::new();
    nodes.windows(2).filter_map(|pair| over([pair[0], pair[1]], nodes, chains, &mut known)).collect()
}

/// Mean and information of a motion, if it is known.
type Known<G, const DOF: usize> = Option<(G, SMatrix<f64, DOF, DOF>)>;

/// The bridge between two consecutive nodes, unless odometry joins them. `known` caches the motion for each length.
fn over<G: Motion<DOF>, const DOF: usize>(
    [(before, from), (after, to)]: [(i64, usize); 2],
    nodes: &[(i64, usize)],
    chains: &Chains<G, DOF>,
    known: &mut BTreeMap<i64, Known<G, DOF>>,
) -> Option<Bridge<G, DOF>> {
    let joined = [from, to].map(|node| chains.places[node].0);
    if joined[0] == joined[1] {
        return None;
    }
    let length = after.saturating_sub(before);
    let motion = known.entry(length).or_insert_with(|| motion_over(nodes, chains, length));
    let (measurement, information) = (*motion)?;
    let edge = Edge::new(from, to, measurement, information, EdgeKind::Odometry);
    Some(Bridge { chains: joined, edge, length })
}

/// Mean and information of the motion over stretches of one length; `None` if there are too few.
fn motion_over<G: Motion<DOF>, const DOF: usize>(
    nodes: &[(i64, usize)],
    chains: &Chains<G, DOF>,
    length: i64,
) -> Known<G, DOF> {
    let mut motions: Vec<SVector<f64, DOF>> = Vec::new();
    let mut noise = SMatrix::zeros();
    let mut end = 0;
    for &(start, from) in nodes {
        while nodes.get(end).is_some_and(|(key, _)| key.saturating_sub(start) < length) {
            end += 1;
        }
        // No later node is far enough either, so stop.
        let Some(&(key, to)) = nodes.get(end) else { break };
        let ((number, one), (same, other)) = (chains.places[from], chains.places[to]);
        if number != same || key.saturating_sub(start) as f64 > LONGER * length as f64 {
            continue;
        }
        let chain = &chains.chains[number];
        motions.push(chain.poses[one].between(&chain.poses[other]).log());
        noise += to_body(&chain.poses[other], &chain.covariance_between(one, other));
    }
    let (mean, covariance) = usual_motion::<G, DOF>(&motions)?;
    let information = (covariance + noise / motions.len() as f64).cholesky()?.inverse();
    Some((mean, information))
}
