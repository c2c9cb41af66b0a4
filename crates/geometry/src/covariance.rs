//! Covariances of poses: right perturbations in the tangent space, order translation then rotation.

mod definiteness;
mod information;
mod isotropic;
mod packing;
mod propagation;

pub use definiteness::{Definiteness, definiteness, negative_eigenvalue};
pub use information::{CovarianceError, covariance_from_information, information_from_covariance};
pub use isotropic::isotropic_information;
pub use packing::{PackingError, pack_upper_triangle, packed_length, unpack_upper_triangle};
pub use propagation::{
    between, between_correlated, compose, compose_correlated, inverse, to_body, to_reference,
};
