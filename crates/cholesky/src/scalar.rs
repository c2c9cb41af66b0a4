//! The numbers of a factor: of double or of single precision.

use std::ops::{Add, Mul, MulAssign, Sub, SubAssign};

use faer::traits::RealField;

/// A real number of the machine. A factor of single precision takes half the memory and half the time, and has seven digits: enough to
/// precondition an iteration with residuals of double precision (J. D. Hogg, J. A. Scott, "A fast and robust mixed-precision solver for
/// the solution of sparse symmetric linear systems", 2010).
pub trait Scalar:
    RealField
    + Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + MulAssign
    + SubAssign
{
    /// Zero.
    const ZERO: Self;
    /// The nearest number of this type.
    #[must_use]
    fn of(value: f64) -> Self;
    /// The same number in double precision.
    fn double(self) -> f64;
    /// `self * factor + summand`, rounded once.
    #[must_use]
    fn fused(self, factor: Self, summand: Self) -> Self;
    /// `1 / sqrt(self)`.
    #[must_use]
    fn inverse_root(self) -> Self;
    /// `1 / self`.
    #[must_use]
    fn reciprocal(self) -> Self;
    /// Whether it is neither infinite nor not a number.
    fn finite(self) -> bool;
}

macro_rules! scalar {
    ($type:ty, $of:expr) => {
        impl Scalar for $type {
            const ZERO: Self = 0.0;

            #[inline(always)]
            fn of(value: f64) -> Self {
                $of(value)
            }

            #[inline(always)]
            fn double(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn fused(self, factor: Self, summand: Self) -> Self {
                self.mul_add(factor, summand)
            }

            #[inline(always)]
            fn inverse_root(self) -> Self {
                1.0 / self.sqrt()
            }

            #[inline(always)]
            fn reciprocal(self) -> Self {
                1.0 / self
            }

            #[inline(always)]
            fn finite(self) -> bool {
                self.is_finite()
            }
        }
    };
}

scalar!(f64, |value: f64| value);
scalar!(f32, |value: f64| value as f32);
