//! Information matrices from two standard deviations.

use super::packing::packed_length;
use crate::translations;

/// The upper triangle, row-major, of the information matrix of independent axes with one standard deviation for all
/// translations (metres) and one for all rotations (radians): `1/sigma^2` on the diagonal. `degrees_of_freedom` is 3 in
/// the plane (two translations, one rotation) and 6 in space (three of each).
pub fn isotropic_information(
    degrees_of_freedom: usize,
    sigma_translation: f64,
    sigma_rotation: f64,
) -> Vec<f64> {
    let mut packed = Vec::with_capacity(packed_length(degrees_of_freedom));
    for row in 0..degrees_of_freedom {
        let sigma = if row < translations(degrees_of_freedom) { sigma_translation } else { sigma_rotation };
        packed.push(1.0 / (sigma * sigma));
        packed.extend(std::iter::repeat_n(0.0, degrees_of_freedom - row - 1));
    }
    packed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonals_stand_where_the_packing_has_them() {
        assert_eq!(isotropic_information(3, 0.5, 0.25), [4.0, 0.0, 0.0, 4.0, 0.0, 16.0]);
        let spatial = isotropic_information(6, 0.5, 0.25);
        assert_eq!(spatial.len(), 21);
        assert_eq!([0, 6, 11, 15, 18, 20].map(|place| spatial[place]), [4.0, 4.0, 4.0, 16.0, 16.0, 16.0]);
        assert_eq!(spatial.iter().sum::<f64>(), 60.0);
    }
}
