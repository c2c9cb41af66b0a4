//! Files of laser scanners.

use posecut_geometry::SE2;
use posecut_nclt_sensors::Hokuyo;
use posecut_nclt_sensors::velodyne::{read_hits, write_hits};
use posecut_recognize::places::Context as _;
use posecut_recognize::scan_context::ContextOptions;
use posecut_recognize::spatial::SpatialScan;

use super::Outcome;

/// Reads a file of planar scans. Times must ascend, and ranges be those that the scanner has.
pub(super) fn hokuyo(input: &[u8]) -> Outcome {
    let file = match Hokuyo::parse("input", input) {
        Ok(file) => file,
        Err(error) => return Outcome::refused(error),
    };
    assert!(!file.is_empty(), "an accepted file has scans");
    for index in 0..file.len() {
        assert!(index == 0 || file.time(index - 1) < file.time(index), "times ascend");
        let scan = file.scan(index, &SE2::new(0.0, 0.0, 0.0));
        assert!(scan.record(0).is_ok() && scan.ranges.iter().all(|range| (0.0..30.0).contains(range)));
        assert_eq!(file.nearest(file.time(index), 0), Some(index), "a scan is the nearest to its own time");
    }
    Outcome::Read(format!("{} scans", file.len().min(3)))
}

/// Reads the hits of a turn and describes them. What is written must be what was read.
pub(super) fn velodyne(input: &[u8]) -> Outcome {
    let hits = match read_hits("input", input) {
        Ok(hits) => hits,
        Err(error) => return Outcome::refused(error),
    };
    let mut written = Vec::new();
    write_hits(&hits, &mut written).expect("memory takes it");
    assert_eq!(written, input, "hits survive");
    let scan = SpatialScan::new(&hits, &ContextOptions::DEFAULT);
    let same = scan.context.similarities(&scan.context)[0];
    assert!(same.is_finite() && same < 1.0 + 1e-4, "a similarity is at most 1: {same}");
    Outcome::Read(format!("{} hits, context: {}", hits.len().min(3), !scan.context.is_empty()))
}
