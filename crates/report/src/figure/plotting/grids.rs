//! Panels of cells: heat maps with numbers in their cells, and matrices.

use anyhow::bail;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::Drawing;
use super::pen::Pen;
use crate::figure::colours::INK;

/// A cell of a heat map.
#[derive(Clone, Debug, PartialEq)]
pub struct GridCell {
    /// A CSS colour.
    pub colour: String,
    /// Whether the colour is so dark that text on it must be light.
    pub dark: bool,
    /// The text in the cell.
    pub text: String,
    /// Whether the cell has a dot.
    pub dot: bool,
}

/// A heat map.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// The text above the map.
    pub title: String,
    /// The text below the map; may be empty.
    pub note: String,
    /// Labels of columns, from left to right.
    pub columns: Vec<String>,
    /// Labels of rows, from below upwards.
    pub rows: Vec<String>,
    /// The quantity of the columns.
    pub right: String,
    /// The quantity of the rows.
    pub up: String,
    /// Cells row by row, from the bottom.
    pub cells: Vec<Option<GridCell>>,
}

/// The meaning of the colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Ramp {
    /// The quantity, with its unit.
    pub title: String,
    /// Colours at equal steps.
    pub colours: Vec<String>,
    /// Positions on the ramp, from 0 to 1, with their labels.
    pub ticks: Vec<(f64, String)>,
}

/// A colour and its meaning.
pub type LegendEntry = (&'static str, &'static str);

const CELL: (f64, f64) = (64.0, 30.0);
const LEFT: f64 = 78.0;
const ABOVE: f64 = 34.0;
const BELOW: f64 = 64.0;
const GAP: f64 = 26.0;
const RAMP: f64 = 62.0;
const SOFT: &str = "#56616f";

/// Draws heat maps side by side, at most `columns` in a row, with their ramp above.
pub fn grids(title: &str, grids: &[Grid], ramp: &Ramp, columns: usize) -> anyhow::Result<Drawing> {
    let Some(first) = grids.first() else { bail!("there is nothing to draw for {title}") };
    let columns = columns.clamp(1, grids.len());
    let width = LEFT + CELL.0 * first.columns.len() as f64 + GAP;
    let height = ABOVE + CELL.1 * first.rows.len() as f64 + BELOW;
    let rows = grids.len().div_ceil(columns);
    let all = (width * columns as f64 + GAP).max(460.0);
    let mut pen = Pen(Scene::new(all, 40.0 + RAMP + height * rows as f64));
    pen.text(GAP, 28.0, title, 16, TextAnchor::Start, true, INK);
    pen.ramp(ramp, GAP, 46.0);
    for (index, grid) in grids.iter().enumerate() {
        let left = GAP / 2.0 + width * (index % columns) as f64;
        let top = 40.0 + RAMP + height * (index / columns) as f64;
        pen.grid(grid, left, top);
    }
    Ok(Drawing(pen.0))
}

/// A square matrix with coloured cells, and strips along its edges.
pub struct Matrix<'a> {
    /// The text above the matrix.
    pub title: &'a str,
    /// Number of rows, and of columns.
    pub count: usize,
    /// The colour of a cell, by row and column.
    pub colour: &'a dyn Fn(usize, usize) -> &'static str,
    /// Colours of rows (and columns) in strips beside the matrix, outermost first.
    pub strips: &'a [&'a dyn Fn(usize) -> Option<&'static str>],
}

/// Draws matrices side by side with one legend.
pub fn matrices(all: &[Matrix], legend: &[LegendEntry]) -> anyhow::Result<Drawing> {
    const STRIP: f64 = 9.0;
    // A cell has at least half a pixel: above 920 candidates the figure grows.
    let side = all.iter().map(|matrix| matrix.count as f64 / 2.0).fold(460.0, f64::max);
    if all.is_empty() {
        bail!("there is nothing to draw; name at least one graph that went through PCM");
    }
    let edge = all.iter().map(|matrix| matrix.strips.len()).max().unwrap_or(0) as f64 * (STRIP + 2.0) + 4.0;
    let width = side + edge + GAP;
    let height = ABOVE + side + edge + GAP;
    let mut pen = Pen(Scene::new(width * all.len() as f64 + GAP, height + 20.0 * legend.len() as f64 + 12.0));
    for (index, matrix) in all.iter().enumerate() {
        let (left, top) = (GAP + width * index as f64, ABOVE);
        pen.text(left, top - 12.0, matrix.title, 14, TextAnchor::Start, true, INK);
        let (left, top) = (left + edge, top + edge);
        // A cell is a multiple of half a pixel wide, so that there is no seam between neighbours.
        let cell = (2.0 * side / matrix.count.max(1) as f64).floor().max(1.0) / 2.0;
        for row in 0..matrix.count {
            for (start, end, colour) in runs(matrix.count, |column| Some((matrix.colour)(row, column))) {
                let (from, to) = (start as f64 * cell, end as f64 * cell);
                pen.rectangle(left + from, top + row as f64 * cell, to - from, cell, colour);
            }
        }
        for (number, strip) in matrix.strips.iter().enumerate() {
            let away = edge - number as f64 * (STRIP + 2.0);
            for (start, end, colour) in runs(matrix.count, strip) {
                let (from, to) = (start as f64 * cell, end as f64 * cell);
                pen.rectangle(left + from, top - away, to - from, STRIP, colour);
                pen.rectangle(left - away, top + from, STRIP, to - from, colour);
            }
        }
    }
    for (index, (colour, text)) in legend.iter().enumerate() {
        let top = height + 20.0 * index as f64;
        pen.rectangle(GAP, top - 10.0, 16.0, 13.0, colour);
        pen.text(GAP + 24.0, top, text, 12, TextAnchor::Start, false, INK);
    }
    Ok(Drawing(pen.0))
}

