//! Unary measurements: the pose of a node, or its position alone.

use crate::{Dimension, EdgeTruth, Extra};

/// What a prior measures. The number of its components tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PriorOf {
    /// The whole pose: 3 components in the plane, 7 in space.
    Pose,
    /// The position alone: 2 components in the plane, 3 in space.
    Position,
}

impl PriorOf {
    /// What a measurement of so many components measures; `None` if it is neither a pose nor a position.
    pub fn of_components(dimension: Dimension, components: usize) -> Option<Self> {
        [Self::Pose, Self::Position].into_iter().find(|of| of.components(dimension) == components)
    }

    /// Number of components of the measurement.
    pub fn components(self, dimension: Dimension) -> usize {
        match self {
            Self::Pose => dimension.pose_components(),
            Self::Position => dimension.position_components(),
        }
    }

    /// Terms of the upper triangle of its information matrix.
    pub fn information_terms(self, dimension: Dimension) -> usize {
        match self {
            Self::Pose => dimension.information_terms(),
            Self::Position => {
                let side = dimension.position_components();
                side * (side + 1) / 2
            }
        }
    }
}

/// A measurement of one node in the frame of the map: of its pose, or of its position alone (such as GPS).
///
/// With the pose `X = (R, t)` of the node, the error of a pose `Z` is `Log(Z^-1 X)`, a right perturbation of the measurement as
/// in an edge, and that of a position `z` is `t - z`, along the axes of the map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Prior {
    /// The id, unique among priors.
    pub id: u64,
    /// The node that is measured.
    pub node: u64,
    /// The measured pose (`[x, y, theta]` or `[x, y, z, qx, qy, qz, qw]`) or position (`[x, y]` or `[x, y, z]`).
    pub measurement: Vec<f64>,
    /// Upper triangle of the information matrix, row-major.
    pub information: Option<Vec<f64>>,
    /// The name of a noise model in the header, instead of `information`; only for a pose.
    pub noise: Option<String>,
    /// The sensor or program that the measurement comes from, such as `gps`.
    pub source: Option<String>,
    /// The truth, which only construction and evaluation may read.
    pub truth: Option<EdgeTruth>,
    /// The stage that rejected the prior; absent while it is in use.
    pub rejected_by: Option<String>,
    /// The confidence of the program that proposed the prior.
    pub score: Option<f64>,
    /// Unknown fields, passed through.
    pub extra: Extra,
}

impl Prior {
    /// What it measures; `None` if the number of components is wrong, which the reader refuses.
    pub fn of(&self, dimension: Dimension) -> Option<PriorOf> {
        PriorOf::of_components(dimension, self.measurement.len())
    }

    /// Whether the prior is in use: no stage has rejected it.
    pub fn in_use(&self) -> bool {
        self.rejected_by.is_none()
    }

    /// Marks the prior as rejected by a stage. If it is already rejected, the earlier stage's name stays.
    pub fn reject(&mut self, stage: &str) {
        self.rejected_by.get_or_insert_with(|| stage.to_owned());
    }

    /// Kind and id, as messages name the prior.
    pub fn name(&self) -> String {
        format!("prior {}", self.id)
    }
}
