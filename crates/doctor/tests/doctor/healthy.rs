//! Graphs without faults: nothing may be said against them.

use std::fs::File;
use std::io::BufWriter;

use posecut_construct::{Landmarks, construct};
use posecut_doctor::{Severity, examine, text};
use posecut_ingest::{SessionFiles, ingest};
use posecut_simulate::simulate;

use crate::drives::{plane, space, split};
use crate::problems;

#[test]
fn drives_have_no_problems() {
    for graph in [plane(), space(), split(plane()), split(space())] {
        assert_eq!(problems(&graph), [""; 0]);
    }
}

/// What posecut-simulate, -ingest and -construct make without options.
#[test]
fn a_simulated_graph_has_no_problems_and_a_short_report() {
    let folder = tempfile::tempdir().unwrap();
    let session = simulate("2012-01-22", &posecut_simulate::Options::default()).unwrap();
    for file in &session.files {
        let mut writer = BufWriter::new(File::create(folder.path().join(&file.name)).unwrap());
        file.write(&mut writer).unwrap();
    }
    let mut files = SessionFiles::find(folder.path(), None, None).unwrap();
    let ingested = ingest(&mut files, &posecut_ingest::Options::default(), &mut |_| {}).unwrap();
    let options = posecut_construct::Options::default();
    let graph = construct(vec![ingested.graph], &Landmarks::Truth, &options).unwrap().graph;
    let findings = examine(&graph);
    let problems: Vec<_> = findings.iter().filter(|finding| finding.severity != Severity::Note).collect();
    assert!(problems.is_empty(), "{problems:#?}");
    let report = text::report(&graph, &findings);
    assert!(report.lines().count() <= 25, "{report}");
}

#[test]
fn the_same_graph_gives_the_same_findings() {
    let graph = split(plane());
    assert_eq!(examine(&graph), examine(&graph));
}
