//! Nodes with ground truth.

use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::PoseGraph;

/// A pose with the heading of a forward-looking camera.
pub(crate) trait Headed<const DOF: usize>: LieGroup<DOF> {
    /// Heading in the horizontal plane, radians.
    fn heading(&self) -> f64;
}

impl Headed<3> for SE2 {
    fn heading(&self) -> f64 {
        self.angle()
    }
}

impl Headed<6> for SE3 {
    fn heading(&self) -> f64 {
        self.to_planar().angle()
    }
}

/// A node with ground truth, with the values that construction needs.
pub(crate) struct Viewpoint<G> {
    pub(crate) node: u64,
    pub(crate) experience: usize,
    pub(crate) utime: Option<i64>,
    pub(crate) position: [f64; 3],
    pub(crate) heading: f64,
    pub(crate) pose: G,
}

impl<G> Viewpoint<G> {
    /// Distance to another viewpoint, metres.
    pub(crate) fn distance(&self, other: &Self) -> f64 {
        self.distance_to(other.position)
    }

    /// Distance to a position, metres.
    pub(crate) fn distance_to(&self, place: [f64; 3]) -> f64 {
        self.position.iter().zip(place).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }
}

/// The nodes with ground truth, in the order of the graph. Experiences are numbered in order of appearance.
pub(crate) fn viewpoints<G: Headed<DOF>, const DOF: usize>(graph: &PoseGraph) -> Vec<Viewpoint<G>> {
    let sessions: Vec<&str> = graph.sessions();
    let mut viewpoints = Vec::new();
    let mut last = (None, 0);
    for node in &graph.nodes {
        let session = node.session.as_deref();
        if last.0 != session {
            let place = sessions.iter().position(|&name| Some(name) == session);
            last = (session, place.unwrap_or(sessions.len()));
        }
        let Some(components) = node.truth.as_ref().and_then(|truth| truth.pose.as_deref()) else { continue };
        let Some(pose) = G::from_components(components) else { continue };
        viewpoints.push(Viewpoint {
            node: node.id,
            experience: last.1,
            utime: node.utime,
            position: pose.translation(),
            heading: pose.heading(),
            pose,
        });
    }
    viewpoints
}
