//! Checks on a record beyond being JSON with the right fields.

use std::collections::HashSet;

use crate::definiteness::{negative_eigenvalue, negative_eigenvalue_of_position};
use crate::error::Problem;
use crate::{Dimension, Edge, EdgeKind, Header, Node, Prior, PriorOf};

/// The largest accepted distance of a quaternion's norm from 1.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// Checks records against a header. It remembers the last valid information matrix, because successive edges often share one
/// and the eigenvalues are expensive.
pub(crate) struct Validator {
    pub(crate) dimension: Dimension,
    noise_models: HashSet<String>,
    last_definite: Vec<f64>,
}

impl Validator {
    pub(crate) fn new(header: &Header) -> Result<Self, Problem> {
        let mut validator =
            Self { dimension: header.dimension, noise_models: HashSet::new(), last_definite: Vec::new() };
        for (name, model) in &header.noise_models {
            validator.information(&model.information).map_err(|problem| {
                problem.record("header").field(format!("noise_models.{name}.information"))
            })?;
            validator.noise_models.insert(name.clone());
        }
        Ok(validator)
    }

    pub(crate) fn node(&self, node: &Node) -> Result<(), Problem> {
        let name = || format!("node {}", node.id);
        if let Some(pose) = &node.pose {
            self.pose(pose).map_err(|problem| problem.record(name()).field("pose"))?;
        }
        if let Some(pose) = node.truth.as_ref().and_then(|truth| truth.pose.as_ref()) {
            self.pose(pose).map_err(|problem| problem.record(name()).field("truth.pose"))?;
        }
        Ok(())
    }

    pub(crate) fn edge(&mut self, edge: &Edge) -> Result<(), Problem> {
        if edge.from == edge.to {
            return Err(Problem::new(
                format!("the edge joins node {} to itself", edge.from),
                "remove the edge or correct its ends",
            )
            .record(edge.name())
            .field("to"));
        }
        if let Some(measurement) = &edge.measurement {
            self.pose(measurement).map_err(|problem| problem.record(edge.name()).field("measurement"))?;
        }
        if let Some(information) = &edge.information {
            self.information(information)
                .map_err(|problem| problem.record(edge.name()).field("information"))?;
        }
        if let Some(noise) = &edge.noise
            && !self.noise_models.contains(noise)
        {
            return Err(Problem::new(
                format!("the header has no noise model \"{noise}\""),
                "add it to the header's noise_models, or give the edge its own information",
            )
            .record(edge.name())
            .field("noise"));
        }
        if edge.noise.is_some() && edge.information.is_some() {
            return Err(Problem::new(
                "the edge has both \"noise\" and \"information\", which may disagree",
                "keep one of the two",
            )
            .record(edge.name())
            .field("noise"));
        }
        self.completeness(edge)
    }

    pub(crate) fn prior(&mut self, prior: &Prior) -> Result<(), Problem> {
        let at = |problem: Problem, field: &str| problem.record(prior.name()).field(field);
        let dimension = self.dimension;
        let Some(of) = prior.of(dimension) else {
            let (pose, position) = (dimension.pose_layout(), dimension.position_layout());
            return Err(at(
                Problem::new(
                    format!(
                        "expected {} or {} numbers, found {}",
                        dimension.pose_components(),
                        dimension.position_components(),
                        prior.measurement.len()
                    ),
                    format!(
                        "a prior of dimension {dimension} measures a pose {pose} or a position {position}"
                    ),
                ),
                "measurement",
            ));
        };
        if of == PriorOf::Pose {
            self.pose(&prior.measurement).map_err(|problem| at(problem, "measurement"))?;
        }
        if let Some(information) = &prior.information {
            match of {
                PriorOf::Pose => self.information(information),
                PriorOf::Position => self.information_of_position(information),
            }
            .map_err(|problem| at(problem, "information"))?;
        }
        self.noise_of_prior(prior, of).map_err(|problem| at(problem, "noise"))?;
        if prior.information.is_none() && prior.noise.is_none() {
            let terms = of.information_terms(dimension);
            return Err(at(
                Problem::new(
                    "the prior has no information matrix",
                    format!("add \"information\" ({terms} terms, the upper triangle row by row)"),
                ),
                "information",
            ));
        }
        Ok(())
    }

