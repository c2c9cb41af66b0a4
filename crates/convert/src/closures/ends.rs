//! Finds the nodes that a table of closures names.

use std::collections::{BTreeMap, HashMap};

use posecut_graph::PoseGraph;

use super::Row;
use super::columns::Ends;
use crate::ConvertError;
use crate::tum::microseconds;

/// The nodes of a graph, by what the table calls them.
pub(super) struct Nodes<'a> {
    graph: &'a PoseGraph,
    /// Session and id of the nodes of each frame.
    frames: HashMap<i64, Vec<(&'a str, u64)>>,
    /// Time and id of the nodes of each session, in the order of time.
    times: BTreeMap<&'a str, Vec<(i64, u64)>>,
    /// Microseconds.
    tolerance: u64,
}

impl<'a> Nodes<'a> {
    pub(super) fn of(graph: &'a PoseGraph, ends: &Ends, tolerance: f64) -> Self {
        let mut nodes = Self {
            graph,
            frames: HashMap::new(),
            times: BTreeMap::new(),
            tolerance: (tolerance * 1e6).round() as u64,
        };
        for node in &graph.nodes {
            let session = node.session.as_deref().unwrap_or_default();
            match ends {
                Ends::Ids(_) => {}
                Ends::Frames { .. } => {
                    if let Some(frame) = node.frame {
                        nodes.frames.entry(frame).or_default().push((session, node.id));
                    }
                }
                Ends::Times { .. } => {
                    if let Some(time) = node.utime {
                        nodes.times.entry(session).or_default().push((time, node.id));
                    }
                }
            }
        }
        nodes.times.values_mut().for_each(|times| times.sort_unstable());
        nodes
    }

    /// The nodes at the two ends of a closure.
    pub(super) fn ends(&self, row: &Row, ends: &Ends) -> Result<[u64; 2], ConvertError> {
        let session = |sessions: &Option<[usize; 2]>, end: usize| {
            sessions.map(|columns| row.field(columns[end])).filter(|name| !name.is_empty())
        };
        let find = |end: usize| match ends {
            Ends::Ids(columns) => self.by_id(row, row.field(columns[end])),
            Ends::Frames { frames, sessions } => {
                self.by_frame(row, row.field(frames[end]), session(sessions, end))
            }
            Ends::Times { times, sessions } => {
                self.by_time(row, row.field(times[end]), session(sessions, end))
            }
        };
        Ok([find(0)?, find(1)?])
    }

    fn by_id(&self, row: &Row, text: &str) -> Result<u64, ConvertError> {
        let id = text.parse().map_err(|_| {
            row.refuse(format!("\"{text}\" is not a node id"), "ids are whole numbers from 0 to 2^64 - 1")
        })?;
        match self.graph.node_index(id) {
            Some(_) => Ok(id),
            None => Err(row.refuse(
                format!("the graph has no node {id}"),
                "use the ids of the graph, or name the ends by frame or time",
            )),
        }
    }

    fn by_frame(&self, row: &Row, text: &str, session: Option<&str>) -> Result<u64, ConvertError> {
        let frame: i64 = text.parse().map_err(|_| {
            row.refuse(format!("\"{text}\" is not a frame number"), "frames are whole numbers")
        })?;
        let found = self.frames.get(&frame).into_iter().flatten();
        let mut found = found.filter(|(name, _)| session.is_none_or(|session| session == *name));
        let of = session.map_or(String::new(), |session| format!(" of session \"{session}\""));
        match (found.next(), found.next()) {
            (Some(&(_, id)), None) => Ok(id),
            (None, _) => Err(row.refuse(
                format!("no node{of} has frame {frame}"),
                format!("use the frames of the graph, whose sessions are {}", self.sessions()),
            )),
            (Some((first, _)), Some((second, _))) if first != second => Err(row.refuse(
                format!("frame {frame} is in several sessions: {first} and {second}"),
                "add the columns session_from,session_to",
            )),
            _ => Err(row.refuse(
                format!("frame {frame} is in one session several times"),
                "name the ends by node id: from,to",
            )),
        }
    }

    fn by_time(&self, row: &Row, text: &str, session: Option<&str>) -> Result<u64, ConvertError> {
        let seconds = row.number(text)?;
        let time = microseconds(seconds).ok_or_else(|| {
            row.refuse(
                format!("the time {text} s does not fit into 64 bits of microseconds"),
                "give times in seconds",
            )
        })?;
        let mut nearest: Vec<(u64, &str, u64)> = self
            .times
            .iter()
            .filter(|(name, _)| session.is_none_or(|session| session == **name))
            .filter_map(|(name, times)| {
                let (distance, id) = nearest(times, time)?;
                Some((distance, *name, id))
            })
            .collect();
        nearest.sort_by_key(|(distance, ..)| *distance);
        let near: Vec<_> = nearest.iter().filter(|(distance, ..)| *distance <= self.tolerance).collect();
        match (near.as_slice(), nearest.first()) {
            ([(_, _, id)], _) => Ok(*id),
            ([(_, first, _), (_, second, _), ..], _) => Err(row.refuse(
                format!("several sessions have nodes near the time {text} s: {first} and {second}"),
                "add the columns session_from,session_to",
            )),
            ([], Some((distance, name, id))) => Err(row.refuse(
                format!(
                    "no node is within {} s of the time {text} s; the nearest is node {id} of session \"{name}\", {} s away",
                    self.tolerance as f64 / 1e6,
                    *distance as f64 / 1e6
                ),
                "check the clocks, or raise --time-tolerance",
            )),
            ([], None) => Err(row.refuse(
                match session {
                    Some(session) => format!("no node of session \"{session}\" has a time"),
                    None => "no node of the graph has a time".to_owned(),
                },
                "name the ends by node id (from,to) or frame (frame_from,frame_to)",
            )),
        }
    }

    fn sessions(&self) -> String {
        self.graph.sessions().join(", ")
    }
}

/// Distance and id of the node nearest to a time; of two at the same distance the earlier one.
fn nearest(times: &[(i64, u64)], time: i64) -> Option<(u64, u64)> {
    let after = times.partition_point(|(other, _)| *other < time);
    let neighbours = [after.checked_sub(1), Some(after)];
    let distances = neighbours.into_iter().flatten().filter_map(|index| times.get(index));
    distances.map(|(other, id)| (other.abs_diff(time), *id)).min_by_key(|(distance, _)| *distance)
}
