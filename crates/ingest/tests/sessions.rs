//! Tests with whole sessions, sound and damaged.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "sessions/gps.rs"]
mod gps;
#[path = "sessions/laser.rs"]
mod laser;

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{Dimension, PoseGraph};
use posecut_ingest::{
    ClockSource, HeadingSource, IngestError, Ingested, OdometrySource, Options, SessionFiles, ingest,
};
use tempfile::TempDir;

const START: i64 = 1_327_194_947_000_000;
const TENTH: i64 = 100_000;

fn options() -> Options {
    Options::DEFAULT
}

/// Driving a circle of 10 m at 1 m/s, clockwise seen from above (yaw grows): the pose at `tenth` in NCLT's columns.
fn circle(tenth: i64) -> [f64; 6] {
    let yaw = tenth as f64 * 0.01;
    let wrapped = posecut_geometry::wrap_angle(yaw);
    [10.0 * yaw.sin(), 10.0 * (1.0 - yaw.cos()), 0.0, 0.0, 0.0, wrapped]
}

fn rows(file: &Path, rows: impl Iterator<Item = (i64, Vec<f64>)>) {
    let mut text = String::new();
    for (time, numbers) in rows {
        let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
        text.push_str(&format!("{time},{}\n", numbers.join(",")));
    }
    fs::write(file, text).unwrap();
}

fn time(tenth: i64) -> i64 {
    START + tenth * TENTH
}

/// A session directory with integrated odometry and ground truth.
fn session() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("2012-01-22");
    fs::create_dir(&path).unwrap();
    rows(&path.join("odometry_mu_100hz.csv"), (0..=600).map(|tenth| (time(tenth), circle(tenth).to_vec())));
    rows(
        &path.join("groundtruth_2012-01-22.csv"),
        (0..=600).map(|tenth| (time(tenth), circle(tenth).to_vec())),
    );
    (folder, path)
}

fn run(path: &Path, options: &Options) -> Result<Ingested, IngestError> {
    let mut files = SessionFiles::find(path, None, None)?;
    ingest(&mut files, options, &mut |_| ())
}

fn pose(graph: &PoseGraph, index: usize) -> SE2 {
    SE2::from_components(graph.nodes[index].pose.as_ref().unwrap()).unwrap()
}

#[test]
fn keyframes_lie_where_the_robot_was() {
    let (_folder, path) = session();
    let ingested = run(&path, &options()).unwrap();
    let graph = &ingested.graph;
    assert_eq!((graph.nodes.len(), graph.edges.len()), (31, 30));
    assert_eq!(graph.nodes[3].utime, Some(time(60)), "every tenth period of 0.2 s");
    for index in 0..31 {
        let [x, y, .., yaw] = circle(20 * index as i64);
        let error = pose(graph, index).between(&SE2::new(x, y, yaw)).log().norm();
        assert!(error < 1e-9, "keyframe {index} is off by {error}");
        assert_eq!(graph.nodes[index].truth.as_ref().unwrap().pose, graph.nodes[index].pose);
    }
    for edge in &graph.edges {
        let measured = SE2::from_components(edge.measurement.as_ref().unwrap()).unwrap();
        let walked = pose(graph, edge.from as usize).between(&pose(graph, edge.to as usize));
        assert!(measured.between(&walked).log().norm() < 1e-9);
    }
    assert!((ingested.summary.path_length - 60.0).abs() < 0.01);
}

