//! Odometry as chains between the nodes that landmark edges join.
//!
//! A node with two odometry edges and no landmark edge can be eliminated: its best pose follows from the ends of its chain.
//! [`Odometry::chains`] lists the chains between chosen nodes. [`Chain::condense`] replaces a chain by one edge that has
//! the same value, gradient and Gauss-Newton matrix (its Schur complement). [`Chain::bend`] moves the steps inside a chain
//! after its ends have moved.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_optimize::{Edge, EdgeKind};

/// An odometry edge in the direction in which a chain passes it.
#[derive(Clone, Copy, Debug)]
struct Directed<G, const DOF: usize> {
    end: usize,
    measurement: G,
    covariance: SMatrix<f64, DOF, DOF>,
}

/// Odometry edges in both directions.
#[derive(Clone, Debug)]
pub(crate) struct Odometry<G, const DOF: usize> {
    /// Edge `k` forwards at `2 k`, backwards at `2 k + 1`.
    directed: Vec<Directed<G, DOF>>,
    /// The directed edges that leave each node.
    leaving: Vec<Vec<usize>>,
}

impl<G: LieGroup<DOF>, const DOF: usize> Odometry<G, DOF> {
    /// `None` if an information matrix has no inverse: such an edge cannot be part of a chain.
    pub(crate) fn new(nodes: usize, edges: &[Edge<G, DOF>]) -> Option<Self> {
        let mut directed = Vec::with_capacity(2 * edges.len());
        let mut leaving = vec![Vec::new(); nodes];
        for edge in edges {
            let covariance = edge.information.cholesky()?.inverse();
            // Log(Z Y^-1) = -Ad(Z) Log(Z^-1 Y): both directions have the same squared residual.
            let adjoint = edge.measurement.adjoint();
            let back = Directed {
                end: edge.from,
                measurement: edge.measurement.inverse(),
                covariance: adjoint * covariance * adjoint.transpose(),
            };
            leaving[edge.from].push(directed.len());
            directed.push(Directed { end: edge.to, measurement: edge.measurement, covariance });
            leaving[edge.to].push(directed.len());
            directed.push(back);
        }
        Some(Self { directed, leaving })
    }

    /// The chains between the nodes that `stays` marks. Also marks the nodes where odometry branches, and one node inside
    /// each chain that returns to its start. Leaves out chains with a loose end, because their residuals are zero at the
    /// optimum.
    pub(crate) fn chains(&self, stays: &mut [bool]) -> Vec<Chain<G>> {
        for (stays, leaving) in stays.iter_mut().zip(&self.leaving) {
            *stays |= leaving.len() > 2;
        }
        let mut chains = Vec::new();
        let mut passed = vec![false; self.directed.len() / 2];
        for start in 0..stays.len() {
            if !stays[start] {
                continue;
            }
            for &first in &self.leaving[start] {
                let Some(steps) = self.walk(first, stays, &mut passed) else { continue };
                let end = self.directed[steps[steps.len() - 1]].end;
                if end == start {
                    let (head, tail) = steps.split_at(steps.len() / 2);
                    let middle = self.directed[head[head.len() - 1]].end;
                    stays[middle] = true;
                    chains.push(self.chain(start, middle, head));
                    chains.push(self.chain(middle, end, tail));
                } else {
                    chains.push(self.chain(start, end, &steps));
                }
            }
        }
        chains
    }

    /// The directed edges from `first` to the next node that stays; `None` if there is no such node, or if `first` was passed
    /// before.
    fn walk(&self, first: usize, stays: &[bool], passed: &mut [bool]) -> Option<Vec<usize>> {
        let mut steps = Vec::new();
        let mut step = first;
        while !passed[step / 2] {
            passed[step / 2] = true;
            steps.push(step);
            let node = self.directed[step].end;
            if stays[node] {
                return Some(steps);
            }
            step = *self.leaving[node].iter().find(|&&next| !passed[next / 2])?;
        }
        None
    }

    fn chain(&self, from: usize, to: usize, steps: &[usize]) -> Chain<G> {
        let poses = steps.iter().map(|&step| self.directed[step].measurement).collect();
        Chain { from, to, steps: steps.to_vec(), poses }
    }
}

