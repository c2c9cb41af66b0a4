//! Simulated sessions in NCLT's layouts, from the files of their sensors to landmark edges.

use std::fs::{self, File};
use std::io::Write as _;

use posecut_geometry::{LieGroup, SE2};
use posecut_graph::PoseGraph;
use posecut_ingest::{Options, SessionFiles, ingest};
use posecut_recognize::Settings;
use posecut_recognize::recognition::{Candidate, recognize};
use posecut_scan::Scans;
use posecut_simulate::{Options as Simulation, Route, simulate};
use tempfile::TempDir;

/// The folder of a session that drives out and the same way back.
pub(super) fn session(hokuyo: Option<f64>, velodyne: Option<f64>) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("2012-01-22");
    fs::create_dir(&path).unwrap();
    let options =
        Simulation { length: Some(300.0), route: Route::Return, hokuyo, velodyne, ..Simulation::DEFAULT };
    let session = simulate("2012-01-22", &options).unwrap();
    for file in &session.files {
        let mut bytes = Vec::new();
        file.write(&mut bytes).unwrap();
        File::create(path.join(&file.name)).unwrap().write_all(&bytes).unwrap();
    }
    session.scanners.write(&path).unwrap();
    folder
}

/// The graph of a session, with its scans.
pub(super) fn graph(folder: &TempDir) -> PoseGraph {
    graph_by(folder, &Options { keep_every: 5, ..Options::DEFAULT })
}

fn graph_by(folder: &TempDir, options: &Options) -> PoseGraph {
    let mut files = SessionFiles::find(&folder.path().join("2012-01-22"), None, None).unwrap();
    let ingested = ingest(&mut files, options, &mut |_| ()).unwrap();
    let mut graph = ingested.graph;
    let scans = ingested.laser.map(|laser| laser.scans).unwrap_or_default();
    graph.unknown = scans.iter().map(|(node, scan)| scan.record(*node).unwrap()).collect();
    graph
}

/// Whether the measurement of a candidate is near the true motion.
pub(super) fn correct(graph: &PoseGraph, candidate: &Candidate) -> bool {
    let truth = |node: usize| {
        SE2::from_components(graph.nodes[node].truth.as_ref().unwrap().pose.as_ref().unwrap()).unwrap()
    };
    let motion = truth(candidate.from).between(&truth(candidate.to));
    let error = candidate.measurement.as_ref().unwrap().pose.between(&motion).log();
    // The ground truth of a session errs by centimetres and by a hundredth of a radian.
    error.x.hypot(error.y) < 0.4 && error.z.abs() < 0.06
}

#[test]
fn the_planar_scanner_recognises_the_way_back() {
    let folder = session(Some(5.0), None);
    let graph = graph(&folder);
    let settings = Settings { radius: 30.0, ..Settings::DEFAULT };
    let found = recognize(&graph, &Scans::of_graph(&graph).unwrap(), None, &settings).unwrap();
    let right = found.candidates.iter().filter(|candidate| correct(&graph, candidate)).count();
    let all = found.candidates.len();
    assert!(right >= 60 && 10 * right >= 9 * all, "{right} of {all} are correct");
}

/// How far the last keyframe is from its true place in the frame of the first, metres.
fn drift(graph: &PoseGraph) -> f64 {
    let at = |node: usize| {
        let node = &graph.nodes[node];
        let truth = node.truth.as_ref().unwrap().pose.as_ref().unwrap();
        (SE2::from_components(node.pose.as_ref().unwrap()).unwrap(), SE2::from_components(truth).unwrap())
    };
    let ((first, true_first), (last, true_last)) = (at(0), at(graph.nodes.len() - 1));
    (first.between(&last).translation - true_first.between(&true_last).translation).norm()
}

#[test]
fn scan_matching_corrects_the_odometry_of_a_session() {
    let folder = session(Some(5.0), None);
    let options = Options {
        keep_every: 5,
        sigma_translation: Some(0.1),
        sigma_rotation: Some(0.02),
        ..Options::DEFAULT
    };
    let odometry = graph_by(&folder, &options);
    let matched = graph_by(&folder, &Options { scan_matching: true, ..options });
    assert_eq!(odometry.nodes.len(), matched.nodes.len());
    let [before, after] = [drift(&odometry), drift(&matched)];
    assert!(before > 1.0 && 5.0 * after < before, "{before} m without, {after} m with scan matching");
}
