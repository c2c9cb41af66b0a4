//! Covariances of poses and of pairs of poses at a solution.

use nalgebra::SMatrix;
use posecut_geometry::covariance::between_correlated;
use rayon::prelude::*;

use super::columns::Columns;
use super::part::{Block, Part, Place};
use crate::model::gauge::put_held_first;
use crate::model::prior::{Prior, PriorsOfNodes};
use crate::model::problem::{Edge, Problem};
use crate::normal_equations::{Pattern, System};
use crate::pose_group::PoseGroup;
use posecut_cholesky::{Memory, SelectedInverse};
use posecut_graph::connectivity::connected_components;

/// From this number of distinct nodes in a request on, the inverse over the whole pattern is cheaper than single columns.
const MANY_NODES: usize = 16;

/// Covariances of two poses `X_a`, `X_b` and between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint<const DOF: usize> {
    /// `E[a a^T]`.
    pub first: SMatrix<f64, DOF, DOF>,
    /// `E[a b^T]`.
    pub cross: SMatrix<f64, DOF, DOF>,
    /// `E[b b^T]`.
    pub second: SMatrix<f64, DOF, DOF>,
}

/// Covariances at given poses: exact blocks of the inverse of the Gauss-Newton matrix `sum of J^T w Omega J`.
///
/// Every covariance is that of a right perturbation, `X = X_hat Exp(xi)`, translation before rotation, in square metres and
/// square radians. **Gauge:** held nodes have no uncertainty; in a connected component without held nodes and priors, the first
/// node has none. Covariances of poses are relative to the gauge, those of relative poses do not depend on it. They propagate the
/// edges' information to first order at the given poses, and are valid as far as this approximation is.
///
/// Components are those of the edges of positive weight. A component whose edges leave a direction undetermined has no
/// covariances: `None`. The same holds for pairs in different components and for nodes that do not exist.
pub struct Marginals<G, const DOF: usize> {
    poses: Vec<G>,
    /// Component of each node, and the node's number there.
    places: Vec<(usize, usize)>,
    parts: Vec<Part<DOF>>,
}

impl<G, const DOF: usize> std::fmt::Debug for Marginals<G, DOF> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter
            .debug_struct("Marginals")
            .field("poses", &self.poses.len())
            .field("parts", &self.parts.len())
            .finish_non_exhaustive()
    }
}

impl<G: PoseGroup<DOF>, const DOF: usize> Marginals<G, DOF> {
    /// Factorises the equations at `poses`, with the information of edge `k` multiplied by `weights[k]`. With the weights of
    /// a [`Solution`](crate::Solution): `Marginals::new(&problem, &solution.poses, &solution.all_weights())`. Kernels are ignored.
    /// The weights of priors follow those of the edges: see [`Solution::all_weights`](crate::Solution::all_weights). Missing weights
    /// are one. Takes the time of one Gauss-Newton step. Where the poses come from [`optimize`](crate::optimize),
    /// [`optimize_with_marginals`](crate::optimize_with_marginals) saves the analysis of the pattern.
    pub fn new(problem: &Problem<G, DOF>, poses: &[G], weights: &[f64]) -> Self {
        G::marginals(problem, poses, weights)
    }

    /// The same with a system for each component of the problem's edges, if there are any systems. Only valid if all weights
    /// are positive: otherwise the components and patterns differ.
    pub(crate) fn of(
        problem: &Problem<G, DOF>,
        poses: &[G],
        weights: &[f64],
        systems: Vec<Option<System<DOF>>>,
    ) -> Self {
        let weigh = |(index, edge): (usize, &Edge<G, DOF>)| {
            let weight = weights.get(index).copied().unwrap_or(1.0);
            (weight > 0.0).then(|| Edge { information: edge.information * weight, kernel: None, ..*edge })
        };
        let edges: Vec<_> = problem.edges().iter().enumerate().filter_map(weigh).collect();
        let weigh = |(index, prior): (usize, &Prior<G, DOF>)| {
            let weight = weights.get(problem.edges().len() + index).copied().unwrap_or(1.0);
            (weight > 0.0).then(|| Prior { information: prior.information * weight, kernel: None, ..*prior })
        };
        let priors: Vec<_> = problem.priors().iter().enumerate().filter_map(weigh).collect();
        let of_nodes = PriorsOfNodes::new(&priors);
        let mut components = connected_components(poses.len(), edges.iter().map(|edge| (edge.from, edge.to)));
        let mut places = vec![(0, 0); poses.len()];
        let mut parts = Vec::with_capacity(components.len());
        let mut systems = systems.into_iter();
        for (index, component) in components.iter_mut().enumerate() {
            let held = put_held_first(component, problem.held(), of_nodes.anchor(component));
            for (number, &node) in component.nodes.iter().enumerate() {
                places[node] = (index, number);
            }
            let part_poses: Vec<G> = component.nodes.iter().map(|&node| poses[node]).collect();
            let renumber = |&edge: &usize| {
                let edge = &edges[edge];
                Edge { from: places[edge.from].1, to: places[edge.to].1, ..*edge }
            };
            let part_edges: Vec<_> = component.edges.iter().map(renumber).collect();
            let system = systems.next().flatten().unwrap_or_else(|| {
                System::new(Pattern::of(part_poses.len(), held, &part_edges), Memory::default())
            });
            let part_priors: Vec<_> = of_nodes
                .of_component(component)
                .map(|prior| Prior { node: places[priors[prior].node].1, ..priors[prior] })
                .collect();
            let mut part = Part::new(&part_poses, &part_edges, &part_priors, system);
            part.undetermined = part.undetermined.map(|(node, axis)| (component.nodes[node], axis));
            parts.push(part);
        }
        Self { poses: poses.to_vec(), places, parts }
    }

