//! Reading a file record by record or as a whole.

use std::io::{BufRead, Read};

use crate::content::foreign;
use crate::error::{FormatProblem, Problem};
use crate::parse::{check_unknown, kind_of, parse_edge, parse_header, parse_node, parse_prior};
use crate::validate::Validator;
use crate::{Edge, EdgeKind, Header, Node, PoseGraph, Prior, ReadError, Record};

/// The longest line that is read: 16 MiB. No record of any supported format is longer.
pub const LONGEST_LINE: u64 = 16 << 20;

/// Reads records one by one and checks each by itself and against the header. Errors that concern several records
/// (duplicate ids, dangling edges) are found by [`PoseGraph::read`], which holds all records.
pub struct RecordReader<R> {
    reader: R,
    source_name: String,
    line: u64,
    buffer: Vec<u8>,
    header: Header,
    header_pending: bool,
    /// No record can follow, because the bytes could not be read or a line is too long.
    ended: bool,
    validator: Validator,
}

impl<R: BufRead> RecordReader<R> {
    /// Reads the header line; errors call the file `source_name`.
    pub fn new(source_name: &str, reader: R) -> Result<Self, ReadError> {
        let mut lines = Lines { reader, line: 0 };
        let mut buffer = Vec::new();
        let found = lines.next_into(&mut buffer);
        // For another tool's file the command that converts it helps most, whatever is wrong with the line as JSON Lines.
        if let Some(problem) = foreign(&buffer, source_name) {
            return Err(problem.at(source_name, lines.line));
        }
        let found = found.map_err(|fault| fault.at(source_name, lines.line))?;
        if !found {
            return Err(Problem::new("the file is empty", "a pose graph starts with a header line")
                .at(source_name, 0));
        }
        let fault = |problem: Problem, line| problem.at(source_name, line);
        let text = text(&buffer).map_err(|problem| fault(problem, lines.line))?;
        let kind = kind_of(text).map_err(|problem| fault(problem, lines.line))?;
        if kind != "header" {
            return Err(fault(
                Problem::new(
                    format!("the first record is of kind \"{kind}\""),
                    "a pose graph starts with {\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":…}",
                ),
                lines.line,
            ));
        }
        let header = parse_header(text).map_err(|problem| fault(problem, lines.line))?;
        let validator = Validator::new(&header).map_err(|problem| fault(problem, lines.line))?;
        Ok(Self {
            reader: lines.reader,
            source_name: source_name.to_owned(),
            line: lines.line,
            buffer,
            header,
            header_pending: true,
            ended: false,
            validator,
        })
    }

    /// The header, which [`Self::new`] has read.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The line of the record returned last, counted from 1.
    pub fn line(&self) -> u64 {
        self.line
    }

    fn next_record(&mut self) -> Result<Option<Record>, ReadError> {
        if std::mem::take(&mut self.header_pending) {
            return Ok(Some(Record::Header(self.header.clone())));
        }
        if self.ended {
            return Ok(None);
        }
        let mut lines = Lines { reader: &mut self.reader, line: self.line };
        let found = lines.next_into(&mut self.buffer);
        self.line = lines.line;
        self.ended = found.is_err();
        if !found.map_err(|fault| fault.at(&self.source_name, self.line))? {
            return Ok(None);
        }
        parse_record(&self.buffer, &mut self.validator)
            .map(Some)
            .map_err(|problem| problem.at(&self.source_name, self.line))
    }
}

impl<R: BufRead> Iterator for RecordReader<R> {
    type Item = Result<Record, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_record().transpose()
    }
}

fn parse_record(line: &[u8], validator: &mut Validator) -> Result<Record, Problem> {
    let line = text(line)?;
    match kind_of(line)?.as_ref() {
        "header" => {
            Err(Problem::new("the file has a second header", "remove it; join graphs with posecut-construct"))
        }
        "node" => {
            let node = parse_node(line)?;
            validator.node(&node)?;
            Ok(Record::Node(node))
        }
        "odometry" => edge(line, EdgeKind::Odometry, validator),
        "landmark" => edge(line, EdgeKind::Landmark, validator),
        "prior" => {
            let prior = parse_prior(line)?;
            validator.prior(&prior)?;
            Ok(Record::Prior(prior))
        }
        _ => {
            check_unknown(line)?;
            Ok(Record::Unknown(line.to_owned()))
        }
    }
}

fn edge(line: &str, kind: EdgeKind, validator: &mut Validator) -> Result<Record, Problem> {
    let edge = parse_edge(line, kind)?;
    validator.edge(&edge)?;
    Ok(Record::Edge(edge))
}

