//! Scan Context: laws of the descriptor, and a simulated session with three-dimensional scans.

use std::f64::consts::TAU;
use std::fs;

use nalgebra::Vector3;
use posecut_nclt_sensors::velodyne::Hit;
use posecut_recognize::Settings;
use posecut_recognize::places::Context as _;
use posecut_recognize::recognition::recognize_in_space;
use posecut_recognize::scan_context::{ContextOptions, ScanContext};
use posecut_recognize::spatial::slice;
use posecut_recognize::velodyne::{Spatial, read_folders};
use posecut_scan::Scans;
use proptest::prelude::*;

use super::nclt::{correct, graph, session};

const OPTIONS: ContextOptions = ContextOptions::DEFAULT;

/// Points in the middles of cells, so that a turn by whole sectors moves none across a border.
fn points(cells: &[(usize, usize, f64)], turn: usize) -> Vec<Vector3<f64>> {
    cells
        .iter()
        .map(|(ring, sector, height)| {
            let angle = ((sector + turn) as f64 + 0.5) * TAU / 60.0;
            let range = (*ring as f64 + 0.5) * 4.0;
            Vector3::new(range * angle.cos(), range * angle.sin(), *height)
        })
        .collect()
}

proptest! {
    #[test]
    fn a_turned_place_has_the_same_key_and_no_distance_at_its_shift(
        cells in prop::collection::vec((0_usize..20, 0_usize..60, 0.1..9.0), 100..400),
        shift in 0_usize..60,
    ) {
        let here = ScanContext::new(points(&cells, shift), &OPTIONS);
        let there = ScanContext::new(points(&cells, 0), &OPTIONS);
        prop_assert_eq!(here.key().map(|share| (share * 60.0).round() as i64), there.key().map(|share| (share * 60.0).round() as i64));
        let similarities = here.similarities(&there);
        prop_assert!((similarities[shift] - 1.0).abs() < 1e-5, "{}", similarities[shift]);
    }
}

#[test]
fn a_cell_has_the_height_of_its_highest_point() {
    let one = ScanContext::new(points(&[(2, 3, 1.0), (2, 3, 4.0), (2, 3, -1.0), (5, 3, 3.0)], 0), &OPTIONS);
    let other = ScanContext::new(points(&[(2, 3, 4.0), (5, 3, 3.0)], 0), &OPTIONS);
    assert_eq!(one, other);
    // Equation 8: one of 60 cells of two rings.
    let expected: Vec<usize> = (0..20).filter(|ring| one.key()[*ring] > 0.0).collect();
    assert_eq!(expected, [2, 5]);
    assert!((one.key()[2] - 1.0 / 60.0).abs() < 1e-12);
    // Equation 6, by hand: one column (4, 3) and (4, 0) have the cosine 0.8; two thirds of the columns are required.
    let alone = ScanContext::new(points(&[(2, 3, 4.0)], 0), &OPTIONS);
    assert!((alone.similarities(&one)[0] - 0.8 / 20.0).abs() < 1e-6);
    let beyond = ScanContext::new([Vector3::new(80.5, 0.0, 3.0)], &OPTIONS);
    assert!(beyond.is_empty(), "80 m is the end");
}

#[test]
fn a_slice_has_walls_and_no_slopes() {
    let mut hits = Vec::new();
    for laser in 0..8_u8 {
        let height = 0.2 * f64::from(laser);
        // A wall in front, and a slope of 20 degrees on the right that ends in front of another wall.
        hits.push(Hit { point: Vector3::new(10.0, 0.0, -height), intensity: 1, laser });
        hits.push(Hit { point: Vector3::new(0.0, 5.0 + height / 0.36, -height), intensity: 1, laser });
        hits.push(Hit { point: Vector3::new(0.0, 15.0, -height), intensity: 1, laser });
    }
    let scan = slice(&hits);
    assert_eq!(scan.returns(), 2);
    assert!((scan.ranges[0] - 10.0).abs() < 1e-9);
    assert!((scan.ranges[180] - 15.0).abs() < 1e-9, "y is to the right, as in the frame of the body");
}

#[test]
fn three_dimensional_scans_recognise_the_way_back() {
    let folder = session(None, Some(1.0));
    let graph = graph(&folder);
    assert!(graph.unknown.is_empty());
    let folders = [folder.path().join("2012-01-22/velodyne_sync")];
    let Spatial { scans: spatial, digests } =
        read_folders(&folders, &graph, &OPTIONS, |bytes| bytes.len().to_string()).unwrap();
    assert_eq!(digests.lines().count(), spatial.iter().flatten().count(), "one file a keyframe");
    let first = fs::read_dir(&folders[0]).unwrap().map(|entry| entry.unwrap().path()).min().unwrap();
    let expected =
        format!("{}  {}", fs::metadata(&first).unwrap().len(), first.file_name().unwrap().display());
    assert_eq!(digests.lines().next(), Some(expected.as_str()));
    let slices = graph.nodes.iter().zip(&spatial);
    let scans: Scans =
        slices.filter_map(|(node, scan)| Some((node.id, scan.as_ref()?.slice.clone()))).collect();
    let contexts: Vec<_> =
        spatial.iter().map(|scan| scan.as_ref().map(|scan| scan.context.clone())).collect();
    let found = recognize_in_space(&graph, &scans, contexts.clone(), None, &Settings::DEFAULT).unwrap();
    let right = found.candidates.iter().filter(|candidate| correct(&graph, candidate)).count();
    let all = found.candidates.len();
    assert!(right >= 60 && 10 * right >= 9 * all, "{right} of {all} are correct");
    let strict = ContextOptions { context_distance: 0.0, ..OPTIONS };
    let settings = Settings { context: strict, ..Settings::DEFAULT };
    assert_eq!(recognize_in_space(&graph, &scans, contexts, None, &settings).unwrap().proposed, 0);
}

#[test]
fn folders_of_other_sessions_are_refused() {
    let folder = session(None, Some(0.2));
    let mut graph = graph(&folder);
    for node in &mut graph.nodes {
        node.utime = node.utime.map(|time| time + 1_000_000_000_000);
    }
    let path = folder.path().join("2012-01-22/velodyne_sync");
    let none = |_: &[u8]| String::new();
    let said = read_folders(&[path], &graph, &OPTIONS, none).err().unwrap().to_string();
    assert!(said.starts_with("none of the ") && said.contains("is within 0.05 s"), "{said}");
    let said = read_folders(&[folder.path().to_owned()], &graph, &OPTIONS, none).err().unwrap().to_string();
    assert!(said.contains("has no file UTIME.bin"), "{said}");
}
