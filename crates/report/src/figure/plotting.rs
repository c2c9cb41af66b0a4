//! The one module that knows the plotting library.

use anyhow::{Context as _, bail};
use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::plot::legend::LegendPosition;
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::{PngBackend, render::render::Scene};

use super::{Frame, Panel};

/// Width of a panel, pixels.
const WIDTH: f64 = 640.0;
/// What of a panel the axes do not fill: labels beside, title and legend above and below, pixels.
const MARGINS: (f64, f64) = (110.0, 150.0);
/// Pixels of a PNG for each of the figure's.
const PNG_SCALE: f32 = 2.0;

/// Draws panels side by side (rows of at most `columns`) with equal axes; the format follows the extension.
pub fn draw(panels: &[Panel], columns: usize, frame: Frame, extension: &str) -> anyhow::Result<Vec<u8>> {
    if panels.is_empty() {
        bail!("there is nothing to draw; name at least one graph");
    }
    match extension {
        "svg" => {
            Ok(renumbered(&SvgBackend::default().render_scene(&scene(panels, columns, frame))).into_bytes())
        }
        "png" => PngBackend::new()
            .with_scale(PNG_SCALE)
            .render_scene(&scene(panels, columns, frame))
            .map_err(anyhow::Error::msg)
            .context("the PNG cannot be drawn"),
        other => bail!("the figure's name ends in \".{other}\", and figures are written as .svg or .png"),
    }
}

/// The library numbers clip paths through the life of the process; ours count from 0 in every figure, so that
/// a figure's bytes depend on what it shows alone.
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

fn scene(panels: &[Panel], columns: usize, frame: Frame) -> Scene {
    let columns = columns.clamp(1, panels.len());
    let rows = panels.len().div_ceil(columns);
    let (plots, layouts): (Vec<Vec<Plot>>, Vec<Layout>) =
        panels.iter().map(|panel| axes(panel, frame)).unzip();
    Figure::new(rows, columns)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(WIDTH, height(panels))
        .render()
}

/// The height at which the most upright panel fills its axes, within reason.
fn height(panels: &[Panel]) -> f64 {
    let shape = |panel: &Panel| {
        let points = || panel.lines.iter().flat_map(|line| &line.points);
        let extent = |pick: fn(&(f64, f64)) -> f64| {
            let (low, high) =
                points().map(pick).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
            (high - low).max(1.0)
        };
        extent(|point| point.1) / extent(|point| point.0)
    };
    let shape = panels.iter().map(shape).fold(0.0, f64::max).clamp(0.5, 1.5);
    (WIDTH - MARGINS.0) * shape + MARGINS.1
}

fn axes(panel: &Panel, frame: Frame) -> (Vec<Plot>, Layout) {
    let plots: Vec<Plot> = panel
        .lines
        .iter()
        .filter(|line| !line.points.is_empty())
        .map(|line| {
            let mut plot = LinePlot::new()
                .with_data(line.points.iter().copied())
                .with_color(line.colour)
                .with_stroke_width(line.width);
            if line.dashed {
                plot = plot.with_dashed();
            }
            if let Some(legend) = &line.legend {
                plot = plot.with_legend(legend.as_str());
            }
            plot.into()
        })
        .collect();
    let (right, up) = frame.labels();
    let layout = Layout::auto_from_plots(&plots)
        .with_title(panel.title.as_str())
        .with_x_label(right)
        .with_y_label(up)
        .with_tick_format(TickFormat::Integer)
        .with_legend_position(LegendPosition::InsideBottomRight)
        .with_equal_aspect();
    (plots, layout)
}
