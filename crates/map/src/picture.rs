//! A picture of a grid with trajectories.

use std::collections::BTreeMap;
use std::io::Write;

use nalgebra::Vector2;
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{EdgeKind, PoseGraph};

use crate::Grid;
use crate::rays::cells_between;

/// Colours of sessions, in order, again from the first after the last: those of Okabe and Ito, which colour-blind people can tell
/// apart.
const COLOURS: [[u8; 3]; 7] = [
    [213, 94, 0],
    [0, 114, 178],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [240, 228, 66],
];

/// Grey levels before the colours in the palette: black is occupied, white is free.
const GREYS: usize = 249;

/// A picture with a palette, the first row at the largest y.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Picture {
    /// The probabilities of a grid in greys. O(cells).
    pub fn of_grid(grid: &Grid) -> Self {
        let mut pixels = Vec::with_capacity(grid.width * grid.height);
        for row in (0..grid.height).rev() {
            for column in 0..grid.width {
                let free = 1.0 - grid.probability(column, row);
                pixels.push((free * (GREYS - 1) as f64).round() as u8);
            }
        }
        Self { width: grid.width, height: grid.height, pixels }
    }

    /// Draws the odometry edges, each session in a colour of its own. O(pixels drawn).
    pub fn draw_trajectories(&mut self, graph: &PoseGraph, grid: &Grid) {
        let sessions = graph.sessions();
        let number: BTreeMap<&str, usize> =
            sessions.iter().enumerate().map(|(number, name)| (*name, number)).collect();
        let position = |node: u64| -> Option<(usize, Vector2<f64>)> {
            let node = &graph.nodes[graph.node_index(node)?];
            let pose = SE2::from_components(node.pose.as_deref()?)?;
            let session = node.session.as_deref().and_then(|name| number.get(name)).copied();
            Some((session.unwrap_or(0), grid.in_cells(&pose.translation)))
        };
        for edge in graph.edges_of(EdgeKind::Odometry) {
            let Some(((session, from), (_, to))) = position(edge.from).zip(position(edge.to)) else {
                continue;
            };
            let colour = (GREYS + session % COLOURS.len()) as u8;
            cells_between(from, to, |cell| self.set(cell, colour));
        }
    }

    /// Sets the pixel of a cell.
    fn set(&mut self, [column, row]: [i64; 2], colour: u8) {
        let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row)) else { return };
        if column < self.width && row < self.height {
            self.pixels[(self.height - 1 - row) * self.width + column] = colour;
        }
    }

    /// Writes the picture as PNG. The same picture gives the same bytes.
    pub fn write(&self, writer: impl Write) -> Result<(), png::EncodingError> {
        let mut encoder = png::Encoder::new(writer, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        let grey = |level: usize| [(level * 255 / (GREYS - 1)) as u8; 3];
        let palette: Vec<u8> = (0..GREYS).map(grey).chain(COLOURS).flatten().collect();
        encoder.set_palette(palette);
        let mut body = encoder.write_header()?;
        body.write_image_data(&self.pixels)?;
        body.finish()
    }
}
