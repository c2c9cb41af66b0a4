//! NEES of the odometry by window length.

use std::path::Path;
use std::process::Command;

use anyhow::Context as _;
use serde::Deserialize;
use xtask::workspace::program;

use crate::markdown;
use crate::process::must;

/// The reference covariance of the maps' axes: metres and radians a keyframe step.
const SIGMAS: [&str; 4] = ["--sigma-translation", "0.1", "--sigma-rotation", "0.016666666666666666"];

#[derive(Deserialize)]
struct Statistics {
    odometry: String,
    nees: Vec<Window>,
}

#[derive(Deserialize)]
struct Window {
    steps: u64,
    per_degree_of_freedom: f64,
}

pub(super) fn table(nclt: &Path, sessions: &[&str]) -> anyhow::Result<String> {
    let mut found = Vec::new();
    for session in sessions {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("statistics.json");
        let mut ingest = Command::new(program("ingest"));
        ingest.arg("--quiet").arg(nclt.join(session)).args(SIGMAS);
        must(ingest.args(["-o", "/dev/null", "--stats"]).arg(&path))?;
        let text = std::fs::read_to_string(&path)?;
        let statistics: Statistics =
            serde_json::from_str(&text).context("posecut-ingest --stats has no NEES")?;
        found.push((*session, statistics));
    }
    Ok(lines(&found).join("\n"))
}

fn lines(found: &[(&str, Statistics)]) -> Vec<String> {
    let mut head = markdown::cells(&["session", "odometry"]);
    if let Some((_, last)) = found.last() {
        let named = |window: &Window| match window.steps {
            1 => "1 step".to_owned(),
            steps => format!("{steps} steps"),
        };
        head.extend(last.nees.iter().map(named));
    }
    let row = |(session, statistics): &(&str, Statistics)| {
        let mut row = vec![(*session).to_owned(), statistics.odometry.clone()];
        row.extend(statistics.nees.iter().map(|window| format!("{:.2}", window.per_degree_of_freedom)));
        row
    };
    markdown::table(&head, 1, &found.iter().map(row).collect::<Vec<_>>())
}
