//! Lists of matched frames, as place recognisers write them.

use std::collections::HashMap;

use posecut_graph::{Edge, EdgeKind, EdgeTruth, PoseGraph, for_dimension};
use serde::Serialize;

use crate::correct::Similarity;
use crate::landmark::Counts;
use crate::noise::add_noise_model;
use crate::viewpoint::{Headed, Viewpoint, viewpoints};
use crate::{ConstructError, Options};

/// What a match of two frames says about their relative pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum MatchMeasurement {
    /// No measurement: only the multicut uses such edges
    None,
    /// The identity, with the standard deviations of landmark edges
    Identity,
}

/// One line of a list of matches.
#[derive(Clone, Debug, PartialEq)]
pub struct Match {
    /// Line of the file, from 1.
    pub line: u64,
    /// The two frames, each with its session if the list gives one.
    pub ends: [Frame; 2],
    /// The recogniser's score, on any scale.
    pub score: Option<f64>,
}

/// A frame of a list of matches.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// The frame number of a node.
    pub number: i64,
    /// The session, if the list gives one.
    pub session: Option<String>,
}

/// The index of each column. Without a header the list starts with frame i, frame j and score.
struct Columns {
    frames: [usize; 2],
    sessions: [Option<usize>; 2],
    score: Option<usize>,
}

/// Reads a list of matches: CSV with the columns `frame_i,frame_j` and optionally `score`, `session_i`, `session_j`.
/// Without a header line the columns are frame i, frame j, score. Lines that start with `#` are comments. Errors name
/// file, line and column.
pub fn read_matches(file: &str, bytes: &[u8]) -> Result<Vec<Match>, ConstructError> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(bytes);
    let mut columns = Columns { frames: [0, 1], sessions: [None, None], score: Some(2) };
    let mut matches = Vec::new();
    for (index, record) in reader.records().enumerate() {
        let record = record.map_err(|error| {
            let line = error.position().map_or(0, csv::Position::line);
            refused(file, line, error.to_string(), "save the list as comma-separated text in UTF-8")
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        if index == 0 && record.get(0).is_some_and(|field| field.parse::<f64>().is_err()) {
            columns = Columns::named(file, line, &record)?;
            continue;
        }
        matches.push(columns.parse(file, line, &record)?);
    }
    Ok(matches)
}

impl Columns {
    fn named(file: &str, line: u64, header: &csv::StringRecord) -> Result<Self, ConstructError> {
        let find = |name: &str| header.iter().position(|column| column.eq_ignore_ascii_case(name));
        let frame = |name: &str| {
            find(name).ok_or_else(|| {
                refused(
                    file,
                    line,
                    format!("the header has no column \"{name}\""),
                    "name the columns frame_i,frame_j,score (and session_i,session_j), or remove the header",
                )
            })
        };
        Ok(Self {
            frames: [frame("frame_i")?, frame("frame_j")?],
            sessions: [find("session_i"), find("session_j")],
            score: find("score"),
        })
    }

    fn parse(&self, file: &str, line: u64, record: &csv::StringRecord) -> Result<Match, ConstructError> {
        let number = |end: usize| {
            let field = record.get(self.frames[end]).unwrap_or_default();
            field.parse().map_err(|_| {
                let name = ["frame_i", "frame_j"][end];
                refused(
                    file,
                    line,
                    format!("{name} is \"{field}\", but must be a whole number"),
                    "correct the line",
                )
            })
        };
        let session = |end: usize| {
            let column = self.sessions[end].and_then(|column| record.get(column));
            column.filter(|name| !name.is_empty()).map(str::to_owned)
        };
        let score = match self.score.and_then(|column| record.get(column)).filter(|field| !field.is_empty()) {
            None => None,
            Some(field) => {
                Some(field.parse().ok().filter(|score: &f64| score.is_finite()).ok_or_else(|| {
                    refused(
                        file,
                        line,
                        format!("score is \"{field}\", but must be a finite number"),
                        "correct the line",
                    )
                })?)
            }
        };
        let frame = |end| Ok(Frame { number: number(end)?, session: session(end) });
        Ok(Match { line, ends: [frame(0)?, frame(1)?], score })
    }
}

/// Adds an edge for each match. If both viewpoints have ground truth, the edge's truth says whether they are spatially
/// similar, as for constructed edges. O(nodes + matches).
pub fn add_matches(
    graph: &mut PoseGraph,
    file: &str,
    matches: &[Match],
    options: &Options,
) -> Result<Counts, ConstructError> {
    for_dimension!(graph.header.dimension, |G, DOF| add::<G, DOF>(graph, file, matches, options))
}

fn add<G: Headed<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    file: &str,
    matches: &[Match],
    options: &Options,
) -> Result<Counts, ConstructError> {
    let mut pairs = HashMap::with_capacity(matches.len());
    let mut edges = Vec::with_capacity(matches.len());
    let frames = Frames::of(graph);
    for entry in matches {
        let ends = frames.nodes(file, entry)?;
        let key = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        if let Some(first) = pairs.insert(key, entry.line) {
            return Err(refused(
                file,
                entry.line,
                format!("the same two frames are already matched on line {first}"),
                "delete one of the two lines",
            ));
        }
        edges.push((key, entry.score));
    }
    edges.sort_by_key(|&(ends, _)| ends);
    let noise = (options.match_measurement == MatchMeasurement::Identity)
        .then(|| add_noise_model::<DOF>(graph, options));
    let known: HashMap<u64, Viewpoint<G>> =
        viewpoints::<G, DOF>(graph).into_iter().map(|viewpoint| (viewpoint.node, viewpoint)).collect();
    let similarity = Similarity { minimum_interval: 0.0, ..Similarity::of(options) };
    let first = graph.edges.last().map_or(0, |edge| edge.id + 1);
    let mut judged = [0_usize; 2];
    for (id, ((from, to), score)) in (first..).zip(edges) {
        let mut edge = Edge::new(EdgeKind::Landmark, id, from, to);
        edge.score = score;
        edge.measurement = noise.is_some().then(|| G::identity().components());
        edge.noise.clone_from(&noise);
        if let (Some(from), Some(to)) = (known.get(&from), known.get(&to)) {
            let correct = similarity.near(from, to);
            judged[usize::from(correct)] += 1;
            edge.truth = Some(EdgeTruth::of(correct));
        }
        graph.edges.push(edge);
    }
    Ok(Counts {
        nodes_with_truth: known.len(),
        landmark_edges: matches.len(),
        correct_edges: judged[1],
        incorrect_edges: judged[0],
        incorrect_groups: None,
    })
}