#[test]
fn all_sources_of_odometry_tell_the_same_drive() {
    let (_folder, path) = session();
    let integrated = run(&path, &options()).unwrap().graph;
    let planar = |tenth| {
        let [x, y, .., yaw] = circle(tenth);
        SE2::new(x, y, yaw)
    };
    rows(
        &path.join("odometry_mu.csv"),
        (0..=300).map(|image| {
            let step = planar((2 * image - 2).max(0)).between(&planar(2 * image)).components();
            (time(2 * image), vec![step[0], step[1], 0.0, 0.0, 0.0, step[2]])
        }),
    );
    rows(&path.join("wheels.csv"), (0..=600).map(|tenth| (time(tenth), vec![1.1 * 1.03, 1.1 * 0.97])));
    rows(
        &path.join("ms25_euler.csv"),
        (0..=600).map(|tenth| (time(tenth), vec![0.0, 0.0, circle(tenth)[5]])),
    );
    rows(
        &path.join("kvh.csv"),
        (0..=600)
            .map(|tenth| (time(tenth), vec![(circle(tenth)[5] + 2.0).rem_euclid(std::f64::consts::TAU)])),
    );
    rows(
        &path.join("ms25.csv"),
        (0..=600).map(|tenth| (time(tenth), [[0.0; 8].as_slice(), &[0.1]].concat())),
    );
    let with = |odometry, heading| Options { odometry, heading, wheel_scale: 1.0 / 1.1, ..options() };
    let cases = [
        Options { odometry: OdometrySource::Relative, ..options() },
        with(OdometrySource::Wheels, HeadingSource::Kvh),
        with(OdometrySource::Wheels, HeadingSource::Euler),
        with(OdometrySource::Wheels, HeadingSource::Gyro),
    ];
    for options in cases {
        let graph = run(&path, &options).unwrap().graph;
        assert_eq!(graph.nodes.len(), integrated.nodes.len(), "{options:?}");
        for index in 0..graph.nodes.len() {
            let error = pose(&graph, index).between(&pose(&integrated, index)).log().norm();
            assert!(error < 2e-3, "{options:?}: keyframe {index} is off by {error}");
        }
    }
    let chosen = run(&path, &options()).unwrap().summary;
    assert_eq!(chosen.odometry, OdometrySource::Relative, "the camera's own odometry is preferred");
    assert_eq!(chosen.clock, ClockSource::RelativeOdometry);
}

#[test]
fn a_scale_lengthens_the_way_of_computed_odometry_too() {
    let (_folder, path) = session();
    let (usual, long) = (
        run(&path, &options()).unwrap().graph,
        run(&path, &Options { wheel_scale: 1.07, ..options() }).unwrap().graph,
    );
    for index in 0..usual.nodes.len() {
        let (usual, long) = (pose(&usual, index), pose(&long, index));
        assert!((long.translation - usual.translation * 1.07).norm() < 1e-9, "keyframe {index}");
        assert!((long.angle() - usual.angle()).abs() < 1e-12);
    }
    assert_eq!(usual.nodes[7].truth, long.nodes[7].truth);
    for scale in [0.0, f64::NAN] {
        let error = Options { wheel_scale: scale, ..options() }.check().unwrap_err().to_string();
        assert!(error.starts_with("--wheel-scale is"), "{error}");
    }
}

#[test]
fn space_and_plane_agree_on_a_flat_drive() {
    let (_folder, path) = session();
    let plane = run(&path, &options()).unwrap().graph;
    let space = run(&path, &Options { dimension: 3, ..options() }).unwrap().graph;
    assert_eq!(space.header.dimension, Dimension::Three);
    for (flat, spatial) in plane.nodes.iter().zip(&space.nodes) {
        let (flat, spatial) = (flat.pose.as_ref().unwrap(), spatial.pose.as_ref().unwrap());
        assert!((flat[0] - spatial[0]).abs() < 1e-12 && (flat[1] - spatial[1]).abs() < 1e-12);
        assert_eq!(spatial[2], 0.0);
    }
}

#[test]
fn an_archive_gives_the_same_graph_as_its_directory() {
    let (folder, path) = session();
    let archive = folder.path().join("2012-01-22_sen.tar.gz");
    let encoder =
        flate2::write::GzEncoder::new(fs::File::create(&archive).unwrap(), flate2::Compression::fast());
    let mut builder = tar::Builder::new(encoder);
    builder
        .append_path_with_name(path.join("odometry_mu_100hz.csv"), "2012-01-22/odometry_mu_100hz.csv")
        .unwrap();
    builder.into_inner().unwrap().finish().unwrap();
    fs::copy(path.join("groundtruth_2012-01-22.csv"), folder.path().join("groundtruth_2012-01-22.csv"))
        .unwrap();
    assert_eq!(run(&archive, &options()).unwrap().graph, run(&path, &options()).unwrap().graph);
    let whole = fs::read(&archive).unwrap();
    fs::write(&archive, &whole[..whole.len() / 2]).unwrap();
    let error = run(&archive, &options()).err().unwrap().to_string();
    assert!(
        error.contains("neither a CARMEN log nor a whole tar.gz archive")
            && error.contains("download the archive again"),
        "{error}"
    );
}