    /// The memory of the factors, for [`optimize_with_marginals`](crate::optimize_with_marginals).
    pub fn into_memory(self) -> Vec<Memory> {
        self.parts.into_iter().map(|part| part.factor.into_memory(part.inverse)).collect()
    }

    /// For every connected component with an undetermined direction: a node, and the component of its pose.
    pub fn undetermined(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.parts.iter().filter_map(|part| part.undetermined)
    }

    /// Covariances of chosen poses.
    pub fn poses(&mut self, nodes: &[usize]) -> Vec<Option<SMatrix<f64, DOF, DOF>>> {
        let pairs: Vec<_> = nodes.iter().map(|&node| (node, node)).collect();
        self.joint(&pairs).into_iter().map(|joint| joint.map(|joint| joint.first)).collect()
    }

    /// Covariances of the relative poses `X_a^-1 X_b` of pairs `(a, b)`.
    ///
    /// Uncertainty common to both poses cancels: a relative pose `c` times as certain as its two poses loses `log10 c` of
    /// sixteen digits, twice.
    pub fn relative(&mut self, pairs: &[(usize, usize)]) -> Vec<Option<SMatrix<f64, DOF, DOF>>> {
        let joints = self.joint(pairs);
        let propagate = |(joint, &(a, b)): (Option<Joint<DOF>>, &(usize, usize))| {
            joint.map(|joint| {
                between_correlated(&self.poses[a], &joint.first, &self.poses[b], &joint.second, &joint.cross)
            })
        };
        joints.into_par_iter().zip(pairs).map(propagate).collect()
    }

    /// Covariances of pairs of poses.
    ///
    /// A request for many nodes costs about two factorisations, plus triangular solves along the elimination tree for the
    /// first node of each pair without a block in the factor. A request for few nodes costs only such solves.
    pub fn joint(&mut self, pairs: &[(usize, usize)]) -> Vec<Option<Joint<DOF>>> {
        G::joint(self, pairs)
    }

    /// The body of [`Self::joint`].
    pub(crate) fn joint_here(&mut self, pairs: &[(usize, usize)]) -> Vec<Option<Joint<DOF>>> {
        let places: Vec<_> = pairs.iter().map(|&pair| self.place(pair)).collect();
        self.invert_where_many(&places);
        let own = |place: &Place| {
            let part = &self.parts[place.part];
            place.blocks().map(|(row, column)| part.block(row, column))
        };
        let blocks: Vec<_> = places.par_iter().map(|place| place.as_ref().map(own)).collect();
        let columns = Columns::of(&self.parts, &places, &blocks);
        let join = |(place, blocks): (&Option<Place>, &Option<[Option<Block<DOF>>; 3]>)| {
            let (place, blocks) = (place.as_ref()?, blocks.as_ref()?);
            let wanted = place.blocks();
            let of = |which: usize| {
                let (row, column) = wanted[which];
                let block = blocks[which].or_else(|| columns.block(place.part, wanted[which]))?;
                Some(if row == column { symmetric(block) } else { block })
            };
            let (first, cross, second) = (of(0)?, of(1)?, of(2)?);
            Some(Joint { first, cross: if place.a <= place.b { cross } else { cross.transpose() }, second })
        };
        places.iter().zip(&blocks).map(join).collect()
    }

    /// Computes the inverse over the whole pattern of each component in which these pairs have many nodes.
    fn invert_where_many(&mut self, places: &[Option<Place>]) {
        for (number, part) in self.parts.iter_mut().enumerate().filter(|(_, part)| part.inverse.is_none()) {
            let of_part = places.iter().flatten().filter(|place| place.part == number);
            let mut nodes: Vec<usize> = of_part.flat_map(|place| [place.a, place.b]).collect();
            nodes.sort_unstable();
            nodes.dedup();
            if nodes.len() > MANY_NODES {
                part.inverse = Some(SelectedInverse::new(&part.symbolic, &mut part.factor));
            }
        }
    }

    /// The component of a pair and the nodes' numbers there, if it has covariances.
    fn place(&self, (a, b): (usize, usize)) -> Option<Place> {
        let (&(part, a), &(other, b)) = (self.places.get(a)?, self.places.get(b)?);
        (part == other && self.parts[part].undetermined.is_none()).then_some(Place { part, a, b })
    }
}

/// Rounding makes a diagonal block of the inverse asymmetric.
fn symmetric<const DOF: usize>(block: Block<DOF>) -> Block<DOF> {
    (block + block.transpose()) * 0.5
}
