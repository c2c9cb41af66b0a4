//! The columns of a table of closures, found by their names.

use std::collections::BTreeMap;

use posecut_graph::Dimension;

use super::matrix::{COVARIANCE, INFORMATION, Term, axes, terms};
use crate::ConvertError;

/// How the table names the ends of a closure: the columns of both ends.
pub(super) enum Ends {
    Ids([usize; 2]),
    Frames { frames: [usize; 2], sessions: Option<[usize; 2]> },
    Times { times: [usize; 2], sessions: Option<[usize; 2]> },
}

/// What weights the measurements.
pub(super) enum Weight {
    Sigmas([usize; 2]),
    /// A matrix, by its terms; `inverse` if it is the covariance.
    Matrix {
        inverse: bool,
        terms: Vec<Term>,
    },
}

/// The positions of the columns.
pub(super) struct Columns {
    pub(super) ends: Ends,
    pub(super) measurement: Option<Vec<usize>>,
    pub(super) weight: Option<Weight>,
    pub(super) score: Option<usize>,
    pub(super) label: Option<usize>,
}

const PLANAR: &[&str] = &["x", "y", "theta"];
const SPATIAL: &[&str] = &["x", "y", "z", "qx", "qy", "qz", "qw"];

/// The known names, for messages.
const KNOWN: &str = "from,to; frame_from,frame_to; time_from,time_to; session_from,session_to; x,y,theta or x,y,z,qx,qy,qz,qw; sigma_translation,sigma_rotation; cov_… or info_… with two axes, such as cov_xx; score; label";

/// The names of a header that have not been used yet.
struct Header<'a> {
    file: &'a str,
    line: u64,
    dimension: Dimension,
    names: BTreeMap<&'a str, usize>,
}

impl Columns {
    pub(super) fn of(
        file: &str,
        line: u64,
        header: &csv::StringRecord,
        dimension: Dimension,
    ) -> Result<Self, ConvertError> {
        let mut names = BTreeMap::new();
        for (column, name) in header.iter().enumerate() {
            let name = name.trim_start_matches('\u{feff}');
            if names.insert(name, column).is_some() {
                return Err(ConvertError::line(
                    file,
                    line,
                    format!("the column \"{name}\" occurs twice"),
                    "keep one of the two",
                ));
            }
        }
        let mut header = Header { file, line, dimension, names };
        let columns = Self {
            ends: header.ends()?,
            measurement: header.measurement()?,
            weight: header.weight()?,
            score: header.names.remove("score"),
            label: header.names.remove("label"),
        };
        match header.names.first_key_value() {
            None => Ok(columns),
            Some((name, _)) => Err(header.refuse(
                format!("the column \"{name}\" is unknown"),
                format!("the known columns are {KNOWN}"),
            )),
        }
    }
}