#[test]
fn names_in_an_archive_cannot_escape() {
    let (folder, _path) = session();
    let archive = folder.path().join("2012-01-23_sen.tar.gz");
    let encoder =
        flate2::write::GzEncoder::new(fs::File::create(&archive).unwrap(), flate2::Compression::fast());
    let mut builder = tar::Builder::new(encoder);
    let content = b"1,0,0,0,0,0,0\n2,0,0,0,0,0,0\n";
    let mut header = tar::Header::new_gnu();
    header.set_size(content.len() as u64);
    // The library's safe interface refuses such a name, so the test writes it into the header directly.
    let name = b"../../escaped/odometry_mu.csv";
    header.as_gnu_mut().unwrap().name[..name.len()].copy_from_slice(name);
    header.set_mode(0o644);
    header.set_cksum();
    builder.append(&header, &content[..]).unwrap();
    builder.into_inner().unwrap().finish().unwrap();
    let files = SessionFiles::find(&archive, None, None).unwrap();
    assert!(files.has(posecut_ingest::FileKind::RelativeOdometry), "it is read in place");
    assert!(!folder.path().join("../../escaped").exists() && !folder.path().join("escaped").exists());
}

#[test]
fn image_names_set_the_keyframes() {
    let (_folder, path) = session();
    let camera = path.join("lb3/Cam5");
    fs::create_dir_all(&camera).unwrap();
    for tenth in (1..600).step_by(2) {
        fs::write(camera.join(format!("{}.tiff", time(tenth))), "").unwrap();
    }
    fs::write(camera.join("notes.txt"), "").unwrap();
    let graph = run(&path, &options()).unwrap().graph;
    assert_eq!(
        (graph.nodes.len(), graph.nodes[0].utime, graph.nodes[1].utime),
        (30, Some(time(1)), Some(time(21)))
    );
}

#[test]
fn truth_is_never_extrapolated_nor_bridged() {
    let (_folder, path) = session();
    let nan = (100..105).map(|tenth| (time(tenth), vec![f64::NAN; 6]));
    let truth = (105..=500)
        .filter(|tenth| !(200..300).contains(tenth))
        .map(|tenth| (time(tenth), circle(tenth).to_vec()));
    rows(&path.join("groundtruth_2012-01-22.csv"), nan.chain(truth));
    let ingested = run(&path, &options()).unwrap();
    let known: Vec<usize> = ingested
        .graph
        .nodes
        .iter()
        .enumerate()
        .filter(|(_, node)| node.truth.is_some())
        .map(|(index, _)| index)
        .collect();
    // Keyframes are at tenths 120..=180 and 300..=500 in steps of 20; those at 200..=280 are in the gap from 199 to
    // 300.
    assert_eq!(known, [6, 7, 8, 9, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25]);
    assert_eq!(ingested.summary.dropped_rows, 5);
    assert_eq!(ingested.summary.truth_gaps, Some(1));
}

#[test]
fn keyframes_in_a_gap_of_the_odometry_are_left_out() {
    let (_folder, path) = session();
    let kept = (0..=600)
        .filter(|tenth| !(205..395).contains(tenth))
        .map(|tenth| (time(tenth), circle(tenth).to_vec()));
    rows(&path.join("odometry_mu_100hz.csv"), kept);
    let ingested = run(&path, &options()).unwrap();
    assert_eq!(ingested.summary.gaps, 1);
    let tenths: Vec<i64> =
        ingested.graph.nodes.iter().map(|node| (node.utime.unwrap() - START) / TENTH).collect();
    assert!(
        tenths.contains(&200)
            && tenths.contains(&400)
            && !tenths.iter().any(|tenth| (205..395).contains(tenth))
    );
    assert_eq!(
        ingested.graph.edges.len(),
        ingested.graph.nodes.len() - 1,
        "the odometry across the gap is known"
    );
}

#[test]
fn covariances_come_from_the_file_unless_options_say_otherwise() {
    let (_folder, path) = session();
    let covariance: Vec<f64> = (0..6)
        .flat_map(|row| {
            (row..6).map(move |column| if row == column { 0.01 * (f64::from(row) + 1.0) } else { 0.0 })
        })
        .collect();
    rows(&path.join("odometry_cov_100hz.csv"), (0..=600).map(|tenth| (time(tenth), covariance.clone())));
    let ingested = run(&path, &options()).unwrap();
    let information = ingested.graph.edges[0].information.as_ref().unwrap();
    // Twenty steps with heading variance 0.06. Errors of heading add to the sideways error as well, whose steps alone
    // sum to 20 * 0.02.
    assert!((1.0 / information[5] - 1.2).abs() < 0.8, "{information:?}");
    let given = run(&path, &Options { sigma_translation: Some(0.5), ..options() }).unwrap().graph;
    assert_eq!(given.edges[0].noise.as_deref(), Some("odometry"));
    assert_eq!(given.header.noise_model("odometry").unwrap().information[0], 4.0);
}

