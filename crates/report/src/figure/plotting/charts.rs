//! Panels with two axes: maps and curves.

use std::sync::Arc;

use anyhow::bail;
use kuva::plot::legend::{LegendEntry, LegendPosition, LegendShape};
use kuva::plot::line::LineStyle;
use kuva::plot::scatter::{MarkerShape, ScatterPlot};
use kuva::plot::{BandPlot, LinePlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use super::Drawing;
use crate::figure::{Dash, Marks, Panel, Polyline, Shape};

/// Width of a panel, pixels.
const WIDTH: f64 = 640.0;
/// Height of a panel whose axes need not have equal scales, pixels.
const HEIGHT: f64 = 440.0;
/// Width and height of a panel outside its axes, for labels, title and legend, pixels.
const MARGINS: (f64, f64) = (110.0, 150.0);

/// Draws panels side by side, at most `columns` in a row.
pub fn charts(panels: &[Panel], columns: usize) -> anyhow::Result<Drawing> {
    if panels.is_empty() {
        bail!("there is nothing to draw; name at least one graph");
    }
    let columns = columns.clamp(1, panels.len());
    let rows = panels.len().div_ceil(columns);
    let (plots, layouts): (Vec<Vec<Plot>>, Vec<Layout>) = panels.iter().map(axes).unzip();
    let scene = Figure::new(rows, columns)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(WIDTH, height(panels))
        .render();
    Ok(Drawing(scene))
}

/// The height at which the tallest map fills its axes, within limits.
fn height(panels: &[Panel]) -> f64 {
    let shape = |panel: &Panel| {
        let points = || {
            let lines = panel.lines.iter().flat_map(|line| &line.points);
            lines.chain(panel.marks.iter().flat_map(|marks| &marks.points))
        };
        let extent = |pick: fn(&(f64, f64)) -> f64| {
            let (low, high) =
                points().map(pick).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
            (high - low).max(1.0)
        };
        extent(|point| point.1) / extent(|point| point.0)
    };
    let maps: Vec<&Panel> = panels.iter().filter(|panel| panel.axes.equal).collect();
    if maps.is_empty() {
        return HEIGHT;
    }
    let shape = maps.into_iter().map(shape).fold(0.0, f64::max).clamp(0.5, 1.5);
    (WIDTH - MARGINS.0) * shape + MARGINS.1
}

fn axes(panel: &Panel) -> (Vec<Plot>, Layout) {
    let (mut plots, mut legend) = (Vec::<Plot>::new(), Vec::new());
    for line in panel.lines.iter().filter(|line| !line.points.is_empty()) {
        add_line(line, &mut plots, &mut legend);
    }
    for marks in panel.marks.iter().filter(|marks| !marks.points.is_empty()) {
        add_marks(marks, &mut plots, &mut legend);
    }
    let own = &panel.axes;
    let mut layout = Layout::auto_from_plots(&plots)
        .with_title(panel.title.as_str())
        .with_x_label(own.right.as_str())
        .with_y_label(own.up.as_str())
        .with_tick_format(TickFormat::Custom(Arc::new(crate::regimes::table::short)))
        .with_legend_box(false);
    if !legend.is_empty() {
        layout =
            layout.with_legend_entries(legend).with_legend_position(LegendPosition::OutsideBottomColumns);
    }
    if own.equal {
        layout = layout.with_equal_aspect();
    } else {
        let along = || panel.lines.iter().flat_map(|line| &line.points).map(|point| point.0);
        layout = layout
            .with_x_axis_min(along().fold(f64::INFINITY, f64::min))
            .with_x_axis_max(along().fold(f64::NEG_INFINITY, f64::max));
    }
    if own.logarithmic_right {
        layout = layout.with_log_x();
    }
    if own.logarithmic_up {
        layout = layout.with_log_y();
    }
    (plots, layout)
}

fn add_line(line: &Polyline, plots: &mut Vec<Plot>, legend: &mut Vec<LegendEntry>) {
    if !line.band.is_empty() {
        let (low, high): (Vec<f64>, Vec<f64>) = line.band.iter().copied().unzip();
        let along: Vec<f64> = line.points.iter().map(|point| point.0).collect();
        plots.push(BandPlot::new(along, low, high).with_color(line.colour).with_opacity(0.16).into());
    }
    let style = match line.dash {
        Dash::Solid => LineStyle::Solid,
        Dash::Dashed => LineStyle::Dashed,
        Dash::Dotted => LineStyle::Dotted,
        Dash::DashDot => LineStyle::DashDot,
    };
    let plot = LinePlot::new()
        .with_data(line.points.iter().copied())
        .with_color(line.colour)
        .with_stroke_width(line.width)
        .with_line_style(style.clone());
    if let Some(label) = &line.legend {
        legend.push(LegendEntry {
            label: label.clone(),
            color: line.colour.to_owned(),
            shape: LegendShape::Line,
            dasharray: style.dasharray(),
        });
    }
    plots.push(plot.into());
}

fn add_marks(marks: &Marks, plots: &mut Vec<Plot>, legend: &mut Vec<LegendEntry>) {
    let mut plot = ScatterPlot::new()
        .with_data(marks.points.iter().copied())
        .with_color(marks.colour)
        .with_size(marks.size);
    plot = match marks.shape {
        Shape::Disc => plot,
        Shape::Ring => plot.with_marker_opacity(0.0).with_marker_stroke_width(1.3),
        Shape::Cross => plot.with_marker(MarkerShape::Cross),
    };
    if let Some(label) = &marks.legend {
        legend.push(LegendEntry {
            label: label.clone(),
            color: marks.colour.to_owned(),
            shape: match marks.shape {
                Shape::Disc => LegendShape::Circle,
                Shape::Ring => LegendShape::CircleSize(3.5),
                Shape::Cross => LegendShape::Marker(MarkerShape::Cross),
            },
            dasharray: None,
        });
    }
    plots.push(plot.into());
}
