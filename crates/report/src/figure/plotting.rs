//! Draws scenes with the plotting library and writes them as SVG, PDF or PNG. No other module uses the library.

mod charts;
mod grids;
mod lanes;
mod pen;

pub use charts::charts;
pub use grids::{Grid, GridCell, LegendEntry, Matrix, Ramp, grids, matrices};
pub use lanes::{Dot, Lane, LanePanel, Lanes, lanes};

use anyhow::{Context as _, bail};
use kuva::PngBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::render::Scene;

/// Pixels of a PNG for each pixel of the figure.
const PNG_SCALE: f32 = 2.0;

/// A figure that is laid out but not yet written.
pub struct Drawing(Scene);

impl Drawing {
    /// The figure's bytes. The format follows the extension: `svg`, `pdf` (text stays text, in an embedded font) or
    /// `png`.
    pub fn write(&self, extension: &str) -> anyhow::Result<Vec<u8>> {
        match extension {
            "svg" => Ok(renumbered(&SvgBackend::default().render_scene(&self.0)).into_bytes()),
            "pdf" => pdf(&self.0),
            "png" => PngBackend::new()
                .with_scale(PNG_SCALE)
                .render_scene(&self.0)
                .map_err(anyhow::Error::msg)
                .context("the PNG cannot be drawn"),
            other => {
                bail!("the figure's name ends in \".{other}\"; name a .svg, .pdf or .png file")
            }
        }
    }
}

#[cfg(feature = "pdf")]
fn pdf(scene: &Scene) -> anyhow::Result<Vec<u8>> {
    kuva::backend::pdf::PdfBackend::new()
        .render_scene(scene)
        .map_err(anyhow::Error::msg)
        .context("the PDF cannot be drawn")
}

#[cfg(not(feature = "pdf"))]
fn pdf(_scene: &Scene) -> anyhow::Result<Vec<u8>> {
    bail!("this program was built without PDF; build it with --features pdf, or name a .svg or .png file")
}

/// Numbers clip paths from 0 in every figure. The library counts them through the life of the process, but a figure's
/// bytes must depend only on its content.
fn renumbered(svg: &str) -> String {
    const MARK: &str = "kuva-clip-";
    let mut parts = svg.split(MARK);
    let mut text = parts.next().unwrap_or_default().to_owned();
    let mut known: Vec<&str> = Vec::new();
    for part in parts {
        let digits = part.find(|character: char| !character.is_ascii_digit()).unwrap_or(part.len());
        let (number, rest) = part.split_at(digits);
        let place = known.iter().position(|&other| other == number).unwrap_or_else(|| {
            known.push(number);
            known.len() - 1
        });
        text.push_str(MARK);
        text.push_str(&place.to_string());
        text.push_str(rest);
    }
    text
}
