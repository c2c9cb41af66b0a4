//! Loop closures from a table: CSV with named columns becomes landmark edges of a graph.
//!
//! | columns | meaning |
//! |---|---|
//! | `from`, `to` | ends by node id |
//! | `frame_from`, `frame_to` | ends by frame number, with `session_from`, `session_to` where several sessions have the frame |
//! | `time_from`, `time_to` | ends by time, seconds: the nearest node within the tolerance, of the named session if there is one |
//! | `x`, `y`, `theta` | measurement in the plane, metres and radians |
//! | `x`, `y`, `z`, `qx`, `qy`, `qz`, `qw` | measurement in space, metres and a unit quaternion |
//! | `sigma_translation`, `sigma_rotation` | standard deviations of each axis, metres and radians |
//! | `cov_xx`, `cov_xy`, … | upper triangle of the covariance, or its diagonal |
//! | `info_xx`, `info_xy`, … | upper triangle of the information matrix, or its diagonal |
//! | `score` | confidence of the recogniser, on any scale |
//! | `label` | 1 if the closure is correct, 0 if not |
//!
//! The names of a matrix's terms are those of two axes: `x`, `y`, `theta` in the plane, `x`, `y`, `z`, `rx`, `ry`, `rz` in space.
//! A field of `score`, of `label` or of the whole measurement may be empty.

mod columns;
mod ends;
mod matrix;

use posecut_geometry::covariance::isotropic_information;
use posecut_graph::{Dimension, Edge, EdgeKind, EdgeTruth, PoseGraph};
use serde::Serialize;

use crate::ConvertError;
use crate::error::number;
use columns::{Columns, Weight};
use ends::Nodes;

/// The default of `--time-tolerance`, seconds.
const TIME_TOLERANCE: f64 = 0.1;

/// What a table of closures does not say.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::Args))]
pub struct ClosureOptions {
    /// Set the standard deviation of all translations of the table, metres per axis
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "METRES", requires = "closures", help_heading = "Closures from a table")
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closure_sigma_translation: Option<f64>,

    /// Set the standard deviation of all rotations of the table, radians per axis
    #[cfg_attr(
        feature = "cli",
        arg(long, value_name = "RADIANS", requires = "closures", help_heading = "Closures from a table")
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closure_sigma_rotation: Option<f64>,

    /// Match the times of the table to nodes up to this far away, seconds
    #[cfg_attr(feature = "cli", arg(long, value_name = "SECONDS", default_value_t = TIME_TOLERANCE, help_heading = "Closures from a table"))]
    #[serde(skip_serializing_if = "is_default_tolerance")]
    pub time_tolerance: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it with a reference to the field")]
fn is_default_tolerance(tolerance: &f64) -> bool {
    *tolerance == TIME_TOLERANCE
}

impl Default for ClosureOptions {
    fn default() -> Self {
        Self { closure_sigma_translation: None, closure_sigma_rotation: None, time_tolerance: TIME_TOLERANCE }
    }
}

/// What a table added to a graph.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Added {
    /// Landmark edges.
    pub closures: usize,
    /// Those without a measurement.
    pub unmeasured: usize,
    /// Those with a label.
    pub labelled: usize,
}

