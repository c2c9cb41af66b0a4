//! Priors of g2o, as `edge_se2_prior.cpp`, `edge_se2_xyprior.cpp`, `edge_se3_prior.cpp` and `parameter_se3_offset.cpp` read them.
//!
//! - `EDGE_PRIOR_SE2 vertex x y theta` and the 6 terms of the information matrix.
//! - `EDGE_PRIOR_SE2_XY vertex x y` and 3 terms.
//! - `EDGE_SE3_PRIOR vertex parameter x y z qx qy qz qw` and 21 terms. `parameter` names the offset `P` of a sensor on the vertex,
//!   `PARAMS_SE3OFFSET parameter x y z qx qy qz qw`, and the error is that of `Z^-1 X P`. With `Z' = Z P^-1` this is
//!   `P^-1 (Z'^-1 X) P`, whose logarithm is `Ad(P^-1) Log(Z'^-1 X)`: a prior without offset, with the information matrix
//!   `Ad(P^-1)^T Omega Ad(P^-1)`.
//!
//! Without information about the rotation, the translation of g2o's error is `R_Z^T (t - z)`, and such a prior measures the position
//! `z` with the information `R_Z Omega R_Z^T`.

use nalgebra::SMatrix;
use posecut_geometry::covariance::{pack_upper_triangle, unpack_upper_triangle};
use posecut_geometry::{LieGroup, SE3};
use posecut_graph::{
    Dimension, Prior, PriorOf, for_dimension, negative_eigenvalue, negative_eigenvalue_of_position,
};

use super::Reader;
use crate::ConvertError;
use crate::information::{Repair, clamp};

