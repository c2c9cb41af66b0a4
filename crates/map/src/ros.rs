//! Maps of ROS (`map_server`, `nav2_map_server`): a PGM picture and a YAML file that describes it.
//!
//! In the picture 0 is occupied, 254 free, 205 unknown, as `map_saver` writes them.

use std::io::Write;

use crate::{Cell, Grid};

/// Writes the picture, the first row at the largest y. O(cells).
pub fn write_pgm(grid: &Grid, writer: &mut dyn Write) -> std::io::Result<()> {
    write!(writer, "P5\n{} {}\n255\n", grid.width, grid.height)?;
    for row in (0..grid.height).rev() {
        let pixel = |column: usize| match grid.cell(column, row) {
            Cell::Occupied => 0,
            Cell::Free => 254,
            Cell::Unknown => 205,
        };
        let pixels: Vec<u8> = (0..grid.width).map(pixel).collect();
        writer.write_all(&pixels)?;
    }
    Ok(())
}

/// Writes the description. `picture` is the name of the PGM file, from the folder of the YAML file.
pub fn write_yaml(grid: &Grid, picture: &str, writer: &mut dyn Write) -> std::io::Result<()> {
    // A YAML string in double quotes has the escapes of JSON for these two.
    let picture = picture.replace('\\', "\\\\").replace('"', "\\\"");
    writeln!(writer, "image: \"{picture}\"")?;
    writeln!(writer, "resolution: {}", grid.resolution)?;
    writeln!(writer, "origin: [{:.6}, {:.6}, 0.0]", grid.corner.x, grid.corner.y)?;
    writeln!(writer, "negate: 0")?;
    writeln!(writer, "occupied_thresh: 0.65")?;
    writeln!(writer, "free_thresh: 0.196")
}
