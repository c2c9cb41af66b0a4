//! How coordinates lie on the screen.

use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{Dimension, Header};
use serde::Serialize;
use serde_json::Value;

/// How the coordinates of a graph are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Frame {
    /// As `ned` if posecut-ingest made the graph from an NCLT session, otherwise as `xy`
    #[default]
    Auto,
    /// Draw x to the right and y upwards
    Xy,
    /// x north, y east, z down, as in NCLT: draw y to the right and x upwards
    Ned,
}

impl Frame {
    /// The frame of a graph: never [`Frame::Auto`].
    #[must_use]
    pub fn of(self, header: &Header) -> Self {
        let ingested = header
            .provenance
            .iter()
            .any(|entry| entry.get("stage").and_then(Value::as_str) == Some("ingest"));
        match (self, ingested) {
            (Self::Auto, true) => Self::Ned,
            (Self::Auto, false) => Self::Xy,
            (given, _) => given,
        }
    }

    /// The planes in which a graph is drawn, seen from above first.
    pub(crate) fn planes(self, dimension: Dimension) -> Vec<Plane> {
        let [x, y, z] = match self {
            Self::Ned => [(0, 1, "x, north"), (1, 1, "y, east"), (2, -1, "up, −z")],
            Self::Auto | Self::Xy => [(0, 1, "x"), (1, 1, "y"), (2, 1, "z")],
        };
        let plane = |name, right, up| Plane { name, right: Axis::of(right), up: Axis::of(up) };
        let mut planes = vec![match self {
            Self::Ned => plane("from above: x-y", y, x),
            Self::Auto | Self::Xy => plane("from above: x-y", x, y),
        }];
        if dimension == Dimension::Three {
            planes.push(plane("from the side: x-z", x, z));
            planes.push(plane("from the side: y-z", y, z));
        }
        planes
    }
}

/// A plane of projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct Plane {
    name: &'static str,
    right: Axis,
    up: Axis,
}

/// A direction on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
struct Axis {
    /// 0, 1, 2: x, y, z.
    #[serde(rename = "axis")]
    coordinate: usize,
    /// 1, or -1 if the coordinate grows to the left or downwards.
    sign: i8,
    name: &'static str,
}

impl Axis {
    fn of((coordinate, sign, name): (usize, i8, &'static str)) -> Self {
        Self { coordinate, sign, name }
    }
}

/// The plane to begin with: from above, unless the y axis is the vertical one, as in the frame of a camera. Then a view from
/// above would show a line.
pub(crate) fn first_plane(planes: &[Plane], poses: &[Option<SE3>]) -> usize {
    let extent = |axis: usize| {
        let places = poses.iter().flatten().map(|pose| pose.translation()[axis]);
        let (low, high) = places
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        (high - low).max(0.0)
    };
    let (x, y, z) = (extent(0), extent(1), extent(2));
    match planes.len() {
        3 if z > 4.0 * y && x >= y => 1,
        3 if z > 4.0 * x && y > x => 2,
        _ => 0,
    }
}
