//! Poses of a dataset.

use posecut_graph::Dimension;

use crate::jrl::document::Value;

/// The components of a pose. The error is a problem and its remedy, without place.
pub(super) fn pose(value: &Value, dimension: Dimension) -> Result<Vec<f64>, (String, &'static str)> {
    let expected = match dimension {
        Dimension::Two => "Pose2",
        Dimension::Three => "Pose3",
    };
    if let Some(kind) = value.kind.as_deref().filter(|kind| *kind != expected) {
        return Err((format!("the value is a {kind}, not a {expected}"), "correct its type"));
    }
    match dimension {
        Dimension::Two => match value.planar {
            [Some(x), Some(y), Some(theta)] => Ok(vec![x, y, theta]),
            _ => Err(("the pose has no x, y or theta".to_owned(), "a Pose2 has x, y and theta")),
        },
        Dimension::Three => {
            let (Some(translation), Some(rotation)) = (&value.translation, &value.rotation) else {
                return Err((
                    "the pose has no translation or rotation".to_owned(),
                    "a Pose3 has translation [x, y, z] and rotation [w, x, y, z]",
                ));
            };
            let (&[x, y, z], &[qw, qx, qy, qz]) = (translation.as_slice(), rotation.as_slice()) else {
                return Err((
                    format!(
                        "the translation has {} and the rotation {} numbers",
                        translation.len(),
                        rotation.len()
                    ),
                    "a Pose3 has translation [x, y, z] and rotation [w, x, y, z]",
                ));
            };
            let norm = [qw, qx, qy, qz].iter().map(|component| component * component).sum::<f64>().sqrt();
            if !((norm - 1.0).abs() <= 1e-3) {
                return Err((format!("the quaternion has norm {norm}, not 1"), "the order is w, x, y, z"));
            }
            // Few printed digits leave a quaternion slightly off unit norm: normalise it.
            let norm = if (norm - 1.0).abs() > 1e-9 { norm } else { 1.0 };
            Ok(vec![x, y, z, qx / norm, qy / norm, qz / norm, qw / norm])
        }
    }
}
