//! A table of the landmark edges of a graph: what each one measures, who rejected it, and why.

use std::fmt;
use std::io::Write;

use posecut_geometry::LieGroup;
use posecut_graph::{Edge, EdgeKind, Node, PoseGraph, UnusableField, for_dimension};
use serde::Serialize;
use serde_json::Value;

/// One landmark edge. The names of the fields are the columns of the CSV file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Row {
    /// Its id.
    pub edge: u64,
    /// Id of the node from which it measures.
    pub from: u64,
    /// Id of the node to which it measures.
    pub to: u64,
    /// Session of the node `from`.
    pub session_from: Option<String>,
    /// Frame of the node `from`.
    pub frame_from: Option<i64>,
    /// Session of the node `to`.
    pub session_to: Option<String>,
    /// Frame of the node `to`.
    pub frame_to: Option<i64>,
    /// `accepted`, `rejected` or `undecided`, by `posecut-verify`. By any other stage: `in use` or `rejected`.
    pub verdict: String,
    /// The stage that rejected it.
    pub rejected_by: Option<String>,
    /// Probability that it is correct, by `posecut-verify`.
    pub probability: Option<f64>,
    /// Reason for the verdict, by `posecut-verify`.
    pub reason: Option<String>,
    /// Ids of the edges with the most evidence for or against it, separated by spaces.
    pub witness: Option<String>,
    /// Number of its hypothesis, by `posecut-verify`; 0 is the map.
    pub hypothesis: Option<u64>,
    /// Translation between its measurement and the poses of the graph, metres.
    pub residual_metres: Option<f64>,
    /// Rotation between its measurement and the poses of the graph, degrees.
    pub residual_degrees: Option<f64>,
    /// Squared Mahalanobis length of this residual, by the edge's information matrix.
    pub chi_square: Option<f64>,
    /// Confidence of the program that proposed it.
    pub score: Option<f64>,
    /// Whether the truth calls it correct.
    pub label_correct: Option<bool>,
}

/// The landmark edges of a graph, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EdgeTable {
    /// One row for each landmark edge.
    pub rows: Vec<Row>,
}

impl EdgeTable {
    /// Tabulates the landmark edges of a graph. O(edges).
    ///
    /// # Errors
    ///
    /// A pose, a measurement or an information matrix cannot be used.
    pub fn of(graph: &PoseGraph) -> Result<Self, UnusableField> {
        for_dimension!(graph.header.dimension, |G, DOF| rows::<G, DOF>(graph)).map(|rows| Self { rows })
    }

    /// Writes the table as CSV with a header line. Absent values are empty.
    ///
    /// # Errors
    ///
    /// The writer fails.
    pub fn write_csv(&self, writer: impl Write) -> csv::Result<()> {
        let mut writer = csv::Writer::from_writer(writer);
        if self.rows.is_empty() {
            writer.write_record(COLUMNS)?;
        }
        for row in &self.rows {
            writer.serialize(row)?;
        }
        writer.flush()?;
        Ok(())
    }
}

/// The columns of the CSV file, for a table without rows. A test compares them with the fields of [`Row`].
const COLUMNS: [&str; 18] = [
    "edge",
    "from",
    "to",
    "session_from",
    "frame_from",
    "session_to",
    "frame_to",
    "verdict",
    "rejected_by",
    "probability",
    "reason",
    "witness",
    "hypothesis",
    "residual_metres",
    "residual_degrees",
    "chi_square",
    "score",
    "label_correct",
];

fn rows<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph) -> Result<Vec<Row>, UnusableField> {
    let poses = graph.poses::<G, DOF>()?;
    graph.edges_of(EdgeKind::Landmark).map(|edge| row::<G, DOF>(graph, &poses, edge)).collect()
}

fn row<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    poses: &[G],
    edge: &Edge,
) -> Result<Row, UnusableField> {
    let ends = graph.ends(edge);
    let node = |index: usize| &graph.nodes[index];
    let session = |node: &Node| node.session.clone();
    let mut row = Row {
        edge: edge.id,
        from: edge.from,
        to: edge.to,
        verdict: verdict(edge),
        rejected_by: edge.rejected_by.clone(),
        probability: edge.extra.get("verify_probability").and_then(Value::as_f64),
        reason: edge.extra.get("verify_reason").and_then(Value::as_str).map(str::to_owned),
        witness: edge.extra.get("verify_witness").and_then(Value::as_array).map(|ids| witness(ids)),
        hypothesis: edge.extra.get("verify_hypothesis").and_then(Value::as_u64),
        score: edge.score,
        label_correct: edge.truth_correct(),
        ..Row::default()
    };
    if let Some((from, to)) = ends {
        row.session_from = session(node(from));
        row.session_to = session(node(to));
        row.frame_from = node(from).frame;
        row.frame_to = node(to).frame;
        let posed = node(from).pose.is_some() && node(to).pose.is_some();
        if let (true, Some((measured, information))) = (posed, graph.measurement::<G, DOF>(edge)?) {
            let motion = measured.between(&poses[from].between(&poses[to]));
            let residual = motion.log();
            let translation = graph.header.dimension.number() as usize;
            let squares: f64 = motion.components()[..translation].iter().map(|length| length * length).sum();
            row.residual_metres = Some(squares.sqrt());
            row.residual_degrees = Some(residual.rows(translation, DOF - translation).norm().to_degrees());
            row.chi_square = Some(residual.dot(&(information * residual)));
        }
    }
    Ok(row)
}

