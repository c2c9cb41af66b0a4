//! Reading g2o.

mod priors;
mod settings;

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::io::BufRead;

use posecut_geometry::SE3;
use posecut_graph::{
    Dimension, Edge, EdgeKind, FIXED, Header, Node, PoseGraph, Prior, PriorOf, negative_eigenvalue,
};
use serde_json::Value;

pub use settings::{ReadOptions, ReadSummary};

use super::kind_of_comment;
use crate::ConvertError;
use crate::error::number;
use crate::information::{Repair, clamp};
use crate::lines::lines;
use crate::odometry::{session_and_frame, set_kinds};
use crate::printed_digits::leave_singularity_open;
use crate::toro;

/// The two formats that consist of vertices and edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dialect {
    /// g2o.
    G2o,
    /// TORO, from which g2o descends.
    Toro,
}

/// The vertices and edges of earlier files.
#[derive(Default)]
struct Earlier {
    vertices: HashSet<u64>,
    edges: usize,
    /// Positions in `edges` by the two vertices of an edge.
    by_ends: HashMap<(u64, u64), Vec<usize>>,
    /// Positions in `priors` by the node of a prior.
    priors: HashMap<u64, Vec<usize>>,
}

struct Reader<'a> {
    file: String,
    options: &'a ReadOptions,
    dialect: Dialect,
    line: u64,
    dimension: Option<Dimension>,
    vertices: BTreeMap<u64, Vec<f64>>,
    edges: Vec<Edge>,
    priors: Vec<Prior>,
    /// The parameters `PARAMS_SE3OFFSET` of the file.
    offsets: HashMap<u64, SE3>,
    /// The kind that a comment gives to the next edge.
    kind: Option<(u64, u64, EdgeKind)>,
    /// Whether a comment gave the kind of each edge.
    stated: Vec<bool>,
    /// Vertices fixed by `FIX`, with file and line.
    fixed: BTreeMap<u64, (String, u64)>,
    /// Vertices and edges of earlier files, so that a repeated one is read once.
    earlier: Earlier,
    summary: ReadSummary,
}

/// Reads a g2o file. Vertices may come in any order, after edges, or not at all. O(lines log lines).
pub fn read(
    file: &str,
    reader: impl BufRead,
    options: &ReadOptions,
) -> Result<(PoseGraph, ReadSummary), ConvertError> {
    read_dialect(vec![(file.to_owned(), reader)], options, Dialect::G2o)
}

/// Reads several g2o files, such as one a robot, into one graph. Vertices keep their ids, which must be unique among
/// all files. A vertex or an edge that several files repeat with the same numbers is read once.
pub fn read_several(
    files: Vec<(String, impl BufRead)>,
    options: &ReadOptions,
) -> Result<(PoseGraph, ReadSummary), ConvertError> {
    read_dialect(files, options, Dialect::G2o)
}

/// Reads files of either dialect.
pub(crate) fn read_dialect(
    files: Vec<(String, impl BufRead)>,
    options: &ReadOptions,
    dialect: Dialect,
) -> Result<(PoseGraph, ReadSummary), ConvertError> {
    let mut state = Reader {
        file: String::new(),
        options,
        dialect,
        line: 0,
        dimension: None,
        vertices: BTreeMap::new(),
        edges: Vec::new(),
        priors: Vec::new(),
        offsets: HashMap::new(),
        kind: None,
        stated: Vec::new(),
        fixed: BTreeMap::new(),
        earlier: Earlier::default(),
        summary: ReadSummary::default(),
    };
    for (file, reader) in files {
        state.begin(file.clone());
        for read in lines(&file, reader) {
            let (number, line) = read?;
            state.line = number;
            let fields: Vec<&str> = line.split_whitespace().collect();
            if fields.first().is_some_and(|tag| !tag.starts_with('#')) {
                state.record(&fields)?;
            } else if let Some(kind) = kind_of_comment(&fields) {
                state.kind = Some(kind);
            }
        }
    }
    state.graph()
}

