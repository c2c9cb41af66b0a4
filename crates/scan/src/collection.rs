//! The scans of a graph, by node.

use std::collections::BTreeMap;
use std::io::BufRead;

use posecut_graph::{PoseGraph, bounded_lines};
use serde::Deserialize;

use crate::laser::Fields;
use crate::{KIND, LaserScan, ScanError};

/// The scans of a graph, at most one a node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scans(BTreeMap<u64, LaserScan>);

impl FromIterator<(u64, LaserScan)> for Scans {
    /// Of nodes and their scans; of two scans of a node the later one.
    fn from_iter<I: IntoIterator<Item = (u64, LaserScan)>>(scans: I) -> Self {
        Self(scans.into_iter().collect())
    }
}

#[derive(Deserialize)]
struct Kind<'a> {
    #[serde(borrow)]
    kind: std::borrow::Cow<'a, str>,
}

impl Scans {
    /// The scans among the records of unknown kind of a graph. O(size).
    ///
    /// # Errors
    ///
    /// A record of kind `scan` is not one, names a node that the graph does not have, or a node has two.
    pub fn of_graph(graph: &PoseGraph) -> Result<Self, ScanError> {
        let mut scans = Self::default();
        for (number, record) in graph.unknown.iter().enumerate() {
            scans.add(record, || format!("record {} after priors", number + 1))?;
        }
        scans.check_nodes(graph)?;
        Ok(scans)
    }

    /// The scans of a file of records, one a line. Records of other kinds and blank lines are skipped. O(size).
    ///
    /// # Errors
    ///
    /// As for [`of_graph`](Self::of_graph), or the file cannot be read. [`check_nodes`](Self::check_nodes) remains to be called.
    pub fn read(source_name: &str, reader: impl BufRead) -> Result<Self, ScanError> {
        let mut scans = Self::default();
        for (number, line) in bounded_lines(reader).enumerate() {
            let line = line.map_err(|error| ScanError::Io { source_name: source_name.to_owned(), error })?;
            if !line.trim().is_empty() {
                scans.add(&line, || format!("{source_name}, line {}", number + 1))?;
            }
        }
        Ok(scans)
    }

    /// The scans of a file, given by its name and content, whose nodes the graph must have; without a file those in the graph.
    ///
    /// # Errors
    ///
    /// As for [`of_graph`](Self::of_graph) and [`read`](Self::read).
    pub fn of_file_or_graph(file: Option<&(String, Vec<u8>)>, graph: &PoseGraph) -> Result<Self, ScanError> {
        let Some((name, bytes)) = file else { return Self::of_graph(graph) };
        let scans = Self::read(name, &bytes[..])?;
        scans.check_nodes(graph)?;
        Ok(scans)
    }

    /// Checks that the graph has the node of every scan.
    pub fn check_nodes(&self, graph: &PoseGraph) -> Result<(), ScanError> {
        match self.0.keys().find(|node| graph.node_index(**node).is_none()) {
            None => Ok(()),
            Some(node) => Err(ScanError::Record {
                place: format!("scan of node {node}"),
                problem: "the graph has no such node".to_owned(),
                remedy: "use the scans that were written with this graph",
            }),
        }
    }

    /// The scan of a node.
    pub fn at(&self, node: u64) -> Option<&LaserScan> {
        self.0.get(&node)
    }

    /// Nodes and scans in the order of the nodes.
    pub fn iter(&self) -> impl Iterator<Item = (u64, &LaserScan)> {
        self.0.iter().map(|(node, scan)| (*node, scan))
    }

    /// The number of scans.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn add(&mut self, record: &str, place: impl Fn() -> String) -> Result<(), ScanError> {
        let refused = |problem: String| ScanError::Record {
            place: place(),
            problem,
            remedy: "correct it by the description in crates/scan/README.md, or read the log again with posecut-ingest",
        };
        let kind: Kind =
            serde_json::from_str(record).map_err(|error| refused(format!("not a record: {error}")))?;
        if kind.kind != KIND {
            return Ok(());
        }
        let fields: Fields =
            serde_json::from_str(record).map_err(|error| refused(format!("not a scan: {error}")))?;
        let node = fields.node;
        let scan = fields.scan().map_err(|problem| refused(format!("scan of node {node}: {problem}")))?;
        if self.0.insert(node, scan).is_some() {
            return Err(refused(format!("node {node} has two scans")));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use posecut_geometry::SE2;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn a_scan_survives_its_record(
            sensor in prop::array::uniform3(-3.0..3.0),
            first_angle in -4.0..4.0,
            angle_step in 1e-3..0.1,
            ranges in prop::collection::vec(0.0..80.0, 0..20),
        ) {
            let [x, y, theta] = sensor;
            let scan = LaserScan { sensor: SE2::new(x, y, theta), first_angle, angle_step, ranges };
            let read = Scans::read("test", scan.record(3).unwrap().as_bytes()).unwrap();
            let read = read.at(3).unwrap();
            prop_assert_eq!(&read.ranges, &scan.ranges);
            prop_assert!((read.sensor.angle() - scan.sensor.angle()).abs() < 1e-15);
            for (one, other) in read.points().zip(scan.points()) {
                prop_assert!((one - other).norm() < 1e-12);
            }
        }
    }

    #[test]
    fn what_is_not_a_scan_is_refused_with_its_line() {
        let good = r#"{"kind":"scan","node":1,"first_angle":0,"angle_step":0.1,"ranges":[1,2]}"#;
        for (line, expected) in [
            (r#"{"kind":"scan","node":1}"#, "not a scan: missing field"),
            (r#"{"kind":"scan","node":1,"first_angle":0,"angle_step":0,"ranges":[]}"#, "its angle_step is 0"),
            (
                r#"{"kind":"scan","node":1,"first_angle":0,"angle_step":1,"ranges":[-1]}"#,
                "range of beam 0 is -1",
            ),
            (good, "node 1 has two scans"),
            ("{", "not a record"),
        ] {
            let text = format!("{good}\n\n{{\"kind\":\"note\"}}\n{line}\n");
            let said = Scans::read("file", text.as_bytes()).unwrap_err().to_string();
            assert!(said.starts_with("file, line 4: ") && said.contains(expected), "{said}");
        }
    }

    #[test]
    fn a_scan_of_a_missing_node_is_refused() {
        let header = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;
        let scan = r#"{"kind":"scan","node":9,"first_angle":0,"angle_step":0.1,"ranges":[]}"#;
        let text = format!("{header}\n{{\"kind\":\"node\",\"id\":0}}\n{scan}\n");
        let graph = PoseGraph::read("test", text.as_bytes()).unwrap();
        let said = Scans::of_graph(&graph).unwrap_err().to_string();
        assert!(said.starts_with("scan of node 9: the graph has no such node"), "{said}");
    }
}
