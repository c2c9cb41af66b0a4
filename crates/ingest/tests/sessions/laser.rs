//! Sessions with `hokuyo_30m.bin`.

use std::fs;

use posecut_geometry::{LieGroup, SE2};
use posecut_ingest::{Event, SessionFiles, Warning, ingest};
use posecut_nclt_sensors::hokuyo::{ANGLE_STEP, BEAMS, FIRST_ANGLE, FORWARD};
use posecut_nclt_sensors::write_hokuyo_scan;

use super::{circle, options, pose, run, session, time};

/// A thin post, x north and y east, metres, inside of the circle.
const POST: [f64; 2] = [2.0, 12.0];

/// A scan at a time, of which only the beams next to the post have a return.
fn scan(tenth: i64) -> Vec<u8> {
    let [x, y, .., yaw] = circle(tenth);
    let scanner = SE2::new(x, y, yaw).compose(&SE2::new(FORWARD, 0.0, 0.0));
    let post = scanner.inverse().compose(&SE2::new(POST[0], POST[1], 0.0)).translation;
    // y is to the right, beams turn to the left.
    let beam = ((-post.y).atan2(post.x) - FIRST_ANGLE) / ANGLE_STEP;
    let mut ranges = vec![0.0; BEAMS];
    if let Some(range) = ranges.get_mut(beam.round() as usize) {
        *range = post.norm();
    }
    let mut bytes = Vec::new();
    write_hokuyo_scan(time(tenth).try_into().unwrap(), &ranges, &mut bytes).unwrap();
    bytes
}

fn scans(tenths: impl IntoIterator<Item = i64>) -> Vec<u8> {
    tenths.into_iter().flat_map(scan).collect()
}

#[test]
fn scans_beside_a_keyframe_see_a_post_where_it_is() {
    let (_folder, path) = session();
    // Keyframes are at multiples of 20: scans come a tenth of a second later, in which the robot moves by 0.1 m.
    fs::write(path.join("hokuyo_30m.bin"), scans((1..600).step_by(5))).unwrap();
    let ingested = run(&path, &options()).unwrap();
    let laser = ingested.laser.unwrap();
    assert_eq!((laser.scans.len(), laser.keyframes_without), (30, 1), "the last keyframe is too late");
    let mut seen = 0;
    for (node, scan) in &laser.scans {
        for point in scan.points() {
            let pose = pose(&ingested.graph, usize::try_from(*node).unwrap());
            let place = pose.translation + pose.rotation * point;
            let error = (place - nalgebra::Vector2::from(POST)).norm();
            // A beam is 0.125 degrees off at most: 44 mm at 20 m.
            assert!(error < 0.05, "node {node}: {error}");
            seen += 1;
        }
    }
    assert!(seen >= 20, "{seen}");
}

#[test]
fn damaged_and_foreign_files_are_refused_by_name() {
    let (_folder, path) = session();
    let file = path.join("hokuyo_30m.bin");
    let mut cut = scans([0, 20, 40]);
    cut.truncate(cut.len() - 7);
    let mut empty = Vec::new();
    write_hokuyo_scan(time(20).try_into().unwrap(), &[], &mut empty).unwrap();
    for (bytes, expected) in [
        (cut, "hokuyo_30m.bin, record 3: has 2163 of 2170 bytes"),
        (scans([900, 901]), "none of its 2 scans is within 0.25 s of one of the 31 keyframes"),
        (scans([20, 40, 30]), "record 3: its time"),
        (empty, "all 1 scans at keyframes are without a return"),
    ] {
        fs::write(&file, bytes).unwrap();
        let said = run(&path, &options()).err().unwrap().to_string();
        assert!(said.contains(expected) && said.contains("hokuyo_30m.bin"), "{said}");
    }
}

#[test]
fn repairs_are_counted_and_reported() {
    let (_folder, path) = session();
    let mut bytes = scans((0..=600).step_by(2));
    write_hokuyo_scan(time(30).try_into().unwrap(), &[5.0], &mut bytes).unwrap();
    let other = path.join("other.bin");
    fs::write(&other, bytes).unwrap();
    let mut files = SessionFiles::find(&path, None, None).unwrap();
    files.set_hokuyo(&other);
    let mut said = Vec::new();
    let ingested = ingest(&mut files, &options(), &mut |event| {
        if let Event::Warning(warning @ Warning::Scans { .. }) = event {
            said.push(warning.to_string());
        }
    })
    .unwrap();
    let laser = ingested.laser.unwrap();
    assert_eq!((laser.scans.len(), laser.in_file, laser.out_of_order), (31, 301, 1));
    assert_eq!(said.len(), 1);
    assert!(said[0].contains("other.bin: skipped scans whose time does not advance: 1"), "{}", said[0]);
}

#[test]
fn a_session_without_scans_has_none() {
    let (_folder, path) = session();
    assert_eq!(run(&path, &options()).unwrap().laser, None);
}