    fn noise_of_prior(&self, prior: &Prior, of: PriorOf) -> Result<(), Problem> {
        let Some(noise) = &prior.noise else { return Ok(()) };
        if of == PriorOf::Position {
            return Err(Problem::new(
                "a noise model is for poses, but the prior measures a position",
                "give the prior its own information",
            ));
        }
        if !self.noise_models.contains(noise) {
            return Err(Problem::new(
                format!("the header has no noise model \"{noise}\""),
                "add it to the header's noise_models, or give the prior its own information",
            ));
        }
        if prior.information.is_some() {
            return Err(Problem::new(
                "the prior has both \"noise\" and \"information\", which may disagree",
                "keep one of the two",
            ));
        }
        Ok(())
    }

    fn information_of_position(&self, information: &[f64]) -> Result<(), Problem> {
        expect_terms(PriorOf::Position.information_terms(self.dimension), information)?;
        negative_eigenvalue_of_position(self.dimension, information)
            .map_or(Ok(()), |eigenvalue| Err(indefinite(eigenvalue)))
    }

    fn completeness(&self, edge: &Edge) -> Result<(), Problem> {
        let weighed = edge.information.is_some() || edge.noise.is_some();
        let layout = self.dimension.pose_layout();
        if edge.measurement.is_none() && edge.kind == EdgeKind::Odometry {
            return Err(Problem::new(
                "an odometry edge needs a measurement",
                format!("add \"measurement\": {layout}"),
            )
            .record(edge.name())
            .field("measurement"));
        }
        if edge.measurement.is_some() && !weighed {
            return Err(Problem::new(
                "the edge has a measurement, but no information matrix",
                format!(
                    "add \"information\" ({} terms) or \"noise\" (a name from the header)",
                    self.dimension.information_terms()
                ),
            )
            .record(edge.name())
            .field("information"));
        }
        Ok(())
    }

    fn pose(&self, pose: &[f64]) -> Result<(), Problem> {
        let expected = self.dimension.pose_components();
        if pose.len() != expected {
            return Err(Problem::new(
                format!("expected {expected} numbers, found {}", pose.len()),
                format!("a pose of dimension {} is {}", self.dimension, self.dimension.pose_layout()),
            ));
        }
        if self.dimension == Dimension::Three {
            let norm = pose[3..].iter().map(|component| component * component).sum::<f64>().sqrt();
            if !((norm - 1.0).abs() <= QUATERNION_TOLERANCE) {
                return Err(Problem::new(
                    format!("the quaternion has norm {norm}, not 1"),
                    "normalise it; the order is qx, qy, qz, qw",
                ));
            }
        }
        Ok(())
    }

    fn information(&mut self, information: &[f64]) -> Result<(), Problem> {
        expect_terms(self.dimension.information_terms(), information)?;
        if information == self.last_definite {
            return Ok(());
        }
        if let Some(eigenvalue) = negative_eigenvalue(self.dimension, information) {
            return Err(indefinite(eigenvalue));
        }
        self.last_definite.clear();
        self.last_definite.extend_from_slice(information);
        Ok(())
    }
}

fn expect_terms(expected: usize, information: &[f64]) -> Result<(), Problem> {
    if information.len() == expected {
        return Ok(());
    }
    Err(Problem::new(
        format!("expected {expected} numbers, found {}", information.len()),
        "write the upper triangle of the information matrix row by row",
    ))
}

fn indefinite(eigenvalue: f64) -> Problem {
    Problem::new(
        format!("the matrix is not positive semidefinite: its smallest eigenvalue is {eigenvalue:e}"),
        "correct it at its source: an information matrix is the inverse of a covariance",
    )
}