fn verdict(edge: &Edge) -> String {
    match edge.extra.get("verify_verdict").and_then(Value::as_str) {
        // A later stage may have rejected an accepted edge, or re-admitted another.
        Some("accepted") if !edge.in_use() => "rejected".to_owned(),
        Some("rejected") | None if edge.in_use() => "in use".to_owned(),
        Some(verdict) => verdict.to_owned(),
        None => "rejected".to_owned(),
    }
}

fn witness(ids: &[Value]) -> String {
    ids.iter().map(Value::to_string).collect::<Vec<_>>().join(" ")
}

impl fmt::Display for EdgeTable {
    /// The columns that a terminal has room for.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            out,
            "{:>8} {:>8} {:>8}  {:9} {:>11}  {:15} {:>10} {:>9}  rejected by",
            "edge", "from", "to", "verdict", "probability", "reason", "residual m", "degrees"
        )?;
        let number = |value: Option<f64>, digits: usize| {
            value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
        };
        for row in &self.rows {
            writeln!(
                out,
                "{:>8} {:>8} {:>8}  {:9} {:>11}  {:15} {:>10} {:>9}  {}",
                row.edge,
                row.from,
                row.to,
                row.verdict,
                number(row.probability, 4),
                row.reason.as_deref().unwrap_or("-"),
                number(row.residual_metres, 3),
                number(row.residual_degrees, 2),
                row.rejected_by.as_deref().unwrap_or("-")
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRAPH: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0,"session":"a","frame":0,"pose":[0,0,0]}
{"kind":"node","id":1,"session":"b, \"c\"","frame":7,"pose":[1,0,0]}
{"kind":"node","id":2}
{"kind":"landmark","id":5,"from":0,"to":1,"measurement":[1,2,1.5707963267948966],"information":[1,0,0,4,0,1],"verify_verdict":"undecided","verify_reason":"alone","verify_probability":0.25,"verify_witness":[6,7],"verify_hypothesis":null,"rejected_by":"verify"}
{"kind":"landmark","id":6,"from":1,"to":2,"measurement":[1,0,0],"information":[1,0,0,4,0,1],"truth":{"correct":true}}
{"kind":"landmark","id":7,"from":1,"to":0,"score":0.5,"rejected_by":"pcm"}
"#;

    fn table() -> EdgeTable {
        EdgeTable::of(&PoseGraph::read("test", GRAPH.as_bytes()).unwrap()).unwrap()
    }

    #[test]
    fn rows_hold_verdicts_and_residuals() {
        let EdgeTable { rows } = table();
        assert_eq!((rows[0].verdict.as_str(), rows[0].probability), ("undecided", Some(0.25)));
        assert_eq!(rows[0].witness.as_deref(), Some("6 7"));
        assert!((rows[0].residual_degrees.unwrap() - 90.0).abs() < 1e-9);
        assert!((rows[0].residual_metres.unwrap() - 2.0).abs() < 1e-12);
        // The logarithm of a quarter turn and a translation of 2 m is an arc longer than 2 m.
        assert!(rows[0].chi_square.unwrap() > 4.0);
        // Node 2 has no pose, so nothing is known about the residual.
        assert_eq!((rows[1].verdict.as_str(), rows[1].residual_metres), ("in use", None));
        assert_eq!((rows[1].label_correct, rows[0].label_correct), (Some(true), None));
        assert_eq!((rows[2].verdict.as_str(), rows[2].chi_square), ("rejected", None));
    }

    #[test]
    fn csv_quotes_names_and_has_its_columns_without_rows_too() {
        let mut bytes = Vec::new();
        table().write_csv(&mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        assert!(text.contains(r#"5,0,1,a,0,"b, ""c""",7,undecided,verify,0.25,alone,6 7,,"#), "{text}");
        let mut empty = Vec::new();
        EdgeTable::default().write_csv(&mut empty).unwrap();
        assert_eq!(text.lines().next(), String::from_utf8(empty).unwrap().lines().next());
    }

    #[test]
    fn the_text_has_one_line_for_each_edge() {
        assert_eq!(table().to_string().lines().count(), 4);
    }
}
