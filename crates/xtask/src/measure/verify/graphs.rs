//! The graphs on which posecut-verify is measured.

use std::path::{Path, PathBuf};
use std::process::Command;

use xtask::workspace::{program, programs_folder};

use crate::process::{must, visibly};

/// Number of candidates of five whole NCLT sessions.
pub(super) const FIVE_SESSIONS: u64 = 41_142;

/// Names and files of the graphs with this many candidates.
pub(super) fn graphs(size: u64, nclt: &Path, folder: &Path) -> anyhow::Result<Vec<(String, PathBuf)>> {
    if size == FIVE_SESSIONS
        && let Some(sessions) = five(nclt)
    {
        let path = folder.join("five.jsonl");
        together(&sessions, folder, &path)?;
        return Ok(vec![("five NCLT sessions, 10 % uniform".to_owned(), path)]);
    }
    let drawn = ["uniform", "grouped"].map(|kind| {
        let path = folder.join(format!("{size}.{kind}.jsonl"));
        let mut draw = Command::new(programs_folder().join("examples/draw"));
        // The example writes to the file itself. Memory of this process would count towards the measured ones.
        draw.args([&*size.to_string(), "0.3", kind, "2", "1"]).stdout(std::fs::File::create(&path)?);
        visibly(&mut draw)?;
        Ok((format!("drawn, 30 % {kind}"), path))
    });
    drawn.into_iter().collect()
}

/// The first five sessions by date.
fn five(nclt: &Path) -> Option<Vec<PathBuf>> {
    let session = |path: &PathBuf| {
        path.is_dir() && path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("20"))
    };
    let mut sessions: Vec<PathBuf> =
        nclt.read_dir().ok()?.flatten().map(|entry| entry.path()).filter(session).collect();
    sessions.sort();
    sessions.truncate(5);
    (sessions.len() == 5).then_some(sessions)
}

/// Joins whole sessions, with correct edges within 3 m and a tenth of all edges false.
fn together(sessions: &[PathBuf], folder: &Path, path: &Path) -> anyhow::Result<()> {
    let mut graphs = Vec::new();
    for session in sessions {
        let name = session.file_name().unwrap_or_default().to_string_lossy();
        let graph = folder.join(format!("{name}.jsonl"));
        must(Command::new(program("ingest")).arg("-q").arg(session).arg("-o").arg(&graph))?;
        graphs.push(graph);
    }
    let mut construct = Command::new(program("construct"));
    construct.arg("-q").args(graphs).args(["--split", "none", "--radius", "3", "--incorrect-rate", "0.1"]);
    must(construct.args(["--incorrect-distance", "10", "--seed", "1", "-o"]).arg(path))?;
    Ok(())
}
