//! Covariances of poses and of pairs of poses at a solution.

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use posecut_geometry::covariance::between_correlated;
use rayon::prelude::*;

use crate::model::gauge::put_held_first;
use crate::model::problem::{Edge, Problem};
use crate::normal_equations::{NormalEquations, Pattern};
use posecut_cholesky::{Factor, SelectedInverse, Symbolic, Workspace};
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
/// square radians. **Gauge:** held nodes have no uncertainty; in a connected component without held nodes, the first node has
/// none. Covariances of poses are relative to the gauge, those of relative poses do not depend on it. They propagate the
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

/// The factorised equations of a connected component.
struct Part<const DOF: usize> {
    held: usize,
    symbolic: Symbolic,
    factor: Factor<DOF>,
    inverse: Option<SelectedInverse<DOF>>,
    /// Node and component that the edges leave undetermined.
    undetermined: Option<(usize, usize)>,
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

impl<G: LieGroup<DOF>, const DOF: usize> Marginals<G, DOF> {
    /// Factorises the equations at `poses`, with the information of edge `k` multiplied by `weights[k]`. With the weights of
    /// a [`Solution`](crate::Solution): `Marginals::new(&problem, &solution.poses, &solution.weights)`. Kernels are ignored.
    /// Missing weights are one. Takes the time of one Gauss-Newton step.
    pub fn new(problem: &Problem<G, DOF>, poses: &[G], weights: &[f64]) -> Self {
        let weigh = |(index, edge): (usize, &Edge<G, DOF>)| {
            let weight = weights.get(index).copied().unwrap_or(1.0);
            (weight > 0.0).then(|| Edge { information: edge.information * weight, kernel: None, ..*edge })
        };
        let edges: Vec<_> = problem.edges().iter().enumerate().filter_map(weigh).collect();
        let mut components = connected_components(poses.len(), edges.iter().map(|edge| (edge.from, edge.to)));
        let mut places = vec![(0, 0); poses.len()];
        let mut parts = Vec::with_capacity(components.len());
        for (index, component) in components.iter_mut().enumerate() {
            let held = put_held_first(component, problem.held());
            for (number, &node) in component.nodes.iter().enumerate() {
                places[node] = (index, number);
            }
            let part_poses: Vec<G> = component.nodes.iter().map(|&node| poses[node]).collect();
            let renumber = |&edge: &usize| {
                let edge = &edges[edge];
                Edge { from: places[edge.from].1, to: places[edge.to].1, ..*edge }
            };
            let part_edges: Vec<_> = component.edges.iter().map(renumber).collect();
            let mut part = Part::new(&part_poses, held, &part_edges);
            part.undetermined = part.undetermined.map(|(node, axis)| (component.nodes[node], axis));
            parts.push(part);
        }
        Self { poses: poses.to_vec(), places, parts }
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
        let mut wanted: Vec<Vec<(usize, usize)>> = vec![Vec::new(); self.parts.len()];
        for (part, a, b) in pairs.iter().filter_map(|&pair| self.place(pair)) {
            wanted[part].extend([(a, a), (a.min(b), a.max(b)), (b, b)]);
        }
        for wanted in &mut wanted {
            wanted.sort_unstable();
            wanted.dedup();
        }
        let blocks: Vec<_> =
            self.parts.iter_mut().zip(&wanted).map(|(part, wanted)| part.blocks(wanted)).collect();
        let find = |part: usize, a: usize, b: usize| {
            let block = blocks[part][wanted[part].binary_search(&(a.min(b), a.max(b))).ok()?];
            Some(if a <= b { block } else { block.transpose() })
        };
        let join = |&pair: &(usize, usize)| {
            let (part, a, b) = self.place(pair)?;
            Some(Joint { first: find(part, a, a)?, cross: find(part, a, b)?, second: find(part, b, b)? })
        };
        pairs.iter().map(join).collect()
    }

    /// The component of a pair and the nodes' numbers there, if it has covariances.
    fn place(&self, (a, b): (usize, usize)) -> Option<(usize, usize, usize)> {
        let (&(part, a), &(other, b)) = (self.places.get(a)?, self.places.get(b)?);
        (part == other && self.parts[part].undetermined.is_none()).then_some((part, a, b))
    }
}

impl<const DOF: usize> Part<DOF> {
    fn new<G: LieGroup<DOF>>(poses: &[G], held: usize, edges: &[Edge<G, DOF>]) -> Self {
        let pattern = Pattern::of(poses.len(), held, edges);
        let mut equations = NormalEquations::new(&pattern);
        equations.assemble(&pattern, edges, poses);
        let symbolic = pattern.symbolic;
        let mut factor = Factor::new(&symbolic);
        let outcome =
            factor.factorize(&symbolic, &equations.diagonal, &equations.off_diagonal, 0.0, [0.0; DOF]);
        let undetermined = match outcome {
            Err(breakdown) => Some((breakdown.variable, breakdown.component)),
            Ok(()) => factor.undetermined(),
        };
        let undetermined = undetermined.map(|(variable, component)| (held + variable, component));
        Self { held, symbolic, factor, inverse: None, undetermined }
    }

    /// The wanted blocks `(a, b)`, `a <= b`, of the covariance; `wanted` is ascending, in numbers of the component.
    fn blocks(&mut self, wanted: &[(usize, usize)]) -> Vec<SMatrix<f64, DOF, DOF>> {
        let distinct = wanted.iter().filter(|(a, b)| a == b).count();
        if distinct > MANY_NODES && self.inverse.is_none() {
            self.inverse = Some(SelectedInverse::new(&self.symbolic, &self.factor));
        }
        let part = &*self;
        // Held nodes have no uncertainty.
        let variable = |node: usize| node.checked_sub(part.held);
        let mut blocks: Vec<Option<SMatrix<f64, DOF, DOF>>> = wanted
            .par_iter()
            .map(|&(a, b)| match variable(a).zip(variable(b)) {
                Some((row, column)) => part.inverse.as_ref()?.block(&part.symbolic, row, column),
                None => Some(SMatrix::zeros()),
            })
            .collect();
        // Blocks that the factor lacks come from a column of the inverse for each first node.
        let missing: Vec<usize> = (0..wanted.len()).filter(|&place| blocks[place].is_none()).collect();
        let columns: Vec<&[usize]> =
            missing.chunk_by(|&one, &other| wanted[one].0 == wanted[other].0).collect();
        let found: Vec<_> = columns
            .par_iter()
            .map_init(|| part.factor.workspace(), |workspace, column| part.column(wanted, column, workspace))
            .collect();
        for (&place, block) in columns.iter().copied().flatten().zip(found.into_iter().flatten()) {
            blocks[place] = Some(block.transpose());
        }
        let symmetric = |(block, (a, b)): (Option<SMatrix<f64, DOF, DOF>>, &(usize, usize))| {
            let block = block.unwrap_or_else(SMatrix::zeros);
            if a == b { (block + block.transpose()) * 0.5 } else { block }
        };
        blocks.into_iter().zip(wanted).map(symmetric).collect()
    }

    /// The blocks of the wanted pairs at these indices, all with the same first node.
    fn column(
        &self,
        wanted: &[(usize, usize)],
        places: &[usize],
        workspace: &mut Workspace,
    ) -> Vec<SMatrix<f64, DOF, DOF>> {
        let first = wanted[places[0]].0 - self.held;
        let others: Vec<usize> = places.iter().map(|&place| wanted[place].1 - self.held).collect();
        self.factor.inverse_column(&self.symbolic, first, &others, workspace)
    }
}
