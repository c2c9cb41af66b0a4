//! GPS of a session as priors.

use std::fs;
use std::path::Path;

use posecut_ingest::{GpsSource, Options};

use super::{TENTH, circle, options, run, session, time};

/// GPS around the circle: fixes twice a second, 0.05 s after a tenth, without altitude at first, and none for a while.
fn add_gps(path: &Path, file: &str) {
    let mut text = String::new();
    for tenth in (0..600).step_by(5) {
        let [x, y, ..] = circle(tenth);
        let [latitude, longitude, _] = posecut_geometry::geodetic::from_local([x + 3.0, y - 4.0, 0.0]);
        let time = time(tenth) + TENTH / 2;
        text += &match tenth {
            0..100 => format!("{time},2,4,{latitude},{longitude},NaN,0,1\n"),
            200..300 => format!("{time},1,2,NaN,NaN,NaN,NaN,NaN\n"),
            300..320 => format!("{time},0,0,0,0,0,0,0\n"),
            _ => format!("{time},3,8,{latitude},{longitude},270,0,1\n"),
        };
    }
    fs::write(path.join(file), text).unwrap();
}

#[test]
fn gps_becomes_priors_in_the_frame_of_the_truth() {
    let (_folder, path) = session();
    add_gps(&path, "gps.csv");
    let without = run(&path, &options()).unwrap().graph;
    assert!(without.priors.is_empty());
    let ask = |options: Options| run(&path, &Options { gps: Some(GpsSource::Gps), ..options }).unwrap().graph;
    let graph = ask(options());
    assert_eq!((&graph.nodes, &graph.edges), (&without.nodes, &without.edges), "only priors are new");
    // Keyframes at 0, 2, …, 60 s; from 20 to 32 s there is no fix. Those at 20 and 60 s have one 0.45 s before.
    let nodes: Vec<u64> = graph.priors.iter().map(|prior| prior.node).collect();
    assert_eq!(nodes, (0..=10).chain(16..=30).collect::<Vec<u64>>());
    for prior in &graph.priors {
        let truth = graph.nodes[prior.node as usize].truth.as_ref().unwrap().pose.clone().unwrap();
        let off = [prior.measurement[0] - truth[0] - 3.0, prior.measurement[1] - truth[1] + 4.0];
        let apart = if matches!(prior.node, 10 | 30) { 0.51 } else { 1e-6 };
        assert!(
            off.iter().all(|off| off.abs() < apart),
            "the position of the fix, 0.5 s earlier or the same: {off:?}"
        );
        let sigma = if prior.node < 5 { 15.0 } else { 5.0 };
        let weight: f64 = 1.0 / (sigma * sigma);
        assert_eq!(prior.information.as_deref(), Some(&[weight, 0.0, weight][..]), "{}", prior.node);
        assert_eq!(prior.source.as_deref(), Some("gps"));
    }
    let set = ask(Options { sigma_gps: Some(2.0), ..options() });
    assert_eq!(set.priors[7].information.as_deref(), Some(&[0.25, 0.0, 0.25][..]));
    let spatial = ask(Options { dimension: 3, ..options() });
    assert_eq!(spatial.priors[7].measurement.len(), 3);
    assert_eq!(spatial.priors[7].information.as_ref().unwrap()[5], 0.0, "no weight for the altitude");
    let refused = run(&path, &Options { gps: Some(GpsSource::Both), ..options() }).err().unwrap().to_string();
    assert!(refused.contains("there is no gps_rtk.csv") && refused.contains("--gps"), "{refused}");
    add_gps(&path, "gps_rtk.csv");
    let both = run(&path, &Options { gps: Some(GpsSource::Both), ..options() }).unwrap().graph;
    assert_eq!(both.priors.len(), 2 * graph.priors.len());
    assert_eq!(both.priors[both.priors.len() - 1].source.as_deref(), Some("gps_rtk"));
    fs::write(path.join("gps.csv"), "1,3,8,inf,0\n").unwrap();
    let refused = run(&path, &Options { gps: Some(GpsSource::Gps), ..options() }).err().unwrap().to_string();
    assert!(refused.contains("gps.csv, line 1: column 4 is infinite"), "{refused}");
}
