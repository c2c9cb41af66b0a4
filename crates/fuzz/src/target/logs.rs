//! Logs of laser scans, and files of relations.

use posecut_carmen::{Log, LogOptions, Session, trajectory, write_trajectory};
use posecut_evaluate::relations::{Track, relation_errors, relations};
use posecut_graph::PoseGraph;
use posecut_map::Grid;
use posecut_scan::Scans;

use super::{Outcome, readers};

/// Reads a log with scan matching and draws its map. The graph and the scans must be those that are read again.
pub(super) fn log(input: &[u8]) -> Outcome {
    let options = LogOptions { scan_matching: true, ..LogOptions::DEFAULT };
    let content = match posecut_carmen::expanded(input.to_vec()) {
        Ok(content) => content,
        Err(error) => return Outcome::refused(error),
    };
    let session = Log::read("input", &content[..], &options).and_then(|log| {
        let session = Session::of_log("input", "a", &log, &options)?;
        let poses = trajectory(&log, &session, &options);
        assert_eq!(poses.len(), log.scans.len(), "a pose for each scan");
        Ok((session, poses))
    });
    let (mut session, poses) = match session {
        Ok(session) => session,
        Err(error) => return Outcome::refused(error),
    };
    session.put_scans_into_graph().expect("scans of a log are finite");
    let mut bytes = Vec::new();
    if let Err(error) = session.graph.write(&mut bytes) {
        return Outcome::refused(error);
    }
    let graph = PoseGraph::read("written", bytes.as_slice()).expect("a written graph is read");
    let scans = Scans::of_graph(&graph).expect("the scans of a written graph are read");
    assert_eq!(scans.len(), session.scans.len(), "a scan for each node");
    let mut tum = Vec::new();
    write_trajectory(&poses, &mut tum).expect("memory takes it");
    let drawn = Grid::of_graph(&graph, &scans, 1.0, 50.0).is_ok();
    match readers::jsonl(&bytes) {
        Outcome::Read(_) => Outcome::Read(format!("{} keyframes, map: {drawn}", scans.len().min(3))),
        Outcome::Refused(error) => panic!("a written graph is refused: {error}"),
    }
}

/// Reads relations and a trajectory, and compares a graph with them.
pub(super) fn relative(input: &[u8]) -> Outcome {
    let track = Track::read("input", input).ok();
    match relations("input", input) {
        Ok(known) => {
            let graph =
                PoseGraph::read("seed", crate::seeds::graphs()[0].as_slice()).expect("a seed is sound");
            let errors = relation_errors(&graph, &known, track.as_ref(), 1e9);
            assert_eq!(errors.compared + errors.skipped, known.len(), "each relation is compared or skipped");
            Outcome::Read(format!("{} relations", known.len().min(3)))
        }
        Err(_) if track.is_some() => Outcome::Read("a trajectory".to_owned()),
        Err(error) => Outcome::refused(error),
    }
}
