//! The files that a run writes.

use std::io::IsTerminal as _;

use anyhow::Context as _;
use posecut_convert::FileFormat;
use posecut_convert::output::{WritingOptions, write};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_inspect::edges::EdgeTable;
use posecut_stage::{Context, counted, write_atomically};

use crate::command::Command;
use crate::page::page_of;
use crate::run::Cleaned;
use crate::summary::Input;

/// Writes the files, the graph last, and says which.
pub(crate) fn write_files(
    command: &Command,
    input: &Input,
    cleaned: &Cleaned,
    graph: &mut PoseGraph,
    format: FileFormat,
    context: &mut Context,
) -> anyhow::Result<String> {
    context.statistics.note("format", format.to_string());
    let rejected = graph.edges_of(EdgeKind::Landmark).filter(|edge| !edge.in_use()).count();
    context.record_provenance(graph, &command.judgement, None)?;
    let mut written = Vec::new();
    if let Some(path) = &command.edges {
        let table = EdgeTable::of(graph)?;
        write_atomically(path, |writer| Ok(table.write_csv(writer)?))?;
        written.push(path.display().to_string());
    }
    if let Some(path) = &command.page {
        let page = page_of(graph, input, cleaned)?;
        write_atomically(path, |writer| Ok(writer.write_all(page.as_bytes())?))?;
        written.push(format!("{} (the page: open it in a browser)", path.display()));
    }
    let marked = format == FileFormat::Jsonl && !command.drop_rejected;
    if !marked {
        graph.drop_rejected();
    }
    let bytes = write(graph, format, &WritingOptions::default(), context)?;
    let rejected = counted(rejected, "rejected landmark edge");
    let how = if marked { "with a mark on" } else { "without" };
    match context.output_path() {
        None if std::io::stdout().is_terminal() => {
            written.push("no graph: name a file with -o, or redirect standard output".to_owned());
        }
        path => {
            let name = path.map_or_else(|| "standard output".to_owned(), |path| path.display().to_string());
            written.push(format!("{name} ({format}, {how} {rejected})"));
            context
                .write_graph_bytes(&bytes)
                .with_context(|| format!("{name}: the graph cannot be written"))?;
        }
    }
    Ok(written.join(", "))
}