fn text(line: &[u8]) -> Result<&str, Problem> {
    std::str::from_utf8(line).map_err(|error| {
        Problem::new(
            format!("byte {} of the line is not UTF-8", error.valid_up_to() + 1),
            "write the file in UTF-8; if it is a compressed file, its first bytes are damaged",
        )
    })
}

struct Lines<R> {
    reader: R,
    line: u64,
}

enum LineFault {
    Io(std::io::Error),
    TooLong,
}

impl LineFault {
    fn at(self, source_name: &str, line: u64) -> ReadError {
        match self {
            Self::Io(error) => ReadError::Io { source_name: source_name.to_owned(), error },
            Self::TooLong => Problem::new(
                format!("the line is longer than {} MiB", LONGEST_LINE >> 20),
                "write one record per line",
            )
            .at(source_name, line),
        }
    }
}

impl<R: BufRead> Lines<R> {
    /// Reads the next line that is not blank, without its end; returns false at the end of the file.
    fn next_into(&mut self, buffer: &mut Vec<u8>) -> Result<bool, LineFault> {
        loop {
            buffer.clear();
            self.line += 1;
            let read =
                (&mut self.reader).take(LONGEST_LINE + 1).read_until(b'\n', buffer).map_err(LineFault::Io)?;
            if read == 0 {
                return Ok(false);
            }
            if read as u64 > LONGEST_LINE {
                return Err(LineFault::TooLong);
            }
            if self.line == 1 && buffer.starts_with(b"\xEF\xBB\xBF") {
                buffer.drain(..3);
            }
            while buffer.last().is_some_and(u8::is_ascii_whitespace) {
                buffer.pop();
            }
            if !buffer.is_empty() {
                return Ok(true);
            }
        }
    }
}

pub(crate) fn read_graph(source_name: &str, reader: impl BufRead) -> Result<PoseGraph, ReadError> {
    let mut records = RecordReader::new(source_name, reader)?;
    let mut graph = PoseGraph::new(records.header().clone());
    let mut lines = RecordLines::default();
    while let Some(record) = records.next_record()? {
        add(&mut graph, &mut lines, record, records.line());
    }
    lines.sort_with(&mut graph);
    let first = relations(&graph, &lines).next();
    match first {
        Some((problem, line)) => Err(problem.at(source_name, line)),
        None => Ok(graph),
    }
}

/// All errors of a file, and its valid records.
#[derive(Debug)]
pub struct Examination {
    /// The records that are valid by themselves, sorted by id; `None` if the header is not valid.
    pub graph: Option<PoseGraph>,
    /// The line of each node, in the order of the graph.
    pub node_lines: Vec<u64>,
    /// The line of each edge, in the order of the graph.
    pub edge_lines: Vec<u64>,
    /// The line of each prior, in the order of the graph.
    pub prior_lines: Vec<u64>,
    /// The errors in the order of lines, then those that concern several records.
    pub faults: Vec<FormatProblem>,
}

/// Reads on after errors in the file and lists them: one for each record, then all duplicate ids and all edges and priors of
/// missing nodes. Fails only if the bytes cannot be read. After a line that is too long, the rest is not examined.
pub fn examine(source_name: &str, reader: impl BufRead) -> Result<Examination, ReadError> {
    let mut examination = Examination {
        graph: None,
        node_lines: Vec::new(),
        edge_lines: Vec::new(),
        prior_lines: Vec::new(),
        faults: Vec::new(),
    };
    let mut records = match RecordReader::new(source_name, reader) {
        Ok(records) => records,
        Err(ReadError::Format(problem)) => {
            examination.faults.push(*problem);
            return Ok(examination);
        }
        Err(error) => return Err(error),
    };
    let mut graph = PoseGraph::new(records.header().clone());
    let mut lines = RecordLines::default();
    while let Some(record) = records.next() {
        match record {
            Ok(record) => add(&mut graph, &mut lines, record, records.line()),
            Err(ReadError::Format(problem)) => examination.faults.push(*problem),
            Err(error) => return Err(error),
        }
    }
    lines.sort_with(&mut graph);
    for (problem, line) in relations(&graph, &lines) {
        examination.faults.push(problem.placed(source_name, line));
    }
    examination.node_lines = lines.nodes;
    examination.edge_lines = lines.edges;
    examination.prior_lines = lines.priors;
    examination.graph = Some(graph);
    Ok(examination)
}

