//! The reliability diagram: share of correct edges over their probability, one panel a family.

use super::{Axes, Dash, Marks, Panel, Polyline, Shape, colours};
use crate::trust::reliability::{Curve, Group, Reliability};

/// One panel a family, with all families together first.
pub fn figure(found: &Reliability) -> Vec<Panel> {
    found.groups.iter().map(|group| panel(group, &found.half)).collect()
}

fn panel(group: &Group, half: &str) -> Panel {
    let diagonal = Polyline {
        points: vec![(0.0, 0.0), (1.0, 1.0)],
        colour: colours::UNKNOWN,
        width: 1.2,
        dash: Dash::Dotted,
        band: Vec::new(),
        legend: Some("perfect calibration".to_owned()),
    };
    let curves = || group.curves.iter().enumerate();
    Panel {
        title: format!("{}, {half} half", group.name),
        axes: Axes {
            right: "mean probability of a bin".to_owned(),
            up: "share of correct edges".to_owned(),
            equal: true,
            logarithmic_right: false,
            logarithmic_up: false,
        },
        lines: std::iter::once(diagonal).chain(curves().map(|(index, curve)| line(curve, index))).collect(),
        marks: curves().flat_map(|(index, curve)| marks(curve, index)).collect(),
    }
}

fn line(curve: &Curve, index: usize) -> Polyline {
    Polyline {
        points: curve.points.iter().map(|point| (point.probability, point.correct)).collect(),
        colour: colours::HUES[index % colours::HUES.len()],
        width: 1.6,
        dash: Dash::Solid,
        band: curve
            .points
            .iter()
            .map(|point| point.interval.unwrap_or((point.correct, point.correct)))
            .collect(),
        legend: Some(format!("{}: error {:.4}, {} edges", curve.method, curve.error, curve.edges)),
    }
}

/// A disc a bin; its radius grows with the logarithm of the number of edges.
fn marks(curve: &Curve, index: usize) -> Vec<Marks> {
    let disc = |point: &crate::trust::reliability::Point| Marks {
        points: vec![(point.probability, point.correct)],
        colour: colours::HUES[index % colours::HUES.len()],
        shape: Shape::Disc,
        size: radius(point.edges),
        legend: None,
    };
    curve.points.iter().map(disc).collect()
}

/// Radius in pixels, the same as on the page.
fn radius(edges: u64) -> f64 {
    1.5 + 1.5 * (edges as f64).log10()
}
