//! Random tangent vectors: any angle, tiny ones, and angles near pi, of both signs.

use nalgebra::{Vector3, Vector6};
use proptest::prelude::*;
use std::f64::consts::PI;

/// A signed angle: anything, tiny, or near pi.
fn angle() -> impl Strategy<Value = f64> {
    prop_oneof![
        -3.1..3.1_f64,
        (-16.0..0.0_f64, any::<bool>())
            .prop_map(|(exponent, negative)| signed(10_f64.powf(exponent), negative)),
        (-12.0..-1.0_f64, any::<bool>())
            .prop_map(|(exponent, negative)| signed(PI - 10_f64.powf(exponent), negative)),
        Just(0.0),
    ]
}

fn signed(value: f64, negative: bool) -> f64 {
    if negative { -value } else { value }
}

fn metres() -> impl Strategy<Value = f64> {
    -5.0..5.0_f64
}

/// A tangent vector of the plane with an angle in (-pi, pi).
pub(crate) fn planar_tangent() -> impl Strategy<Value = Vector3<f64>> {
    (metres(), metres(), angle()).prop_map(|(x, y, theta)| Vector3::new(x, y, theta))
}

/// A tangent vector of space with a rotation shorter than pi about any axis.
pub(crate) fn spatial_tangent() -> impl Strategy<Value = Vector6<f64>> {
    let axis = prop_oneof![
        (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64).prop_map(|(x, y, z)| Vector3::new(x, y, z)),
        Just(Vector3::x()),
        Just(Vector3::z()),
    ]
    .prop_filter("an axis has a direction", |axis| axis.norm() > 0.1)
    .prop_map(|axis| axis.normalize());
    (metres(), metres(), metres(), axis, angle()).prop_map(|(x, y, z, axis, angle)| {
        let rotation = axis * angle;
        Vector6::new(x, y, z, rotation.x, rotation.y, rotation.z)
    })
}
