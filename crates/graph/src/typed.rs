//! Converts lists of numbers to motions and matrices.
//!
//! The dimension is known only when a file is read, but the mathematics is generic over the group of motions.
//! [`for_dimension!`](crate::for_dimension) is the only code that turns a [`Dimension`] into a group.

use nalgebra::SMatrix;
use posecut_geometry::covariance::{PackingError, unpack_upper_triangle};
use posecut_geometry::{LieGroup, SE2, SE3};

use crate::{Dimension, Edge, PoseGraph};

/// Runs an expression with the group of motions of a [`Dimension`]: [`SE2`] with 3 degrees of freedom, or [`SE3`] with 6.
///
/// ```
/// use posecut_geometry::LieGroup;
/// use posecut_graph::{Dimension, for_dimension};
///
/// fn freedom<G: LieGroup<DOF>, const DOF: usize>() -> usize {
///     DOF
/// }
/// assert_eq!(for_dimension!(Dimension::Three, |G, DOF| freedom::<G, DOF>()), 6);
/// ```
#[macro_export]
macro_rules! for_dimension {
    ($dimension:expr, |$group:ident, $freedom:ident| $body:expr) => {
        match $dimension {
            $crate::Dimension::Two => {
                type $group = $crate::SE2;
                const $freedom: usize = 3;
                $body
            }
            $crate::Dimension::Three => {
                type $group = $crate::SE3;
                const $freedom: usize = 6;
                $body
            }
        }
    };
}

/// A field of a record that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{record}: its {field} cannot be used{reason}")]
pub struct UnusableField {
    record: String,
    field: &'static str,
    reason: String,
}

impl Dimension {
    /// A pose in components as a motion in space; the plane is `z = 0`. `None` if the components are not a pose.
    pub fn spatial(self, components: &[f64]) -> Option<SE3> {
        match self {
            Self::Two => SE2::from_components(components).map(|pose| pose.to_spatial()),
            Self::Three => SE3::from_components(components),
        }
    }

    /// The components of a motion in space; in dimension 2, those of its projection to the plane.
    pub fn components(self, pose: &SE3) -> Vec<f64> {
        match self {
            Self::Two => pose.to_planar().components(),
            Self::Three => pose.components(),
        }
    }

    /// The components of the pose at the origin.
    pub fn identity(self) -> Vec<f64> {
        crate::for_dimension!(self, |G, DOF| <G as LieGroup<DOF>>::identity().components())
    }
}

impl PoseGraph {
    /// The estimate of every node; the identity for a node without one.
    pub fn poses<G: LieGroup<DOF>, const DOF: usize>(&self) -> Result<Vec<G>, UnusableField> {
        let pose = |node: &crate::Node| {
            G::from_components(&node.pose_or_identity(self.header.dimension)).ok_or_else(|| UnusableField {
                record: format!("node {}", node.id),
                field: "pose",
                reason: String::new(),
            })
        };
        self.nodes.iter().map(pose).collect()
    }

    /// The measured motion of an edge, and the information matrix of its error in the order translation, rotation. `None` if one
    /// of them is missing.
    pub fn measurement<G: LieGroup<DOF>, const DOF: usize>(
        &self,
        edge: &Edge,
    ) -> Result<Option<(G, SMatrix<f64, DOF, DOF>)>, UnusableField> {
        let refused = |field, reason| UnusableField { record: edge.name(), field, reason };
        let Some(components) = &edge.measurement else { return Ok(None) };
        let motion = G::from_components(components).ok_or_else(|| refused("measurement", String::new()));
        match self.information_matrix(edge) {
            None => Ok(None),
            Some(information) => {
                let information = information.map_err(|error| refused("information", format!(": {error}")));
                Ok(Some((motion?, information?)))
            }
        }
    }

    /// The information matrix of an edge, its own or that of its noise model, in the order translation, rotation. `None` if it is
    /// missing.
    pub fn information_matrix<const DOF: usize>(
        &self,
        edge: &Edge,
    ) -> Option<Result<SMatrix<f64, DOF, DOF>, PackingError>> {
        self.information(edge).map(unpack_upper_triangle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plane_and_space_agree_about_a_pose() {
        let planar = [1.0, 2.0, 0.5];
        let spatial = Dimension::Two.spatial(&planar).unwrap();
        for (found, expected) in Dimension::Two.components(&spatial).iter().zip(planar) {
            assert!((found - expected).abs() < 1e-15, "{found} and {expected}");
        }
        assert_eq!(Dimension::Two.identity(), [0.0; 3]);
        assert_eq!(Dimension::Three.identity(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(Dimension::Three.spatial(&planar), None);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0,"pose":[0,0,0]}
{"kind":"node","id":1}
{"kind":"landmark","id":5,"from":0,"to":1,"measurement":[1,0,0],"information":[1,0,0,1,0,1]}
{"kind":"landmark","id":6,"from":0,"to":1}
"#;
        let mut graph = PoseGraph::read("test", text.as_bytes()).unwrap();
        let measured = |graph: &PoseGraph, edge: usize| graph.measurement::<SE2, 3>(&graph.edges[edge]);
        let (motion, information) = measured(&graph, 0).unwrap().unwrap();
        assert_eq!((motion, information), (SE2::new(1.0, 0.0, 0.0), SMatrix::identity()));
        assert_eq!(measured(&graph, 1).unwrap(), None);
        assert_eq!(graph.poses::<SE2, 3>().unwrap(), [SE2::identity(); 2]);
        graph.edges[0].information = Some(vec![1.0]);
        let said = measured(&graph, 0).unwrap_err().to_string();
        assert!(said.starts_with("landmark 5: its information cannot be used: "), "{said}");
        graph.nodes[1].pose = Some(vec![f64::NAN; 3]);
        let said = graph.poses::<SE2, 3>().unwrap_err().to_string();
        assert_eq!(said, "node 1: its pose cannot be used");
    }
}
