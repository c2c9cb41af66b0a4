//! Reading and writing files.

use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::Args;
use posecut_convert::FileFormat;
use posecut_convert::input::{Reading, ReadingOptions};
use posecut_convert::output::WritingOptions;
use posecut_graph::PoseGraph;
use posecut_stage::{Source, write_atomically};
use pyo3::prelude::*;

use crate::error::parse;
use crate::graph::{Graph, Said, said};
use crate::messages::{Messages, collected};
use crate::stages::conversion;
use crate::work;

/// Reads one graph from one or several files. Returns the graph, its doubts and its messages.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, paths: Vec<PathBuf>, words: Vec<String>) -> PyResult<(Graph, Said)> {
    let read = work::run(py, move || {
        let options: ReadingOptions = parse("convert", &words)?;
        let inputs: Vec<Source> = paths.into_iter().map(Source::File).collect();
        let mut context = conversion();
        let (reading, messages) = collected(|| posecut_convert::input::read(&inputs, &options, &mut context));
        let Reading { mut graph, format, .. } = reading?;
        // As read, a graph of JSON Lines is the file's content; any other came about by a conversion, which the graph records.
        let as_read = format == FileFormat::Jsonl && inputs.len() == 1 && words.is_empty();
        let digest = context.inputs.first().map(|input| input.sha256.clone()).filter(|_| as_read);
        if !as_read {
            context.record_provenance(&mut graph, &options, None)?;
        }
        let doubts = context.doubts();
        let statistics = serde_json::to_string(context.statistics.as_map())?;
        Ok((Graph::new(graph, digest), said(statistics, doubts, messages)))
    })?;
    Ok(read)
}

/// Reads a graph from the bytes of pose-graph JSON Lines.
#[pyfunction]
pub(crate) fn from_bytes(py: Python<'_>, bytes: Vec<u8>, name: String) -> PyResult<Graph> {
    work::run(py, move || {
        let graph = PoseGraph::read(&name, bytes.as_slice())?;
        Ok(Graph::new(graph, Some(posecut_stage::digest(&bytes))))
    })
}

/// How a graph is written.
#[derive(Clone, Debug, Args)]
struct Writing {
    /// Write this format
    #[arg(long, value_enum)]
    to: Option<FileFormat>,

    #[command(flatten)]
    options: WritingOptions,
}

/// The content of a file with this graph.
fn content(
    graph: &PoseGraph,
    by_name: Option<FileFormat>,
    words: &[String],
) -> anyhow::Result<Option<(Vec<u8>, Messages)>> {
    let writing: Writing = parse("convert", words)?;
    let Some(format) = writing.to.or(by_name) else { return Ok(None) };
    let mut context = conversion();
    let (bytes, messages) =
        collected(|| posecut_convert::output::write(graph, format, &writing.options, &mut context));
    Ok(Some((bytes?, messages)))
}

/// Writes a graph to a file, which appears completely or not at all.
pub(crate) fn write(graph: &PoseGraph, path: &std::path::Path, words: &[String]) -> anyhow::Result<Messages> {
    let name = path.display();
    let Some((bytes, messages)) = content(graph, FileFormat::of_name(path), words)? else {
        bail!(
            "{name}: the name does not determine the format; set to to jsonl, g2o, toro, jrl, tum or kitti"
        );
    };
    write_atomically(path, |writer| writer.write_all(&bytes).context("the bytes cannot be written"))?;
    Ok(messages)
}

/// The bytes of a file with this graph, JSON Lines unless the words say otherwise.
pub(crate) fn bytes(graph: &PoseGraph, words: &[String]) -> anyhow::Result<(Vec<u8>, Messages)> {
    Ok(content(graph, Some(FileFormat::Jsonl), words)?.unwrap_or_default())
}
