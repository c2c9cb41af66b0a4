//! Rigid motions of the plane.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::{Complex, Matrix2, Matrix3, UnitComplex, Vector2, Vector3};

use crate::lie_group::LieGroup;
use crate::se3::SE3;
use crate::trigonometric::{Trigonometric, half_cotangent};
use crate::wrap_angle;

/// A pose in the plane: translation in metres, rotation as a unit complex number. Tangent order `[x, y, theta]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SE2 {
    /// Position of the frame's origin, metres.
    pub translation: Vector2<f64>,
    /// Heading of the frame, anticlockwise from the x axis.
    pub rotation: UnitComplex<f64>,
}

impl SE2 {
    /// The pose at `(x, y)` metres with heading `theta` radians.
    pub fn new(x: f64, y: f64, theta: f64) -> Self {
        Self { translation: Vector2::new(x, y), rotation: UnitComplex::new(theta) }
    }

    /// Heading in `(-pi, pi]` radians.
    #[inline]
    pub fn angle(&self) -> f64 {
        wrap_angle(self.rotation.angle())
    }

    /// The same motion in space: z, roll and pitch are 0.
    pub fn to_spatial(&self) -> SE3 {
        SE3::from_euler(self.translation.x, self.translation.y, 0.0, 0.0, 0.0, self.angle())
    }
}

/// `V`, which maps the tangent's translation to the group's. Solà equation (158).
#[inline(always)]
fn translation_jacobian(theta: f64, functions: &Trigonometric) -> Matrix2<f64> {
    let sine = functions.c1;
    let versine = theta * functions.c2;
    Matrix2::new(sine, -versine, versine, sine)
}

/// `V^-1 = [(a/2) cot(a/2), a/2; -a/2, (a/2) cot(a/2)]`.
#[inline(always)]
fn translation_jacobian_inverse(theta: f64) -> Matrix2<f64> {
    let diagonal = 1.0 - theta * theta * half_cotangent(theta * theta);
    Matrix2::new(diagonal, 0.5 * theta, -0.5 * theta, diagonal)
}

/// Last column of the left Jacobian above its 1. Solà equation (164).
#[inline(always)]
fn rotation_column(tangent: &Vector3<f64>, functions: &Trigonometric) -> Vector2<f64> {
    let along = tangent.z * functions.c3;
    let across = functions.c2;
    Vector2::new(tangent.x * along + tangent.y * across, tangent.y * along - tangent.x * across)
}

/// The matrix `[block, column; 0, 1]`.
#[inline(always)]
fn bordered(block: &Matrix2<f64>, column: &Vector2<f64>) -> Matrix3<f64> {
    Matrix3::new(block.m11, block.m12, column.x, block.m21, block.m22, column.y, 0.0, 0.0, 1.0)
}

impl LieGroup<3> for SE2 {
    const COMPONENTS: usize = 3;

    fn identity() -> Self {
        Self { translation: Vector2::zeros(), rotation: UnitComplex::identity() }
    }

    fn from_components(components: &[f64]) -> Option<Self> {
        match *components {
            [x, y, theta] if components.iter().all(|value| value.is_finite()) => Some(Self::new(x, y, theta)),
            _ => None,
        }
    }

    fn components(&self) -> Vec<f64> {
        vec![self.translation.x, self.translation.y, self.angle()]
    }

    #[inline(always)]
    fn exp(tangent: &Vector3<f64>) -> Self {
        let functions = Trigonometric::of_squared_angle(tangent.z * tangent.z);
        Self {
            translation: translation_jacobian(tangent.z, &functions) * tangent.xy(),
            rotation: UnitComplex::new(tangent.z),
        }
    }

    #[inline(always)]
    fn log(&self) -> Vector3<f64> {
        let theta = self.angle();
        let translation = translation_jacobian_inverse(theta) * self.translation;
        Vector3::new(translation.x, translation.y, theta)
    }

    #[inline(always)]
    fn compose(&self, other: &Self) -> Self {
        let product = self.rotation.complex() * other.rotation.complex();
        // One Newton step towards norm 1; otherwise long chains would drift away from rotations.
        let scale = 0.5 * (3.0 - product.norm_sqr());
        Self {
            translation: self.translation + self.rotation * other.translation,
            rotation: UnitComplex::new_unchecked(Complex::new(product.re * scale, product.im * scale)),
        }
    }

    #[inline(always)]
    fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self { translation: -(rotation * self.translation), rotation }
    }

    /// `[R, (y, -x); 0, 1]`, Solà equation (159).
    #[inline(always)]
    fn adjoint(&self) -> Matrix3<f64> {
        let rotation = self.rotation.to_rotation_matrix().into_inner();
        bordered(&rotation, &Vector2::new(self.translation.y, -self.translation.x))
    }

    /// `[theta J, (y, -x); 0, 0]` with the right angle `J`.
    #[inline(always)]
    fn bracket(tangent: &Vector3<f64>) -> Matrix3<f64> {
        let (x, y, theta) = (tangent.x, tangent.y, tangent.z);
        Matrix3::new(0.0, -theta, y, theta, 0.0, -x, 0.0, 0.0, 0.0)
    }

    fn left_jacobian(tangent: &Vector3<f64>) -> Matrix3<f64> {
        let functions = Trigonometric::of_squared_angle(tangent.z * tangent.z);
        bordered(&translation_jacobian(tangent.z, &functions), &rotation_column(tangent, &functions))
    }

    #[inline(always)]
    fn left_jacobian_inverse(tangent: &Vector3<f64>) -> Matrix3<f64> {
        let functions = Trigonometric::of_squared_angle(tangent.z * tangent.z);
        let inverse = translation_jacobian_inverse(tangent.z);
        bordered(&inverse, &-(inverse * rotation_column(tangent, &functions)))
    }

    fn translation(&self) -> [f64; 3] {
        [self.translation.x, self.translation.y, 0.0]
    }

    fn rotation_angle(&self) -> f64 {
        self.angle().abs()
    }
}