/// Runs of cells of the same colour, so that a row of thousands of cells needs only a few rectangles.
fn runs(count: usize, colour: impl Fn(usize) -> Option<&'static str>) -> Vec<(usize, usize, &'static str)> {
    let mut runs: Vec<(usize, usize, &'static str)> = Vec::new();
    for place in 0..count {
        let Some(here) = colour(place) else { continue };
        match runs.last_mut() {
            Some((_, end, last)) if *end == place && *last == here => *end = place + 1,
            _ => runs.push((place, place + 1, here)),
        }
    }
    runs
}

impl Pen {
    fn ramp(&mut self, ramp: &Ramp, left: f64, top: f64) {
        let width = 300.0;
        let step = width / ramp.colours.len().max(1) as f64;
        for (index, colour) in ramp.colours.iter().enumerate() {
            self.rectangle(left + index as f64 * step, top, step + 0.3, 13.0, colour);
        }
        for (share, label) in &ramp.ticks {
            self.text(left + share * width, top + 27.0, label, 11, TextAnchor::Middle, false, SOFT);
        }
        self.text(left + width + 14.0, top + 11.0, &ramp.title, 12, TextAnchor::Start, false, INK);
    }

    fn grid(&mut self, grid: &Grid, left: f64, top: f64) {
        let (rows, columns) = (grid.rows.len(), grid.columns.len());
        let (x, y) = (left + LEFT, top + ABOVE);
        let bottom = y + CELL.1 * rows as f64;
        self.text(x, y - 10.0, &grid.title, 14, TextAnchor::Start, true, INK);
        for (index, cell) in grid.cells.iter().enumerate() {
            let (row, column) = (index / columns, index % columns);
            let cell_left = x + CELL.0 * column as f64;
            let cell_top = bottom - CELL.1 * (row + 1) as f64;
            let (text, ink) = match cell {
                None => ("–", SOFT),
                Some(cell) => {
                    self.rectangle(cell_left + 1.0, cell_top + 1.0, CELL.0 - 2.0, CELL.1 - 2.0, &cell.colour);
                    (cell.text.as_str(), if cell.dark { "#ffffff" } else { "#14181d" })
                }
            };
            self.text(
                cell_left + CELL.0 / 2.0,
                cell_top + CELL.1 / 2.0 + 4.0,
                text,
                12,
                TextAnchor::Middle,
                false,
                ink,
            );
            if cell.as_ref().is_some_and(|cell| cell.dot) {
                self.0.add(Primitive::Circle {
                    cx: cell_left + CELL.0 - 7.0,
                    cy: cell_top + 7.0,
                    r: 2.5,
                    fill: ink.into(),
                    fill_opacity: None,
                    stroke: None,
                    stroke_width: None,
                });
            }
        }
        for (row, label) in grid.rows.iter().enumerate() {
            let place = bottom - CELL.1 * (row as f64 + 0.5) + 4.0;
            self.text(x - 7.0, place, label, 11, TextAnchor::End, false, SOFT);
        }
        for (column, label) in grid.columns.iter().enumerate() {
            let place = x + CELL.0 * (column as f64 + 0.5);
            self.text(place, bottom + 15.0, label, 11, TextAnchor::Middle, false, SOFT);
        }
        let middle = x + CELL.0 * columns as f64 / 2.0;
        self.text(middle, bottom + 32.0, &grid.right, 12, TextAnchor::Middle, false, INK);
        self.text(x, bottom + 50.0, &grid.note, 11, TextAnchor::Start, false, SOFT);
        self.0.add(Primitive::Text {
            x: left + 18.0,
            y: bottom - CELL.1 * rows as f64 / 2.0,
            content: grid.up.clone(),
            size: 12,
            anchor: TextAnchor::Middle,
            rotate: Some(-90.0),
            bold: false,
            color: Some(INK.into()),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::runs;

    #[test]
    fn neighbours_of_one_colour_are_one_run() {
        let colours = [Some("a"), Some("a"), None, Some("a"), Some("b")];
        assert_eq!(runs(5, |place| colours[place]), [(0, 2, "a"), (3, 4, "a"), (4, 5, "b")]);
    }
}