/// The line of each record, in the order of the graph.
#[derive(Default)]
struct RecordLines {
    nodes: Vec<u64>,
    edges: Vec<u64>,
    priors: Vec<u64>,
}

impl RecordLines {
    fn sort_with(&mut self, graph: &mut PoseGraph) {
        self.nodes = sort_with_lines(&mut graph.nodes, std::mem::take(&mut self.nodes), |node| node.id);
        self.edges = sort_with_lines(&mut graph.edges, std::mem::take(&mut self.edges), |edge| edge.id);
        self.priors = sort_with_lines(&mut graph.priors, std::mem::take(&mut self.priors), |prior| prior.id);
    }
}

fn add(graph: &mut PoseGraph, lines: &mut RecordLines, record: Record, line: u64) {
    match record {
        Record::Header(_) => {}
        Record::Node(node) => {
            graph.nodes.push(node);
            lines.nodes.push(line);
        }
        Record::Edge(edge) => {
            graph.edges.push(edge);
            lines.edges.push(line);
        }
        Record::Prior(prior) => {
            graph.priors.push(prior);
            lines.priors.push(line);
        }
        Record::Unknown(line) => graph.unknown.push(line),
    }
}

/// The errors between records, each with its line.
fn relations<'a>(graph: &'a PoseGraph, lines: &'a RecordLines) -> impl Iterator<Item = (Problem, u64)> + 'a {
    let remedy = "ids must be unique among nodes, and among edges of all kinds; renumber them";
    let node_name = |node: &Node| format!("node {}", node.id);
    let nodes = duplicates(&graph.nodes, &lines.nodes, |node| node.id, node_name, remedy);
    let edges = duplicates(&graph.edges, &lines.edges, |edge| edge.id, Edge::name, remedy);
    let remedy = "ids must be unique among priors; renumber them";
    let priors = duplicates(&graph.priors, &lines.priors, |prior| prior.id, Prior::name, remedy);
    nodes
        .chain(edges)
        .chain(priors)
        .chain(dangling(graph, &lines.edges))
        .chain(unattached(graph, &lines.priors))
}

/// Sorts records by id together with their line numbers. Records that are sorted already stay untouched.
fn sort_with_lines<T>(records: &mut Vec<T>, lines: Vec<u64>, id: impl Fn(&T) -> u64) -> Vec<u64> {
    if records.is_sorted_by_key(&id) {
        return lines;
    }
    let mut pairs: Vec<(T, u64)> = std::mem::take(records).into_iter().zip(lines).collect();
    pairs.sort_by_key(|(record, _)| id(record));
    let (sorted, lines) = pairs.into_iter().unzip();
    *records = sorted;
    lines
}

fn duplicates<'a, T>(
    records: &'a [T],
    lines: &'a [u64],
    id: impl Fn(&T) -> u64 + 'a,
    name: impl Fn(&T) -> String + 'a,
    remedy: &'a str,
) -> impl Iterator<Item = (Problem, u64)> + 'a {
    let again = move |(pair, _): &(&[T], &[u64])| id(&pair[0]) == id(&pair[1]);
    records.windows(2).zip(lines.windows(2)).filter(again).map(move |(pair, lines)| {
        let problem =
            Problem::new(format!("line {} ({}) already has this id", lines[0], name(&pair[0])), remedy);
        (problem.record(name(&pair[1])).field("id"), lines[1])
    })
}

fn dangling<'a>(graph: &'a PoseGraph, lines: &'a [u64]) -> impl Iterator<Item = (Problem, u64)> + 'a {
    graph.edges.iter().zip(lines).flat_map(move |(edge, &line)| {
        let ends = [("from", edge.from), ("to", edge.to)];
        ends.into_iter().filter(|(_, id)| graph.node_index(*id).is_none()).map(move |(field, id)| {
            let problem = Problem::new(
                format!("there is no node {id} in the file"),
                "add the node, or remove the edge",
            );
            (problem.record(edge.name()).field(field), line)
        })
    })
}

/// Priors of missing nodes.
fn unattached<'a>(graph: &'a PoseGraph, lines: &'a [u64]) -> impl Iterator<Item = (Problem, u64)> + 'a {
    let missing = graph.priors.iter().zip(lines).filter(|(prior, _)| graph.node_index(prior.node).is_none());
    missing.map(|(prior, &line)| {
        let problem = Problem::new(
            format!("there is no node {} in the file", prior.node),
            "add the node, or remove the prior",
        );
        (problem.record(prior.name()).field("node"), line)
    })
}