#[test]
fn what_is_missing_is_named_with_what_is_there() {
    let (_folder, path) = session();
    fs::remove_file(path.join("odometry_mu_100hz.csv")).unwrap();
    let error = run(&path, &options()).err().unwrap().to_string();
    assert!(error.contains("there is no odometry; found groundtruth_2012-01-22.csv"), "{error}");
    rows(&path.join("wheels.csv"), (0..=600).map(|tenth| (time(tenth), vec![1.0, 1.0])));
    let error = run(&path, &options()).err().unwrap().to_string();
    assert!(error.contains("no file gives a heading") && error.contains("kvh.csv"), "{error}");
    let error =
        run(&path, &Options { odometry: OdometrySource::Relative, ..options() }).err().unwrap().to_string();
    assert!(error.contains("there is no odometry_mu.csv"), "{error}");
}

#[test]
fn damaged_lines_are_refused_with_file_and_line() {
    let (_folder, path) = session();
    let mut file = fs::OpenOptions::new().append(true).open(path.join("odometry_mu_100hz.csv")).unwrap();
    write!(file, "{},1.0,2.0", time(601)).unwrap();
    let error = run(&path, &options()).err().unwrap().to_string();
    assert!(error.contains("odometry_mu_100hz.csv, line 602: expected 7 columns, found 3"), "{error}");
}

#[test]
fn a_lost_relative_pose_is_refused() {
    let (_folder, path) = session();
    let row = |image: i64| {
        (time(2 * image), if image == 50 { vec![f64::NAN; 6] } else { vec![0.2, 0.0, 0.0, 0.0, 0.0, 0.0] })
    };
    rows(&path.join("odometry_mu.csv"), (0..=300).map(row));
    let error = run(&path, &options()).err().unwrap().to_string();
    assert!(error.contains("odometry_mu.csv, line 51: the relative pose cannot be used"), "{error}");
}

#[test]
fn a_session_too_short_is_refused() {
    let (_folder, path) = session();
    rows(&path.join("odometry_mu_100hz.csv"), (0..3).map(|tenth| (time(tenth), circle(tenth).to_vec())));
    let error = run(&path, &options()).err().unwrap().to_string();
    assert!(
        error.contains("too few keyframes: 1 of 1 images or periods") && error.contains("--keep-every"),
        "{error}"
    );
}

/// At five keyframes a second, two rows that are centuries apart would give too many keyframes.
#[test]
fn a_clock_that_jumps_centuries_is_refused_and_takes_no_memory() {
    let (_folder, path) = session();
    let far = 8_000_000_000_000_000;
    rows(
        &path.join("odometry_mu_100hz.csv"),
        [0, 1, 2]
            .into_iter()
            .zip([time(0), time(1), far])
            .map(|(tenth, time)| (time, circle(tenth).to_vec())),
    );
    let error = run(&path, &options()).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("its clock jumps") && error.contains("--period"), "{error}");
}

/// The ground truth of 2012-11-16 and 2013-02-23 repeats its last pose for most of a minute while the robot still
/// turns. Edges between those poses were called correct although they were off by two radians.
#[test]
fn ground_truth_that_repeats_a_pose_while_the_robot_moves_has_ended() {
    let (_folder, path) = session();
    let truth = |from: i64, to: i64| {
        let frozen = (0..=600).map(|tenth: i64| (time(tenth), circle(tenth.clamp(from, to)).to_vec()));
        rows(&path.join("groundtruth_2012-01-22.csv"), frozen);
        let ingested = run(&path, &options()).unwrap();
        let known = ingested.graph.nodes.iter().map(|node| node.truth.is_some()).collect::<Vec<_>>();
        (known, ingested.summary.frozen_truth_rows)
    };
    let keyframes =
        |known: std::ops::RangeInclusive<usize>| (0..31).map(|keyframe| known.contains(&keyframe)).collect();
    assert_eq!(truth(0, 600), (keyframes(0..=30), 0));
    assert_eq!(truth(0, 500), (keyframes(0..=25), 100));
    assert_eq!(truth(100, 500), (keyframes(5..=25), 200));
    // A robot that stands still keeps its ground truth.
    let standing = |tenth: i64| circle(tenth.min(500)).to_vec();
    rows(&path.join("odometry_mu_100hz.csv"), (0..=600).map(|tenth| (time(tenth), standing(tenth))));
    assert_eq!(truth(0, 500), (keyframes(0..=30), 0));
}
