//! Writes the canonical form: known fields in a fixed order, then unknown fields; numbers in their shortest exact notation.

use std::io::Write;

use serde::Serialize;
use serde_json::Value;

use crate::{Edge, EdgeTruth, FORMAT, Header, Node, PoseGraph, Prior, VERSION, WriteError};

/// The number of bytes to collect before a write.
const CHUNK: usize = 1 << 16;

pub(crate) fn write_graph(graph: &PoseGraph, mut writer: impl Write) -> Result<(), WriteError> {
    for node in &graph.nodes {
        check_node(node)?;
    }
    for edge in &graph.edges {
        check_edge(edge)?;
    }
    for prior in &graph.priors {
        check_prior(prior)?;
    }
    let mut line = Line { bytes: Vec::with_capacity(2 * CHUNK) };
    line.header(&graph.header)?;
    for index in order(&graph.nodes, |node| node.id) {
        line.node(&graph.nodes[index])?;
        line.flush_if_full(&mut writer)?;
    }
    for index in order(&graph.edges, |edge| edge.id) {
        line.edge(&graph.edges[index])?;
        line.flush_if_full(&mut writer)?;
    }
    for index in order(&graph.priors, |prior| prior.id) {
        line.prior(&graph.priors[index])?;
        line.flush_if_full(&mut writer)?;
    }
    for unknown in &graph.unknown {
        line.bytes.extend_from_slice(unknown.as_bytes());
        line.bytes.push(b'\n');
        line.flush_if_full(&mut writer)?;
    }
    writer.write_all(&line.bytes)?;
    writer.flush()?;
    Ok(())
}

fn order<T>(records: &[T], id: impl Fn(&T) -> u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..records.len()).collect();
    order.sort_by_key(|&index| id(&records[index]));
    order
}

fn check_node(node: &Node) -> Result<(), WriteError> {
    let truth = node.truth.as_ref().and_then(|truth| truth.pose.as_ref());
    for (field, values) in [("pose", node.pose.as_ref()), ("truth.pose", truth)] {
        check(values.map_or(&[][..], Vec::as_slice), field, || format!("node {}", node.id))?;
    }
    Ok(())
}

fn check_edge(edge: &Edge) -> Result<(), WriteError> {
    for (field, values) in [("measurement", &edge.measurement), ("information", &edge.information)] {
        check(values.as_deref().unwrap_or_default(), field, || edge.name())?;
    }
    for (field, value) in [("cost", edge.cost), ("score", edge.score)] {
        check(value.as_slice(), field, || edge.name())?;
    }
    Ok(())
}

fn check_prior(prior: &Prior) -> Result<(), WriteError> {
    check(&prior.measurement, "measurement", || prior.name())?;
    check(prior.information.as_deref().unwrap_or_default(), "information", || prior.name())?;
    check(prior.score.as_slice(), "score", || prior.name())
}

fn check(values: &[f64], field: &'static str, record: impl Fn() -> String) -> Result<(), WriteError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(WriteError::NotFinite { record: record(), field, value }),
        None => Ok(()),
    }
}

struct Line {
    bytes: Vec<u8>,
}

impl Line {
    fn flush_if_full(&mut self, writer: &mut impl Write) -> std::io::Result<()> {
        if self.bytes.len() >= CHUNK {
            writer.write_all(&self.bytes)?;
            self.bytes.clear();
        }
        Ok(())
    }

    fn header(&mut self, header: &Header) -> Result<(), WriteError> {
        self.open("header");
        self.field("format", FORMAT)?;
        self.field("version", &VERSION)?;
        self.field("dimension", &header.dimension.number())?;
        if !header.noise_models.is_empty() {
            self.key("noise_models");
            self.bytes.push(b'{');
            for (place, (name, model)) in header.noise_models.iter().enumerate() {
                if place > 0 {
                    self.bytes.push(b',');
                }
                self.value(name)?;
                self.bytes.extend_from_slice(b":{\"information\":");
                self.numbers(&model.information)?;
                self.extra(&model.extra)?;
                self.bytes.push(b'}');
            }
            self.bytes.push(b'}');
        }
        if !header.provenance.is_empty() {
            self.field("provenance", &header.provenance)?;
        }
        self.extra(&header.extra)?;
        self.close();
        Ok(())
    }

    fn node(&mut self, node: &Node) -> Result<(), WriteError> {
        self.open("node");
        self.field("id", &node.id)?;
        self.optional("session", node.session.as_ref())?;
        self.optional("frame", node.frame.as_ref())?;
        self.optional("utime", node.utime.as_ref())?;
        self.optional_numbers("pose", node.pose.as_ref())?;
        self.optional("landmark", node.landmark.as_ref())?;
        if let Some(truth) = &node.truth {
            self.key("truth");
            self.bytes.push(b'{');
            let start = self.bytes.len();
            self.optional_numbers("pose", truth.pose.as_ref())?;
            self.extra(&truth.extra)?;
            self.drop_leading_comma(start);
            self.bytes.push(b'}');
        }
        self.extra(&node.extra)?;
        self.close();
        Ok(())
    }