impl Reader<'_> {
    /// Reads a prior in the plane.
    pub(super) fn planar_prior(&mut self, of: PriorOf, fields: &[&str]) -> Result<(), ConvertError> {
        self.agree(Dimension::Two)?;
        let Some((vertex, rest)) = fields.split_first() else {
            return Err(self.refuse("the prior has no vertex", "the line is cut short"));
        };
        let node = self.id(vertex)?;
        let count = of.components(Dimension::Two);
        let mut measurement = self.numbers(rest, count + of.information_terms(Dimension::Two))?;
        let information = measurement.split_off(count);
        match of {
            PriorOf::Pose => self.pose_prior(Dimension::Two, node, measurement, information),
            PriorOf::Position => {
                self.refuse_indefinite(negative_eigenvalue_of_position(Dimension::Two, &information), node)?;
                self.add_prior(node, measurement, information);
                Ok(())
            }
        }
    }

    /// Reads a prior in space.
    pub(super) fn spatial_prior(&mut self, fields: &[&str]) -> Result<(), ConvertError> {
        let dimension = Dimension::Three;
        self.agree(dimension)?;
        let [vertex, parameter, rest @ ..] = fields else {
            return Err(self.refuse("the prior lacks its vertex or its parameter", "the line is cut short"));
        };
        let node = self.id(vertex)?;
        let parameter = self.id(parameter)?;
        let Some(&offset) = self.offsets.get(&parameter) else {
            return Err(self.refuse(
                format!("no line above defines parameter {parameter}"),
                "put PARAMS_SE3OFFSET before the lines that name it",
            ));
        };
        let count = dimension.pose_components();
        let mut numbers = self.numbers(rest, count + dimension.information_terms())?;
        let information = numbers.split_off(count);
        let measurement = self.pose(dimension, numbers)?;
        if offset == SE3::identity() {
            return self.pose_prior(dimension, node, measurement, information);
        }
        if weighs_position_alone(dimension, &information) && offset.translation.norm() > 0.0 {
            return Err(self.refuse(
                format!(
                    "the prior measures the position of a point beside vertex {node}, because parameter {parameter} has a translation"
                ),
                "no prior of posecut holds that; give the position of the vertex, or information about its rotation",
            ));
        }
        let (Some(measured), Ok(matrix)) =
            (SE3::from_components(&measurement), unpack_upper_triangle::<6>(&information))
        else {
            return Err(self.refuse("the prior cannot be used", "correct its numbers"));
        };
        let adjoint = offset.inverse().adjoint();
        let moved: SMatrix<f64, 6, 6> = adjoint.tr_mul(&matrix) * adjoint;
        let measurement = measured.compose(&offset.inverse()).components();
        self.pose_prior(dimension, node, measurement, pack_upper_triangle(&moved))
    }

    /// Reads `PARAMS_SE3OFFSET`.
    pub(super) fn offset(&mut self, fields: &[&str]) -> Result<(), ConvertError> {
        let Some((id, rest)) = fields.split_first() else {
            return Err(self.refuse("the parameter has no id", "the line is cut short"));
        };
        let id = self.id(id)?;
        let dimension = Dimension::Three;
        let pose = self.pose(dimension, self.numbers(rest, dimension.pose_components())?)?;
        let offset = SE3::from_components(&pose)
            .ok_or_else(|| self.refuse("the parameter is not a pose", "correct its numbers"))?;
        match self.offsets.insert(id, offset) {
            Some(before) if before != offset => Err(self.refuse(
                format!("parameter {id} occurs twice, with different numbers"),
                "keep one of the two",
            )),
            _ => Ok(()),
        }
    }

    /// Adds the prior of a pose, or of its position if that is all it measures.
    fn pose_prior(
        &mut self,
        dimension: Dimension,
        node: u64,
        measurement: Vec<f64>,
        mut information: Vec<f64>,
    ) -> Result<(), ConvertError> {
        let negative = negative_eigenvalue(dimension, &information);
        if negative.is_some() && self.options.repair != Repair::Refuse {
            information = clamp(dimension, &information).ok_or_else(|| {
                self.refuse(
                    format!("the information matrix of the prior of {node} is too large to be repaired"),
                    "correct it at its source",
                )
            })?;
            self.summary.repaired += 1;
        } else {
            self.refuse_indefinite(negative, node)?;
        }
        if !weighs_position_alone(dimension, &information) {
            self.add_prior(node, measurement, information);
            return Ok(());
        }
        let Some(information) = turned(dimension, &measurement, &information) else {
            return Err(self.refuse("the prior cannot be used", "correct its numbers"));
        };
        let position = measurement[..dimension.position_components()].to_vec();
        self.add_prior(node, position, information);
        Ok(())
    }

    fn refuse_indefinite(&self, eigenvalue: Option<f64>, node: u64) -> Result<(), ConvertError> {
        let Some(eigenvalue) = eigenvalue else { return Ok(()) };
        Err(self.refuse(
            format!(
                "the information matrix of the prior of {node} is not positive semidefinite: its smallest eigenvalue is {eigenvalue:e}"
            ),
            "correct it at its source, or use --repair-information to set negative eigenvalues of poses to zero",
        ))
    }

    /// Adds a prior, unless an earlier file has the same.
    fn add_prior(&mut self, node: u64, measurement: Vec<f64>, information: Vec<f64>) {
        let same = |prior: &Prior| {
            prior.measurement == measurement && prior.information.as_ref() == Some(&information)
        };
        let repeated = self.earlier.priors.get(&node).into_iter().flatten().any(|&at| same(&self.priors[at]));
        if !repeated {
            let id = self.priors.len() as u64;
            let information = Some(information);
            self.priors.push(Prior { id, node, measurement, information, ..Prior::default() });
        }
    }
}

/// Whether all terms of the rotation are zero.
fn weighs_position_alone(dimension: Dimension, information: &[f64]) -> bool {
    let (side, axes) = (dimension.degrees_of_freedom(), dimension.position_components());
    let rows = (0..side).flat_map(|row| (row..side).map(move |column| row.max(column)));
    rows.zip(information).all(|(last, &term)| last < axes || term == 0.0)
}

/// `R_Z Omega R_Z^T` for the translation. Without rotation the terms keep their bits.
fn turned(dimension: Dimension, measurement: &[f64], information: &[f64]) -> Option<Vec<f64>> {
    let axes = dimension.position_components();
    for_dimension!(dimension, |G, DOF| {
        let motion = G::from_components(measurement)?;
        let mut matrix = unpack_upper_triangle::<DOF>(information).ok()?;
        if motion.components()[axes..] != G::identity().components()[axes..] {
            // The adjoint of a pose begins with its rotation.
            let adjoint = motion.adjoint();
            let rotation = SMatrix::<f64, DOF, DOF>::from_fn(|row, column| {
                if row.max(column) < axes { adjoint[(row, column)] } else { 0.0 }
            });
            matrix = rotation * matrix * rotation.transpose();
        }
        Some((0..axes).flat_map(|row| (row..axes).map(move |column| matrix[(row, column)])).collect())
    })
}