/// Odometry edges in a row.
#[derive(Clone, Debug)]
pub(crate) struct Chain<G> {
    pub(crate) from: usize,
    pub(crate) to: usize,
    /// Indices of the directed edges.
    steps: Vec<usize>,
    /// The current relative pose over each step.
    poses: Vec<G>,
}

/// A chain condensed to one edge.
#[derive(Clone, Debug)]
pub(crate) struct Condensed<G, const DOF: usize> {
    pub(crate) edge: Edge<G, DOF>,
    /// The current relative pose of the ends.
    whole: G,
    /// `p = sum of B_i e_i`.
    pull: SVector<f64, DOF>,
    /// `L = (sum of B_i S_i B_i^T)^-1`.
    information: SMatrix<f64, DOF, DOF>,
}

impl<G: Copy> Chain<G> {
    /// Whether it is a single edge, which [`Self::condense`] returns unchanged.
    pub(crate) fn is_edge(&self) -> bool {
        self.steps.len() == 1
    }

    /// The chain as one edge; `None` if its covariance has no inverse.
    ///
    /// Take a step of pose `Y_i`, residual `e_i` and covariance `S_i`. If its residual becomes `r_i`, the end of the chain
    /// moves by `B_i (r_i - e_i)`, where `B_i = Ad(Y_{i+1} ... Y_n)^-1 J_r(e_i)`. If the end moves by `d`, the least `sum
    /// of r_i^T S_i^-1 r_i` is `(d + p)^T L (d + p)`.
    ///
    /// An edge that measures `whole Exp(-p)` has the residual `Log(Exp(p) Exp(d))`, whose derivative at `d = 0` is
    /// `J_r^-1(p)`. With the information `J_r(p)^T L J_r(p)`, its value, gradient and Gauss-Newton matrix at `d = 0` are
    /// those of the chain.
    pub(crate) fn condense<const DOF: usize>(&self, odometry: &Odometry<G, DOF>) -> Option<Condensed<G, DOF>>
    where
        G: LieGroup<DOF>,
    {
        let mut whole = G::identity();
        let mut covariance = SMatrix::<f64, DOF, DOF>::zeros();
        let mut pull = SVector::<f64, DOF>::zeros();
        for (&step, pose) in self.steps.iter().zip(&self.poses).rev() {
            let step = &odometry.directed[step];
            let error = step.measurement.between(pose).log();
            let to_end = whole.inverse().adjoint() * G::right_jacobian(&error);
            covariance += to_end * step.covariance * to_end.transpose();
            pull += to_end * error;
            whole = pose.compose(&whole);
        }
        let information = covariance.cholesky()?.inverse();
        let jacobian = G::right_jacobian(&pull);
        let weight = jacobian.transpose() * information * jacobian;
        let edge = Edge::new(
            self.from,
            self.to,
            whole.compose(&G::exp(&-pull)),
            (weight + weight.transpose()) * 0.5,
            EdgeKind::Odometry,
        );
        Some(Condensed { edge, whole, pull, information })
    }

    /// Moves the steps so that the ends get the relative pose `ends`, to first order: `r_i = S_i B_i^T L (d + p)`.
    pub(crate) fn bend<const DOF: usize>(
        &mut self,
        odometry: &Odometry<G, DOF>,
        condensed: &Condensed<G, DOF>,
        ends: &G,
    ) where
        G: LieGroup<DOF>,
    {
        let force = condensed.information * (condensed.whole.between(ends).log() + condensed.pull);
        let mut after = G::identity();
        for (&step, pose) in self.steps.iter().zip(&mut self.poses).rev() {
            let step = &odometry.directed[step];
            let error = step.measurement.between(pose).log();
            let jacobian = G::right_jacobian(&error);
            let to_end = after.inverse().adjoint() * jacobian;
            let residual = step.covariance * (to_end.transpose() * force);
            after = pose.compose(&after);
            *pose = pose.compose(&G::exp(&(jacobian * (residual - error))));
        }
    }
}
