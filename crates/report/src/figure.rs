//! Figures: what to draw. [`plotting`] draws it, and is the only module that uses the plotting library.

pub mod components;
pub mod consistency;
pub mod error;
pub mod graphs;
pub mod plotting;
pub mod ramp;
pub mod regimes;
pub mod regret;
pub mod reliability;
pub mod trajectories;

/// The dashes of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dash {
    /// A solid line.
    #[default]
    Solid,
    /// Long dashes.
    Dashed,
    /// Short dashes.
    Dotted,
    /// Long and short dashes by turns.
    DashDot,
}

/// A line through points, in units of the axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyline {
    /// Pairs of coordinates: to the right, upwards.
    pub points: Vec<(f64, f64)>,
    /// A CSS colour.
    pub colour: &'static str,
    /// Width in pixels.
    pub width: f64,
    /// Its dashes.
    pub dash: Dash,
    /// A band around the line: lower and upper end for each point; empty for a line without a band.
    pub band: Vec<(f64, f64)>,
    /// Its entry in the legend, if it has one.
    pub legend: Option<String>,
}

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Filled.
    Disc,
    /// Hollow.
    Ring,
    /// Two strokes.
    Cross,
}

/// Marks of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// Pairs of coordinates: to the right, upwards.
    pub points: Vec<(f64, f64)>,
    /// A CSS colour.
    pub colour: &'static str,
    /// Their shape.
    pub shape: Shape,
    /// Radius, pixels.
    pub size: f64,
    /// Their entry in the legend, if they have one.
    pub legend: Option<String>,
}

/// Labels and scales of the axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Axes {
    /// The label below.
    pub right: String,
    /// The label at the left.
    pub up: String,
    /// Whether both axes have the same scale, as in maps.
    pub equal: bool,
    /// Whether the horizontal axis is logarithmic.
    pub logarithmic_right: bool,
    /// Whether the vertical axis is logarithmic.
    pub logarithmic_up: bool,
}

/// One set of axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The text above the axes.
    pub title: String,
    /// Labels and scales.
    pub axes: Axes,
    /// Lines in drawing order.
    pub lines: Vec<Polyline>,
    /// Marks, drawn above the lines.
    pub marks: Vec<Marks>,
}

/// Colours that colour-blind readers can tell apart too, together with the widths, dashes and shapes used with them.
/// The page uses the same colours.
pub mod colours {
    use super::Dash;

    /// The first experience.
    pub const FIRST: &str = "#0072b2";
    /// The second experience.
    pub const SECOND: &str = "#c77f00";
    /// Further experiences.
    pub const OTHERS: [&str; 2] = ["#7b5ea7", "#3a9ab2"];
    /// The reference of an estimate.
    pub const REFERENCE: &str = "#bcc3cd";
    /// Correct edges.
    pub const CORRECT: &str = "#00805c";
    /// Incorrect edges.
    pub const INCORRECT: &str = "#c8102e";
    /// Edges whose truth is unknown, and less important things.
    pub const UNKNOWN: &str = "#6b7280";
    /// Consistent pairs of kept candidates.
    pub const CLIQUE: &str = "#1f5f99";
    /// Other consistent pairs.
    pub const AGREE: &str = "#b9cbe0";
    /// Empty cells.
    pub const GROUND: &str = "#f5f6f8";
    /// Text.
    pub const INK: &str = "#18202b";
    /// For landmarks, and methods without a colour of their own.
    pub const HUES: [&str; 8] =
        ["#0072b2", "#c77f00", "#00805c", "#b0508a", "#2c8fbf", "#c8501e", "#6a5acd", "#7a7a00"];

    /// The colour of an experience.
    pub fn experience(index: usize) -> &'static str {
        match index {
            0 => FIRST,
            1 => SECOND,
            _ => OTHERS[(index - 2) % OTHERS.len()],
        }
    }

    /// Colour and dashes of a method; `index` is its number among the methods without a colour of their own.
    pub fn method(name: &str, index: usize) -> (&'static str, Dash) {
        match name {
            "none" => ("#7a828d", Dash::Dotted),
            "pcm" => ("#c8501e", Dash::Dashed),
            "gc" => ("#0072b2", Dash::DashDot),
            "pcm+gc" => ("#00805c", Dash::Solid),
            "oracle" => (INK, Dash::Solid),
            _ => (
                HUES[[3, 6, 7, 4, 1, 0, 2, 5][index % 8]],
                [Dash::Dashed, Dash::Dotted, Dash::DashDot, Dash::Solid][index % 4],
            ),
        }
    }
}

/// How a graph's coordinates lie on paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Frame {
    /// x north, y east, z down, as in NCLT: draw y to the right and x upwards
    Ned,
    /// Draw x to the right and y upwards
    Xy,
}

impl Frame {
    /// The position on paper.
    pub fn place(self, x: f64, y: f64) -> (f64, f64) {
        match self {
            Self::Ned => (y, x),
            Self::Xy => (x, y),
        }
    }

    /// The directions that point to the right and upwards.
    pub fn directions(self) -> (&'static str, &'static str) {
        match self {
            Self::Ned => ("east", "north"),
            Self::Xy => ("x", "y"),
        }
    }

    pub(crate) fn axes(self) -> Axes {
        let (right, up) = self.directions();
        Axes {
            right: format!("{right} (m)"),
            up: format!("{up} (m)"),
            equal: true,
            logarithmic_right: false,
            logarithmic_up: false,
        }
    }
}