/// Nodes by frame, session by session.
struct Frames {
    sessions: Vec<String>,
    /// Frame number to (session, node).
    nodes: HashMap<i64, Vec<(usize, u64)>>,
}

impl Frames {
    fn of(graph: &PoseGraph) -> Self {
        let sessions: Vec<String> = graph.sessions().into_iter().map(str::to_owned).collect();
        let mut nodes: HashMap<i64, Vec<(usize, u64)>> = HashMap::new();
        for node in &graph.nodes {
            let Some((session, frame)) = node.session_frame() else { continue };
            let Some(session) = sessions.iter().position(|name| name == session) else { continue };
            nodes.entry(frame).or_default().push((session, node.id));
        }
        Self { sessions, nodes }
    }

    /// The two nodes of a match. A frame that only one session has needs no session name. If the graph has two
    /// sessions, a match without names joins frame i of the first with frame j of the second.
    fn nodes(&self, file: &str, entry: &Match) -> Result<[u64; 2], ConstructError> {
        let mut found = [0; 2];
        for (end, frame) in entry.ends.iter().enumerate() {
            let all = self.nodes.get(&frame.number).map_or(&[][..], Vec::as_slice);
            let wanted = match &frame.session {
                Some(name) => {
                    Some(self.sessions.iter().position(|known| known == name).ok_or_else(|| {
                        refused(
                            file,
                            entry.line,
                            format!("there is no session \"{name}\""),
                            format!("use one of {}", self.sessions.join(", ")),
                        )
                    })?)
                }
                None if all.len() > 1 && self.sessions.len() == 2 => Some(end),
                None => None,
            };
            let mut candidates =
                all.iter().filter(|(session, _)| wanted.is_none_or(|wanted| wanted == *session));
            let node = match (candidates.next(), candidates.next()) {
                (Some(&(_, node)), None) => node,
                (None, _) => {
                    return Err(refused(
                        file,
                        entry.line,
                        format!("no node has frame {}", frame.number),
                        "use the frame numbers of the session graphs, after down-sampling",
                    ));
                }
                (Some(_), Some(_)) => {
                    return Err(refused(
                        file,
                        entry.line,
                        format!("frame {} is in several sessions", frame.number),
                        "add the columns session_i and session_j",
                    ));
                }
            };
            found[end] = node;
        }
        if found[0] == found[1] {
            return Err(refused(
                file,
                entry.line,
                format!("frame {} is matched to itself", entry.ends[0].number),
                "delete the line",
            ));
        }
        Ok(found)
    }
}

fn refused(file: &str, line: u64, problem: String, remedy: impl Into<String>) -> ConstructError {
    ConstructError::Matches { file: file.to_owned(), line, problem, remedy: remedy.into() }
}