impl Reader<'_> {
    /// Starts the next file.
    fn begin(&mut self, file: String) {
        self.file = file;
        self.line = 0;
        self.kind = None;
        self.earlier.vertices.extend(self.vertices.keys());
        for (index, edge) in self.edges.iter().enumerate().skip(self.earlier.edges) {
            self.earlier.by_ends.entry((edge.from, edge.to)).or_default().push(index);
        }
        self.earlier.edges = self.edges.len();
        self.offsets.clear();
        self.earlier.priors.clear();
        for (index, prior) in self.priors.iter().enumerate() {
            self.earlier.priors.entry(prior.node).or_default().push(index);
        }
    }

    /// Whether an earlier file has this edge with the same numbers.
    fn is_repeated(&self, from: u64, to: u64, measurement: &[f64], information: &[f64]) -> bool {
        self.earlier.by_ends.get(&(from, to)).into_iter().flatten().any(|&index| {
            let known = &self.edges[index];
            known.measurement.as_deref() == Some(measurement)
                && known.information.as_deref() == Some(information)
        })
    }

    fn record(&mut self, fields: &[&str]) -> Result<(), ConvertError> {
        let (tag, fields) = (fields[0], &fields[1..]);
        match (self.dialect, tag) {
            (Dialect::G2o, "VERTEX_SE2") | (Dialect::Toro, "VERTEX2") => {
                self.vertex(Dimension::Two, fields)
            }
            (Dialect::G2o, "VERTEX_SE3:QUAT") | (Dialect::Toro, "VERTEX3") => {
                self.vertex(Dimension::Three, fields)
            }
            (Dialect::G2o, "EDGE_SE2") | (Dialect::Toro, "EDGE2") => self.edge(Dimension::Two, fields),
            (Dialect::G2o, "EDGE_SE3:QUAT") | (Dialect::Toro, "EDGE3") => {
                self.edge(Dimension::Three, fields)
            }
            (Dialect::G2o, "FIX") => {
                for field in fields {
                    let id = self.id(field)?;
                    self.fixed.entry(id).or_insert_with(|| (self.file.clone(), self.line));
                }
                Ok(())
            }
            (Dialect::G2o, "EDGE_PRIOR_SE2") => self.planar_prior(PriorOf::Pose, fields),
            (Dialect::G2o, "EDGE_PRIOR_SE2_XY") => self.planar_prior(PriorOf::Position, fields),
            (Dialect::G2o, "EDGE_SE3_PRIOR") => self.spatial_prior(fields),
            (Dialect::G2o, "PARAMS_SE3OFFSET") => self.offset(fields),
            _ if self.options.skip_unknown => {
                *self.summary.skipped.entry(tag.to_owned()).or_default() += 1;
                Ok(())
            }
            _ => Err(self.refuse(
                format!("the tag {tag} is unknown"),
                match self.dialect {
                    Dialect::G2o => {
                        "pose graphs have VERTEX_SE2, EDGE_SE2, VERTEX_SE3:QUAT, EDGE_SE3:QUAT, FIX, and the priors EDGE_PRIOR_SE2, EDGE_PRIOR_SE2_XY and EDGE_SE3_PRIOR; --skip-unknown skips others"
                    }
                    Dialect::Toro => {
                        "TORO has VERTEX2, EDGE2, VERTEX3 and EDGE3; --skip-unknown skips others"
                    }
                },
            )),
        }
    }

    fn refuse(&self, problem: impl Into<String>, remedy: impl Into<String>) -> ConvertError {
        ConvertError::line(&self.file, self.line, problem, remedy)
    }

    fn id(&self, field: &str) -> Result<u64, ConvertError> {
        field.parse().map_err(|_| {
            self.refuse(format!("\"{field}\" is not a vertex id"), "ids are whole numbers from 0 to 2^64 - 1")
        })
    }

    fn numbers(&self, fields: &[&str], expected: usize) -> Result<Vec<f64>, ConvertError> {
        if fields.len() != expected {
            return Err(self.refuse(
                format!("expected {expected} numbers after the ids, found {}", fields.len()),
                "the line is cut short or of another type",
            ));
        }
        fields.iter().map(|field| number(&self.file, self.line, field)).collect()
    }

    fn agree(&mut self, dimension: Dimension) -> Result<(), ConvertError> {
        match self.dimension.replace(dimension) {
            Some(before) if before != dimension => Err(self.refuse(
                format!("a record of dimension {dimension} follows records of dimension {before}"),
                "a pose graph has one dimension; split the file",
            )),
            _ => Ok(()),
        }
    }

    fn pose_numbers(&self, dimension: Dimension) -> usize {
        match self.dialect {
            Dialect::G2o => dimension.pose_components(),
            Dialect::Toro => toro::pose_numbers(dimension),
        }
    }

    fn pose(&self, dimension: Dimension, mut pose: Vec<f64>) -> Result<Vec<f64>, ConvertError> {
        if self.dialect == Dialect::Toro {
            return Ok(toro::pose_from_toro(pose));
        }
        if dimension == Dimension::Three {
            let norm = pose[3..].iter().map(|component| component * component).sum::<f64>().sqrt();
            if !(norm > 1e-6 && norm.is_finite()) {
                return Err(self.refuse(
                    format!("the quaternion has norm {norm} and cannot be normalised"),
                    "correct the line; the order is qx qy qz qw",
                ));
            }
            // Few printed digits leave a quaternion slightly off unit norm: normalise it.
            if (norm - 1.0).abs() > 1e-9 {
                pose[3..].iter_mut().for_each(|component| *component /= norm);
            }
        }
        Ok(pose)
    }

    fn vertex(&mut self, dimension: Dimension, fields: &[&str]) -> Result<(), ConvertError> {
        self.agree(dimension)?;
        let Some((id, rest)) = fields.split_first() else {
            return Err(self.refuse("the vertex has no id", "the line is cut short"));
        };
        let id = self.id(id)?;
        let pose = self.pose(dimension, self.numbers(rest, self.pose_numbers(dimension))?)?;
        match self.vertices.get(&id) {
            None => {
                self.vertices.insert(id, pose);
                Ok(())
            }
            Some(known) if self.earlier.vertices.contains(&id) && *known == pose => Ok(()),
            Some(_) if self.earlier.vertices.contains(&id) => Err(self.refuse(
                format!("vertex {id} occurs twice: another file has it with other numbers"),
                "use --renumber if the files are different robots or sessions, else keep one of the two",
            )),
            Some(_) => Err(self.refuse(format!("vertex {id} occurs twice"), "keep one of the two")),
        }
    }

    fn edge(&mut self, dimension: Dimension, fields: &[&str]) -> Result<(), ConvertError> {
        self.agree(dimension)?;
        let [from, to, rest @ ..] = fields else {
            return Err(self.refuse("the edge has fewer than two ids", "the line is cut short"));
        };
        let (from, to) = (self.id(from)?, self.id(to)?);
        if from == to {
            return Err(self.refuse(format!("the edge joins vertex {from} to itself"), "delete the line"));
        }
        let components = self.pose_numbers(dimension);
        let mut numbers = self.numbers(rest, components + dimension.information_terms())?;
        let mut information = numbers.split_off(components);
        if self.dialect == Dialect::Toro {
            information =
                toro::information_from_toro(dimension, &numbers, &information).ok_or_else(|| {
                    self.refuse(
                        "the measured pitch is a right angle, where roll and yaw are indistinguishable and neither has information",
                        "write the edge in g2o's format, or rotate the frames of its vertices",
                    )
                })?;
        }
        if let Some(eigenvalue) = negative_eigenvalue(dimension, &information) {
            if self.options.repair == Repair::Refuse {
                return Err(self.refuse(
                    format!(
                        "the information matrix of edge {from} {to} is not positive semidefinite: its smallest eigenvalue is {eigenvalue:e}"
                    ),
                    "correct it at its source, or use --repair-information to set negative eigenvalues to zero",
                ));
            }
            information = clamp(dimension, &information).ok_or_else(|| {
                self.refuse(
                    format!("the information matrix of edge {from} {to} is too large to be repaired"),
                    "correct it at its source",
                )
            })?;
            self.summary.repaired += 1;
        } else if self.dialect == Dialect::G2o
            && leave_singularity_open(dimension, &rest[components..], &information)
        {
            self.summary.open += 1;
            self.summary.first_open.get_or_insert((self.line, from, to));
        }
        let measurement = self.pose(dimension, numbers)?;
        if self.is_repeated(from, to, &measurement, &information) {
            self.kind = None;
            return Ok(());
        }
        if from.abs_diff(to) == 1 && self.earlier.by_ends.contains_key(&(from, to)) {
            return Err(self.refuse(
                format!(
                    "another file has an edge {from} {to} with other numbers, so their ids are not unique"
                ),
                "use --renumber if the files are different robots or sessions, else keep one of the two",
            ));
        }
        let stated = self.kind.take().filter(|&(first, second, _)| (first, second) == (from, to));
        // Without a comment the kind is set when all ids are known.
        let kind = stated.map_or(EdgeKind::Landmark, |(_, _, kind)| kind);
        self.stated.push(stated.is_some());
        let mut edge = Edge::new(kind, self.edges.len() as u64, from, to);
        edge.measurement = Some(measurement);
        edge.information = Some(information);
        self.edges.push(edge);
        Ok(())
    }

    fn graph(mut self) -> Result<(PoseGraph, ReadSummary), ConvertError> {
        let Some(dimension) = self.dimension else {
            return Err(ConvertError::line(
                &self.file,
                self.line,
                "the input has neither vertices nor edges",
                "name a file with a pose graph",
            ));
        };
        let ids: BTreeSet<u64> = self
            .vertices
            .keys()
            .copied()
            .chain(self.edges.iter().flat_map(|edge| [edge.from, edge.to]))
            .chain(self.priors.iter().map(|prior| prior.node))
            .collect();
        let mut graph = PoseGraph::new(Header::new(dimension));
        for id in &ids {
            let (session, frame) = session_and_frame(*id, &self.options.session);
            let pose = self.vertices.remove(id);
            self.summary.without_vertex += usize::from(pose.is_none());
            let mut node =
                Node { id: *id, session: Some(session), frame: Some(frame), pose, ..Node::default() };
            if self.fixed.remove(id).is_some() {
                node.extra.insert(FIXED.to_owned(), Value::Bool(true));
            }
            graph.nodes.push(node);
        }
        if let Some((id, (file, line))) = self.fixed.first_key_value() {
            return Err(ConvertError::line(
                file,
                *line,
                format!("FIX names vertex {id}, which no other line names"),
                "correct the number, or delete the line",
            ));
        }
        graph.edges = self.edges;
        graph.priors = self.priors;
        self.summary.next_ids = set_kinds(self.options.odometry, &ids, &mut graph.edges, &self.stated);
        Ok((graph, self.summary))
    }
}
