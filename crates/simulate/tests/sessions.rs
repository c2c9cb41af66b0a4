//! Tests that simulated sessions are sound, determined by their seeds, and as large as stated.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::fs;

use posecut_simulate::{Options, Route, simulate};

fn options(seed: u64) -> Options {
    Options { seed, campus: 1, length: Some(800.0), route: Route::Wander, rate: 5.0 }
}

fn files(seed: u64, name: &str) -> Vec<(String, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    simulate(folder.path(), name, &options(seed)).unwrap();
    let mut files: Vec<(String, Vec<u8>)> = fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap()))
        .collect();
    files.sort();
    files
}

#[test]
fn a_seed_and_a_name_fix_every_byte() {
    assert_eq!(files(1, "2012-01-22"), files(1, "2012-01-22"));
    assert_ne!(files(1, "2012-01-22")[0], files(2, "2012-01-22")[0]);
    assert_ne!(files(1, "2012-01-22")[1], files(1, "2012-03-31")[1], "another date, another route");
}

#[test]
fn the_files_have_the_columns_of_nclt() {
    let columns = [
        ("gps.csv", 8),
        ("groundtruth_2012-01-22.csv", 7),
        ("kvh.csv", 2),
        ("ms25.csv", 10),
        ("ms25_euler.csv", 4),
        ("odometry_cov.csv", 22),
        ("odometry_mu.csv", 7),
        ("odometry_mu_100hz.csv", 7),
        ("wheels.csv", 3),
    ];
    let files = files(1, "2012-01-22");
    assert_eq!(
        files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        columns.map(|(name, _)| name)
    );
    for ((name, bytes), (_, count)) in files.iter().zip(columns) {
        let text = std::str::from_utf8(bytes).unwrap();
        let times: Vec<i64> =
            text.lines().map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
        assert!(times.is_sorted_by(|before, after| before < after), "{name}: time advances");
        assert!(text.lines().all(|line| line.split(',').count() == count), "{name} has {count} columns");
    }
    let truth = String::from_utf8(files[1].1.clone()).unwrap();
    assert!(truth.lines().next().unwrap().contains("NaN"), "as in the real files, the truth starts with NaN");
}

#[test]
fn the_drive_has_the_asked_length() {
    let folder = tempfile::tempdir().unwrap();
    let statistics = simulate(folder.path(), "2012-01-22", &options(3)).unwrap();
    let length = statistics.as_map()["path_length_m"].as_f64().unwrap();
    assert!((length - 800.0).abs() < 8.0, "{length}");
}

/// The shares of the second half's ground-truth rows that are near a row of the first half: driven in the same
/// direction, and in the opposite one.
fn revisits(route: Route) -> [f64; 2] {
    let folder = tempfile::tempdir().unwrap();
    simulate(folder.path(), "2012-01-22", &Options { route, ..options(1) }).unwrap();
    let text = fs::read_to_string(folder.path().join("groundtruth_2012-01-22.csv")).unwrap();
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|line| !line.contains("NaN"))
        .map(|line| line.split(',').map(|field| field.parse().unwrap()).collect())
        .collect();
    let (first, second) = rows.split_at(rows.len() / 2);
    let met = |row: &&Vec<f64>, opposite: bool| {
        first.iter().any(|other| {
            let difference = (row[6] - other[6] - if opposite { std::f64::consts::PI } else { 0.0 }).cos();
            (row[1] - other[1]).hypot(row[2] - other[2]) < 3.0 && difference > 30_f64.to_radians().cos()
        })
    };
    [false, true]
        .map(|opposite| second.iter().filter(|row| met(row, opposite)).count() as f64 / second.len() as f64)
}

#[test]
fn a_return_trip_sees_its_way_out_from_the_other_side() {
    let [_, wandering] = revisits(Route::Wander);
    let [same, opposite] = revisits(Route::Return);
    assert!(
        opposite > 0.5 && opposite > same + 0.3,
        "{same} in the same direction, {opposite} in the opposite one"
    );
    assert!(wandering < 0.5, "{wandering}");
}

#[test]
fn impossible_requests_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for wrong in [Options { rate: 1.0, ..options(1) }, Options { length: Some(f64::NAN), ..options(1) }] {
        let error = simulate(folder.path(), "x", &wrong).unwrap_err().to_string();
        assert!(error.starts_with("--rate is 1,") || error.starts_with("--length is NaN"), "{error}");
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
