//! A grid as the opacity of ink, for pages that choose their own colours.

use std::io::Write;

use crate::Grid;

/// Opacities that the picture tells apart: four bits a cell.
const LEVELS: u8 = 15;

/// The opacity of a cell that is certainly free. Unknown cells have none, so that the building shows on any ground.
const FLOOR: f64 = 0.14;

/// Writes the grid as PNG in one colour, black, whose opacity is what is known: unknown cells are transparent, free ones faint, occupied
/// ones opaque. The first row is at the largest y. The same grid gives the same bytes. O(cells).
pub fn write_opacity(grid: &Grid, writer: impl Write) -> Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(writer, grid.width as u32, grid.height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Four);
    encoder.set_palette(vec![0; 3 * (usize::from(LEVELS) + 1)]);
    encoder.set_trns((0..=LEVELS).map(|level| level * (u8::MAX / LEVELS)).collect::<Vec<u8>>());
    encoder.set_compression(png::Compression::High);
    // Neighbouring indices of a palette do not predict each other.
    encoder.set_filter(png::Filter::NoFilter);
    let mut rows = Vec::with_capacity(grid.width.div_ceil(2) * grid.height);
    for row in (0..grid.height).rev() {
        let level = |column: usize| {
            if column < grid.width { level(grid.probability(column, row)) } else { 0 }
        };
        // Two cells a byte, the left one in its upper half.
        rows.extend((0..grid.width).step_by(2).map(|column| (level(column) << 4) | level(column + 1)));
    }
    let mut body = encoder.write_header()?;
    body.write_image_data(&rows)?;
    body.finish()
}

/// The level of a probability of being occupied: from none at one half it rises to `FLOOR` at 0 and to all at 1.
fn level(occupied: f64) -> u8 {
    let certainty = 2.0 * occupied - 1.0;
    let opacity = if certainty < 0.0 { -certainty * FLOOR } else { certainty };
    (opacity * f64::from(LEVELS)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::level;

    #[test]
    fn walls_are_opaque_floors_faint_and_the_unknown_is_nothing() {
        assert_eq!([0.0, 0.12, 0.5, 0.97, 1.0].map(level), [2, 2, 0, 14, 15]);
    }
}
