//! Figures: what is drawn, apart from how. [`plotting`] alone knows the plotting library.

pub mod graphs;
pub mod plotting;
pub mod trajectories;

/// A line through points, metres.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    /// East and north.
    pub points: Vec<(f64, f64)>,
    /// A CSS colour.
    pub colour: &'static str,
    /// Pixels.
    pub width: f64,
    /// Whether it is dashed.
    pub dashed: bool,
    /// Its entry in the legend, if it has one.
    pub legend: Option<String>,
}

/// One set of axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Above the axes.
    pub title: String,
    /// In drawing order.
    pub lines: Vec<Polyline>,
}

/// Colours that differ for colour-blind readers too (Okabe and Ito).
pub mod colours {
    /// The first experience.
    pub const FIRST: &str = "#0072B2";
    /// The second experience.
    pub const SECOND: &str = "#E69F00";
    /// Further experiences.
    pub const OTHERS: [&str; 3] = ["#009E73", "#CC79A7", "#56B4E9"];
    /// What an estimate is compared with.
    pub const REFERENCE: &str = "#b8b8b8";
    /// Correct edges in use.
    pub const CORRECT: &str = "#009E73";
    /// Incorrect edges.
    pub const INCORRECT: &str = "#D7191C";

    /// The colour of an experience.
    pub fn experience(index: usize) -> &'static str {
        match index {
            0 => FIRST,
            1 => SECOND,
            _ => OTHERS[(index - 2) % OTHERS.len()],
        }
    }
}

/// How a graph's coordinates lie on paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Frame {
    /// x north, y east, z down, as NCLT has it: y is drawn to the right, x upwards
    Ned,
    /// x to the right, y upwards
    Xy,
}

impl Frame {
    /// A place on paper.
    pub fn place(self, x: f64, y: f64) -> (f64, f64) {
        match self {
            Self::Ned => (y, x),
            Self::Xy => (x, y),
        }
    }

    /// What lies to the right and what upwards.
    pub fn directions(self) -> (&'static str, &'static str) {
        match self {
            Self::Ned => ("east", "north"),
            Self::Xy => ("x", "y"),
        }
    }

    pub(crate) fn labels(self) -> (&'static str, &'static str) {
        match self {
            Self::Ned => ("east (m)", "north (m)"),
            Self::Xy => ("x (m)", "y (m)"),
        }
    }
}
