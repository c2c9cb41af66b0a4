//! Where conjugate gradients leave the region in which a quadratic model is trusted.
//!
//! Lengths in the norm of the preconditioner follow from recurrences, without a product with it (T. Steihaug, "The conjugate gradient
//! method and trust regions in large scale optimization", SIAM J. Numer. Anal. 20(3), 1983).

/// Squared lengths of the step and of the direction, and their product.
pub(crate) struct Lengths {
    step: f64,
    product: f64,
    direction: f64,
    radius: f64,
}

impl Lengths {
    /// At the first direction, whose squared length is the `decrease`; no step has been taken.
    pub(crate) fn new(decrease: f64, radius: f64) -> Self {
        Self { step: 0.0, product: 0.0, direction: decrease, radius }
    }

    /// The share of the direction that leads to the boundary, if a step by `length` leads beyond it or the curvature is not positive.
    pub(crate) fn boundary(&self, length: f64, curvature: f64) -> Option<f64> {
        if curvature > 0.0 && self.after(length) < self.radius * self.radius {
            return None;
        }
        let rest = self.direction * (self.radius * self.radius - self.step);
        Some(((self.product * self.product + rest).sqrt() - self.product) / self.direction)
    }

    /// Takes a step by `length`, and turns to the next direction: the preconditioned residual, whose product with the residual is the
    /// `decrease`, and `ratio` times the direction before.
    pub(crate) fn turn(&mut self, length: f64, decrease: f64, ratio: f64) {
        self.step = self.after(length);
        self.product = ratio * (self.product + length * self.direction);
        self.direction = decrease + ratio * ratio * self.direction;
    }

    /// The squared length of the step after a step by `length`.
    fn after(&self, length: f64) -> f64 {
        self.step + 2.0 * length * self.product + length * length * self.direction
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;

    /// Minimises `2 g^T d + d^T A d`, preconditioned by a diagonal `D`, and compares with `|d|` in the norm of `D`.
    fn length(matrix: &Matrix3<f64>, radius: f64) -> f64 {
        let diagonal = Vector3::new(1.0, 4.0, 0.5);
        let mut residual = Vector3::new(1.0, -2.0, 0.7);
        let mut direction = residual.component_div(&diagonal);
        let mut decrease = residual.dot(&direction);
        let mut lengths = Lengths::new(decrease, radius);
        let mut step = Vector3::zeros();
        for _ in 0..3 {
            let product = matrix * direction;
            let curvature = direction.dot(&product);
            let length = decrease / curvature;
            if let Some(share) = lengths.boundary(length, curvature) {
                step += direction * share;
                break;
            }
            step += direction * length;
            residual -= product * length;
            let preconditioned = residual.component_div(&diagonal);
            let next = residual.dot(&preconditioned);
            lengths.turn(length, next, next / decrease);
            direction = preconditioned + direction * (next / decrease);
            decrease = next;
        }
        step.component_mul(&diagonal).dot(&step).sqrt()
    }

    #[test]
    fn steps_end_at_the_boundary() {
        let definite = Matrix3::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, 0.4);
        let indefinite = Matrix3::new(2.0, 0.3, 0.1, 0.3, 1.0, -0.2, 0.1, -0.2, -0.4);
        let free = length(&definite, 1e9);
        assert!(free > 1.5, "{free}");
        for radius in [0.1, 0.5, 1.0, 1.4] {
            assert!((length(&definite, radius) - radius).abs() < 1e-12, "{radius}");
        }
        assert!((length(&definite, 1.1 * free) - free).abs() < 1e-12);
        for radius in [0.1, 1.0, 10.0, 1e3] {
            assert!((length(&indefinite, radius) - radius).abs() < 1e-9 * radius, "{radius}");
        }
    }
}