    fn edge(&mut self, edge: &Edge) -> Result<(), WriteError> {
        self.open(edge.kind.name());
        self.field("id", &edge.id)?;
        self.field("from", &edge.from)?;
        self.field("to", &edge.to)?;
        self.optional_numbers("measurement", edge.measurement.as_ref())?;
        self.optional_numbers("information", edge.information.as_ref())?;
        self.optional("noise", edge.noise.as_ref())?;
        self.edge_truth(edge.truth.as_ref())?;
        self.optional("rejected_by", edge.rejected_by.as_ref())?;
        for (name, value) in [("cost", edge.cost), ("score", edge.score)] {
            if let Some(value) = value {
                self.key(name);
                self.number(value)?;
            }
        }
        self.extra(&edge.extra)?;
        self.close();
        Ok(())
    }

    fn prior(&mut self, prior: &Prior) -> Result<(), WriteError> {
        self.open("prior");
        self.field("id", &prior.id)?;
        self.field("node", &prior.node)?;
        self.key("measurement");
        self.numbers(&prior.measurement)?;
        self.optional_numbers("information", prior.information.as_ref())?;
        self.optional("noise", prior.noise.as_ref())?;
        self.optional("source", prior.source.as_ref())?;
        self.edge_truth(prior.truth.as_ref())?;
        self.optional("rejected_by", prior.rejected_by.as_ref())?;
        if let Some(score) = prior.score {
            self.key("score");
            self.number(score)?;
        }
        self.extra(&prior.extra)?;
        self.close();
        Ok(())
    }

    /// The truth about an edge or a prior.
    fn edge_truth(&mut self, truth: Option<&EdgeTruth>) -> Result<(), WriteError> {
        let Some(truth) = truth else { return Ok(()) };
        self.key("truth");
        self.bytes.push(b'{');
        let start = self.bytes.len();
        self.optional("correct", truth.correct.as_ref())?;
        self.extra(&truth.extra)?;
        self.drop_leading_comma(start);
        self.bytes.push(b'}');
        Ok(())
    }

    fn open(&mut self, kind: &str) {
        self.bytes.extend_from_slice(b"{\"kind\":\"");
        self.bytes.extend_from_slice(kind.as_bytes());
        self.bytes.push(b'"');
    }

    fn close(&mut self) {
        self.bytes.extend_from_slice(b"}\n");
    }

    fn key(&mut self, name: &str) {
        self.bytes.extend_from_slice(b",\"");
        self.bytes.extend_from_slice(name.as_bytes());
        self.bytes.extend_from_slice(b"\":");
    }

    /// Removes the comma before the first field of a nested object: every key writes a comma before itself.
    fn drop_leading_comma(&mut self, start: usize) {
        if self.bytes.get(start) == Some(&b',') {
            self.bytes.remove(start);
        }
    }

    fn field<T: Serialize + ?Sized>(&mut self, name: &str, value: &T) -> Result<(), WriteError> {
        self.key(name);
        self.value(value)
    }

    fn optional<T: Serialize>(&mut self, name: &str, value: Option<&T>) -> Result<(), WriteError> {
        value.map_or(Ok(()), |value| self.field(name, value))
    }

    fn optional_numbers(&mut self, name: &str, values: Option<&Vec<f64>>) -> Result<(), WriteError> {
        let Some(values) = values else { return Ok(()) };
        self.key(name);
        self.numbers(values)
    }

    fn numbers(&mut self, values: &[f64]) -> Result<(), WriteError> {
        self.bytes.push(b'[');
        for (place, &value) in values.iter().enumerate() {
            if place > 0 {
                self.bytes.push(b',');
            }
            self.number(value)?;
        }
        self.bytes.push(b']');
        Ok(())
    }

    /// Writes a whole number without a fraction (information matrices are mostly zeros) and any other in the shortest notation
    /// that reads back to the same bits.
    fn number(&mut self, value: f64) -> Result<(), WriteError> {
        const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;
        let whole = value.trunc() == value
            && value.abs() < LARGEST_WHOLE
            && !(value == 0.0 && value.is_sign_negative());
        if whole { self.value(&(value as i64)) } else { self.value(&value) }
    }

    fn extra(&mut self, extra: &crate::Extra) -> Result<(), WriteError> {
        for (name, value) in extra {
            self.bytes.push(b',');
            self.value(name)?;
            self.bytes.push(b':');
            self.value::<Value>(value)?;
        }
        Ok(())
    }

    fn value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), WriteError> {
        serde_json::to_writer(&mut self.bytes, value).map_err(|error| WriteError::Io(error.into()))
    }
}
