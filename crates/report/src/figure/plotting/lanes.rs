//! Panels of lanes: one lane a method, one dot a run, with one axis for all panels.

use anyhow::bail;
use kuva::render::render::{Scene, TextAnchor};

use super::Drawing;
use super::pen::Pen;
use crate::figure::colours::{INCORRECT, INK, experience};

/// One run in a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// The position along the axis, 0 to 1.
    pub along: f64,
    /// The position across the lane, -1 to 1.
    pub across: f64,
    /// Whether it is drawn as a ring in a colour of its own.
    pub marked: bool,
}

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub struct Lane {
    /// Dots in drawing order: later ones are on top.
    pub dots: Vec<Dot>,
    /// The position of a bar, 0 to 1.
    pub bar: Option<f64>,
    /// The text at the right of the axis.
    pub text: String,
    /// Number of runs without a dot, drawn as a cross with this number.
    pub crossed: usize,
}

/// Lanes with a title.
#[derive(Clone, Debug, PartialEq)]
pub struct LanePanel {
    /// The text above the panel.
    pub title: String,
    /// From top to bottom, one for each label of the figure.
    pub lanes: Vec<Lane>,
}

/// The whole figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Lanes {
    /// The text above the figure.
    pub title: String,
    /// The quantity on the axis.
    pub axis: String,
    /// Labels of lanes, from top to bottom.
    pub labels: Vec<String>,
    /// Positions on the axis with their labels.
    pub ticks: Vec<(f64, String)>,
    /// The meanings of dot, ring, bar, text and cross.
    pub legend: [String; 5],
    /// Panels.
    pub panels: Vec<LanePanel>,
}

const LANE: f64 = 16.0;
const AXIS: f64 = 206.0;
/// Room for the text and the crosses, at the right of an axis.
const BESIDE: f64 = 88.0;
const GAP: f64 = 14.0;
const HEAD: f64 = 32.0;
const FOOT: f64 = 28.0;
const TOP: f64 = 100.0;
const RADIUS: f64 = 2.2;
const GRID: &str = "#dfe3e8";
const SOFT: &str = "#56616f";
const WHITE: &str = "#ffffff";
/// The width of a character of the labels, pixels.
const CHARACTER: f64 = 7.6;

/// Draws panels in rows of at most `columns`.
pub fn lanes(figure: &Lanes, columns: usize) -> anyhow::Result<Drawing> {
    if figure.panels.is_empty() || figure.labels.is_empty() {
        bail!("there is nothing to draw for {}", figure.title);
    }
    let columns = columns.clamp(1, figure.panels.len());
    let longest = figure.labels.iter().map(|label| label.chars().count()).max().unwrap_or(0);
    let left = GAP + CHARACTER * longest as f64 + 8.0;
    let (width, height) = (AXIS + BESIDE + GAP, HEAD + LANE * figure.labels.len() as f64 + FOOT);
    let rows = figure.panels.len().div_ceil(columns);
    // One panel alone is narrower than what is written below it.
    let below = CHARACTER * figure.axis.chars().count() as f64;
    let all = left + (width * columns as f64).max(below).max(640.0);
    let mut pen = Pen(Scene::new(all, TOP + height * rows as f64 + 22.0));
    pen.text(GAP, 24.0, &figure.title, 16, TextAnchor::Start, true, INK);
    pen.legend(&figure.legend);
    for (index, panel) in figure.panels.iter().enumerate() {
        let x = left + width * (index % columns) as f64;
        let y = TOP + height * (index / columns) as f64;
        if index % columns == 0 {
            for (lane, label) in figure.labels.iter().enumerate() {
                let middle = y + HEAD + LANE * (lane as f64 + 0.5);
                pen.text(x - 9.0, middle + 4.0, label, 12, TextAnchor::End, false, INK);
            }
        }
        pen.panel(panel, &figure.ticks, x, y);
    }
    pen.text(left, TOP + height * rows as f64 + 10.0, &figure.axis, 12, TextAnchor::Start, false, INK);
    Ok(Drawing(pen.0))
}

impl Pen {
    fn legend(&mut self, legend: &[String; 5]) {
        for (index, text) in legend.iter().enumerate() {
            // Two columns: first the marks of runs, then their summaries.
            let (column, row) = (index / 3, index % 3);
            let (x, y) = (GAP + 6.0 + 360.0 * column as f64, 44.0 + 18.0 * row as f64);
            match index {
                0 => self.disc((x, y), RADIUS + 0.8, experience(0)),
                1 => self.ring((x, y), RADIUS + 0.8, INCORRECT, WHITE),
                2 => self.rectangle(x - 1.2, y - 6.0, 2.4, 12.0, INK),
                3 => self.text(x, y + 4.0, "%", 11, TextAnchor::Middle, false, SOFT),
                _ => self.cross((x, y), 3.2, INCORRECT),
            }
            self.text(x + 14.0, y + 4.0, text, 12, TextAnchor::Start, false, INK);
        }
    }

    fn panel(&mut self, panel: &LanePanel, ticks: &[(f64, String)], x: f64, y: f64) {
        let (top, bottom) = (y + HEAD, y + HEAD + LANE * panel.lanes.len() as f64);
        let at = |share: f64| x + AXIS * share;
        self.text(x, y + 22.0, &panel.title, 13, TextAnchor::Start, true, INK);
        for (share, label) in ticks {
            self.line((at(*share), top), (at(*share), bottom), GRID, 1.0);
            self.text(at(*share), bottom + 14.0, label, 10, TextAnchor::Middle, false, SOFT);
        }
        for (index, lane) in panel.lanes.iter().enumerate() {
            let middle = top + LANE * (index as f64 + 0.5);
            self.line((x, middle), (x + AXIS, middle), GRID, 0.6);
            for dot in &lane.dots {
                let centre = (at(dot.along), middle + dot.across * (LANE / 2.0 - RADIUS - 0.6));
                if dot.marked {
                    self.ring(centre, RADIUS, INCORRECT, WHITE);
                } else {
                    self.disc(centre, RADIUS, experience(0));
                }
            }
            if let Some(bar) = lane.bar {
                self.rectangle(at(bar) - 1.2, middle - LANE / 2.0 + 1.0, 2.4, LANE - 2.0, INK);
            }
            self.text(x + AXIS + 44.0, middle + 4.0, &lane.text, 11, TextAnchor::End, false, SOFT);
            if lane.crossed > 0 {
                self.cross((x + AXIS + 55.0, middle), 3.0, INCORRECT);
                let count = lane.crossed.to_string();
                self.text(x + AXIS + 62.0, middle + 4.0, &count, 11, TextAnchor::Start, false, INCORRECT);
            }
        }
    }
}