/// Adds the closures of a table to a graph as landmark edges. Errors name file, line and column. O(rows log nodes).
pub fn add(
    graph: &mut PoseGraph,
    file: &str,
    table: &[u8],
    options: &ClosureOptions,
) -> Result<Added, ConvertError> {
    options.check()?;
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .has_headers(false)
        .from_reader(table);
    let mut records = reader.records().map(|record| {
        let record = record.map_err(|error| unreadable(file, table, &error))?;
        let line = line_of(table, record.position());
        Ok::<_, ConvertError>((line, record))
    });
    let (line, header) = records.next().transpose()?.ok_or_else(|| {
        ConvertError::graph(
            format!("{file}: the table is empty"),
            "its first line names the columns, such as from,to,x,y,theta",
        )
    })?;
    let columns = Columns::of(file, line, &header, graph.header.dimension)?;
    options.check_with(&columns, file, line)?;
    let nodes = Nodes::of(graph, &columns.ends, options.time_tolerance);
    let mut ids = graph.edges.iter().map(|edge| edge.id).max().map_or(Some(0), |id| id.checked_add(1));
    let mut added = Added::default();
    let mut edges = Vec::new();
    for record in records {
        let (line, record) = record?;
        let row = Row { file, line, record: &record };
        let [from, to] = nodes.ends(&row, &columns.ends)?;
        if from == to {
            return Err(row.refuse(format!("the closure joins node {from} to itself"), "delete the line"));
        }
        let id = ids.ok_or_else(|| {
            row.refuse("no edge id above 2^64 - 1 is left", "renumber the edges of the graph")
        })?;
        ids = id.checked_add(1);
        let mut edge = Edge::new(EdgeKind::Landmark, id, from, to);
        edge.measurement = row.measurement(&columns, graph.header.dimension)?;
        if edge.measurement.is_some() {
            edge.information = Some(row.information(&columns, graph.header.dimension, options)?);
        }
        edge.score =
            columns.score.and_then(|column| row.filled(column)).map(|text| row.number(text)).transpose()?;
        edge.truth = row.label(&columns)?.map(EdgeTruth::of);
        added.unmeasured += usize::from(edge.measurement.is_none());
        added.labelled += usize::from(edge.truth.is_some());
        edges.push(edge);
    }
    added.closures = edges.len();
    graph.edges.extend(edges);
    Ok(added)
}

/// The line of a record. The position that the CSV reader gives is that of the comments and blank lines before it.
fn line_of(table: &[u8], position: Option<&csv::Position>) -> u64 {
    let Some(position) = position else { return 0 };
    let rest = table.get(position.byte() as usize..).unwrap_or_default();
    let skipped = rest
        .split(|&byte| byte == b'\n')
        .take_while(|line| line.starts_with(b"#") || line.trim_ascii().is_empty());
    position.line() + skipped.count() as u64
}

fn unreadable(file: &str, table: &[u8], error: &csv::Error) -> ConvertError {
    let line = line_of(table, error.position());
    let problem = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the line has {len} fields, but the header names {expected_len} columns")
        }
        csv::ErrorKind::Utf8 { .. } => "the line is not UTF-8".to_owned(),
        _ => error.to_string(),
    };
    ConvertError::line(
        file,
        line,
        problem,
        "save the table as comma-separated text in UTF-8, a field for each column",
    )
}

impl ClosureOptions {
    fn sigmas(&self) -> Option<(f64, f64)> {
        self.closure_sigma_translation.zip(self.closure_sigma_rotation)
    }

    fn check(&self) -> Result<(), ConvertError> {
        if self.closure_sigma_translation.is_some() != self.closure_sigma_rotation.is_some() {
            return Err(ConvertError::graph(
                "only one of --closure-sigma-translation and --closure-sigma-rotation is set",
                "set both, or neither",
            ));
        }
        for (option, sigma) in [
            ("--closure-sigma-translation", self.closure_sigma_translation),
            ("--closure-sigma-rotation", self.closure_sigma_rotation),
        ] {
            crate::error::check_sigma(option, sigma)?;
        }
        if !(self.time_tolerance >= 0.0 && self.time_tolerance.is_finite()) {
            return Err(ConvertError::graph(
                format!("--time-tolerance is {}", self.time_tolerance),
                "give zero or a positive number of seconds",
            ));
        }
        Ok(())
    }

    /// Checks that each measurement has exactly one source of its weight.
    fn check_with(&self, columns: &Columns, file: &str, line: u64) -> Result<(), ConvertError> {
        let refuse = |problem: &str, remedy: &str| Err(ConvertError::line(file, line, problem, remedy));
        match (columns.measurement.is_some(), columns.weight.is_some(), self.sigmas().is_some()) {
            (true, true, true) => refuse(
                "the table gives standard deviations or matrices, and so do --closure-sigma-translation and --closure-sigma-rotation",
                "leave the columns or the options out",
            ),
            (true, false, false) => refuse(
                "the measurements have no weight",
                "add the columns sigma_translation,sigma_rotation, the terms of a covariance (cov_xx, …) or of an information matrix (info_xx, …), or set --closure-sigma-translation and --closure-sigma-rotation",
            ),
            (false, true, _) | (false, _, true) => refuse(
                "there are standard deviations or matrices, but no measurements that they could weight",
                "add the columns of a measurement (x,y,theta or x,y,z,qx,qy,qz,qw), or leave the weights out",
            ),
            _ => Ok(()),
        }
    }
}

