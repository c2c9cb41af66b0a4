//! Where keyframes are along the routes of their sessions, by odometry alone.

use std::cmp::Ordering;

use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{EdgeKind, PoseGraph};

/// The route of every session: what odometry joins is one route.
#[derive(Clone, Debug)]
pub struct Routes {
    /// The pose of each keyframe in the frame of the first one of its route.
    pose: Vec<SE2>,
    /// The path length from that first keyframe, metres.
    travelled: Vec<f64>,
    /// The route of each keyframe.
    route: Vec<usize>,
    /// The keyframes of each route by path length.
    along: Vec<Vec<usize>>,
    /// The position of each keyframe in `along`.
    position: Vec<usize>,
}

impl Routes {
    /// Follows the odometry edges of a graph in the plane. O(nodes + edges).
    ///
    /// # Errors
    ///
    /// The measurement of an odometry edge cannot be used.
    pub fn of_graph(graph: &PoseGraph) -> anyhow::Result<Self> {
        let count = graph.nodes.len();
        let mut neighbours: Vec<Vec<(usize, SE2)>> = vec![Vec::new(); count];
        for edge in graph.edges.iter().filter(|edge| edge.kind == EdgeKind::Odometry && edge.in_use()) {
            let Some((from, to)) = graph.ends(edge) else { continue };
            let Some((motion, _)) = graph.measurement::<SE2, 3>(edge)? else { continue };
            neighbours[from].push((to, motion));
            neighbours[to].push((from, motion.inverse()));
        }
        let mut routes = Self {
            pose: vec![SE2::identity(); count],
            travelled: vec![0.0; count],
            route: vec![usize::MAX; count],
            along: Vec::new(),
            position: vec![0; count],
        };
        for first in 0..count {
            if routes.route[first] == usize::MAX {
                routes.follow(first, &neighbours);
            }
        }
        Ok(routes)
    }

    fn follow(&mut self, first: usize, neighbours: &[Vec<(usize, SE2)>]) {
        let route = self.along.len();
        self.route[first] = route;
        let mut open = vec![first];
        let mut along = vec![first];
        while let Some(node) = open.pop() {
            for (next, motion) in &neighbours[node] {
                if self.route[*next] != usize::MAX {
                    continue;
                }
                self.route[*next] = route;
                self.pose[*next] = self.pose[node].compose(motion);
                self.travelled[*next] = self.travelled[node] + motion.translation.norm();
                along.push(*next);
                open.push(*next);
            }
        }
        along.sort_by(|one, other| {
            self.travelled[*one].total_cmp(&self.travelled[*other]).then(one.cmp(other))
        });
        for (position, node) in along.iter().enumerate() {
            self.position[*node] = position;
        }
        self.along.push(along);
    }

    /// The number of keyframes.
    pub fn len(&self) -> usize {
        self.pose.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.pose.is_empty()
    }

    /// The path length from one keyframe to another along their route, metres; infinite between routes.
    pub fn path_length(&self, one: usize, other: usize) -> f64 {
        if self.route[one] == self.route[other] {
            (self.travelled[one] - self.travelled[other]).abs()
        } else {
            f64::INFINITY
        }
    }

    /// The order of keyframes: by route, then along it.
    pub fn order(&self, one: usize, other: usize) -> Ordering {
        self.route[one].cmp(&self.route[other]).then(self.position[one].cmp(&self.position[other]))
    }

    /// The pose of one keyframe in the frame of another on the same route, by odometry.
    pub fn between(&self, from: usize, to: usize) -> SE2 {
        self.pose[from].between(&self.pose[to])
    }

    /// The keyframes within a path length of one, before and after it, in the order of the route.
    pub fn within(&self, node: usize, length: f64) -> &[usize] {
        let along = &self.along[self.route[node]];
        let position = self.position[node];
        let near = |other: &usize| self.path_length(node, *other) <= length;
        let first = position - along[..position].iter().rev().take_while(|other| near(other)).count();
        let last = position + along[position..].iter().take_while(|other| near(other)).count();
        &along[first..last]
    }
}