impl Header<'_> {
    fn refuse(&self, problem: impl Into<String>, remedy: impl Into<String>) -> ConvertError {
        ConvertError::line(self.file, self.line, problem, remedy)
    }

    /// Takes all of these columns, or none. It is an error if only some are there.
    fn all<const N: usize>(&mut self, wanted: [&str; N]) -> Result<Option<[usize; N]>, ConvertError> {
        Ok(self.list(&wanted)?.and_then(|columns| columns.try_into().ok()))
    }

    fn list(&mut self, wanted: &[&str]) -> Result<Option<Vec<usize>>, ConvertError> {
        let missing: Vec<&str> =
            wanted.iter().copied().filter(|name| !self.names.contains_key(name)).collect();
        if missing.is_empty() {
            return Ok(wanted.iter().map(|name| self.names.remove(*name)).collect());
        }
        if missing.len() == wanted.len() {
            return Ok(None);
        }
        let found: Vec<&str> = wanted.iter().copied().filter(|name| self.names.contains_key(name)).collect();
        Err(self.refuse(
            format!("the header has {}, but not {}", found.join(","), missing.join(",")),
            format!("{} belong together", wanted.join(",")),
        ))
    }

    fn ends(&mut self) -> Result<Ends, ConvertError> {
        let sessions = self.all(["session_from", "session_to"])?;
        let ids = self.all(["from", "to"])?;
        let frames = self.all(["frame_from", "frame_to"])?;
        let times = self.all(["time_from", "time_to"])?;
        match (ids, frames, times) {
            (Some(ids), None, None) if sessions.is_none() => Ok(Ends::Ids(ids)),
            (None, Some(frames), None) => Ok(Ends::Frames { frames, sessions }),
            (None, None, Some(times)) => Ok(Ends::Times { times, sessions }),
            (None, None, None) => Err(self.refuse(
                "no columns name the ends of the closures",
                "name them from,to (node ids), frame_from,frame_to (with session_from,session_to if frames repeat) or time_from,time_to (seconds)",
            )),
            _ => Err(self.refuse(
                "the columns name the ends of the closures in several ways",
                "keep from,to, or frame_from,frame_to or time_from,time_to, either with or without session_from,session_to",
            )),
        }
    }

    fn measurement(&mut self) -> Result<Option<Vec<usize>>, ConvertError> {
        let planar = self.names.contains_key("theta");
        let spatial = SPATIAL[2..].iter().any(|name| self.names.contains_key(name));
        match (self.dimension, planar, spatial) {
            (_, true, true) => Err(self.refuse(
                "the columns of the measurements are those of the plane and those of space",
                "keep x,y,theta or x,y,z,qx,qy,qz,qw",
            )),
            (Dimension::Two, _, true) => Err(self.refuse(
                "the measurements are spatial, but the graph is planar",
                "give x,y,theta, the motion in the plane",
            )),
            (Dimension::Three, true, _) => Err(self.refuse(
                "the measurements are planar, but the graph is spatial",
                "project a trajectory with --dimension 2, or give x,y,z,qx,qy,qz,qw; a rotation by theta about z is 0,0,sin(theta/2),cos(theta/2)",
            )),
            (Dimension::Two, ..) => self.list(PLANAR),
            (Dimension::Three, ..) => self.list(SPATIAL),
        }
    }

    fn weight(&mut self) -> Result<Option<Weight>, ConvertError> {
        let sigmas = self.all(["sigma_translation", "sigma_rotation"])?.map(Weight::Sigmas);
        let covariance = self.matrix(COVARIANCE)?.map(|terms| Weight::Matrix { inverse: true, terms });
        let information = self.matrix(INFORMATION)?.map(|terms| Weight::Matrix { inverse: false, terms });
        let mut given = [sigmas, covariance, information].into_iter().flatten();
        match (given.next(), given.next()) {
            (weight, None) => Ok(weight),
            _ => Err(self.refuse(
                "the columns weight the measurements in several ways",
                "keep the standard deviations, the covariance or the information matrix",
            )),
        }
    }

    /// The terms of a matrix: its upper triangle, or its diagonal.
    fn matrix(&mut self, prefix: &str) -> Result<Option<Vec<Term>>, ConvertError> {
        let all = terms(self.dimension);
        let name = |&(row, column): &(usize, usize)| {
            let axes = axes(self.dimension);
            format!("{prefix}{}{}", axes[row], axes[column])
        };
        let names: Vec<String> = all.iter().map(name).collect();
        let found: Vec<Term> = all
            .iter()
            .zip(&names)
            .filter_map(|(&(row, column), name)| {
                Some(Term { row, column, field: self.names.remove(name.as_str())? })
            })
            .collect();
        if found.is_empty() {
            return Ok(None);
        }
        let diagonal =
            found.len() == axes(self.dimension).len() && found.iter().all(|term| term.row == term.column);
        if found.len() == all.len() || diagonal {
            return Ok(Some(found));
        }
        let missing = all
            .iter()
            .zip(&names)
            .find(|((row, column), _)| !found.iter().any(|term| (term.row, term.column) == (*row, *column)));
        Err(self.refuse(
            format!("the column \"{}\" is missing", missing.map_or("", |(_, name)| name)),
            format!(
                "name all {} terms of the upper triangle, or only the diagonal: {}",
                all.len(),
                names.join(",")
            ),
        ))
    }
}