/// A line of the table.
struct Row<'a> {
    file: &'a str,
    line: u64,
    record: &'a csv::StringRecord,
}

impl Row<'_> {
    fn refuse(&self, problem: impl Into<String>, remedy: impl Into<String>) -> ConvertError {
        ConvertError::line(self.file, self.line, problem, remedy)
    }

    fn field(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default()
    }

    /// The field, unless it is empty.
    fn filled(&self, column: usize) -> Option<&str> {
        Some(self.field(column)).filter(|text| !text.is_empty())
    }

    fn number(&self, text: &str) -> Result<f64, ConvertError> {
        number(self.file, self.line, text)
    }

    fn numbers(&self, columns: &[usize]) -> Result<Vec<f64>, ConvertError> {
        columns.iter().map(|&column| self.number(self.field(column))).collect()
    }

    /// The measurement; `None` if all its fields are empty.
    fn measurement(&self, columns: &Columns, dimension: Dimension) -> Result<Option<Vec<f64>>, ConvertError> {
        let Some(columns) = &columns.measurement else { return Ok(None) };
        let filled = columns.iter().filter(|&&column| self.filled(column).is_some()).count();
        if filled == 0 {
            return Ok(None);
        }
        if filled < columns.len() {
            return Err(self.refuse(
                format!("{filled} of the {} fields of the measurement are filled", columns.len()),
                "fill all of them, or none if there is no measurement",
            ));
        }
        let mut pose = self.numbers(columns)?;
        if dimension == Dimension::Three {
            let norm = pose[3..].iter().map(|component| component * component).sum::<f64>().sqrt();
            if !((norm - 1.0).abs() <= 1e-3) {
                return Err(self.refuse(
                    format!("the quaternion has norm {norm}, not 1"),
                    "normalise it; the columns are qx, qy, qz, qw",
                ));
            }
            // Few printed digits leave a quaternion slightly off unit norm: normalise it.
            if (norm - 1.0).abs() > 1e-9 {
                pose[3..].iter_mut().for_each(|component| *component /= norm);
            }
        }
        Ok(Some(pose))
    }

    fn information(
        &self,
        columns: &Columns,
        dimension: Dimension,
        options: &ClosureOptions,
    ) -> Result<Vec<f64>, ConvertError> {
        let isotropic = |(translation, rotation)| {
            isotropic_information(dimension.degrees_of_freedom(), translation, rotation)
        };
        match &columns.weight {
            None => Ok(options.sigmas().map(isotropic).unwrap_or_default()),
            Some(Weight::Sigmas(places)) => {
                let sigmas = self.numbers(places)?;
                for (name, sigma) in ["sigma_translation", "sigma_rotation"].into_iter().zip(&sigmas) {
                    // The information is one over the square, and both must be finite.
                    if !(1e-50..=1e50).contains(sigma) {
                        return Err(self.refuse(
                            format!("{name} is {sigma}"),
                            "give a positive standard deviation, from 1e-50 to 1e50",
                        ));
                    }
                }
                Ok(isotropic((sigmas[0], sigmas[1])))
            }
            Some(Weight::Matrix { inverse, terms }) => matrix::information(self, *inverse, terms, dimension),
        }
    }

    fn label(&self, columns: &Columns) -> Result<Option<bool>, ConvertError> {
        match columns.label.and_then(|column| self.filled(column)) {
            None => Ok(None),
            Some("1") => Ok(Some(true)),
            Some("0") => Ok(Some(false)),
            Some(other) => Err(self.refuse(
                format!("the label is \"{other}\""),
                "a label is 1 for a correct closure, 0 for an incorrect one, or empty",
            )),
        }
    }
}
