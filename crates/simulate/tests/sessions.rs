//! Tests that simulated sessions are sound, determined by their seeds, and as large as stated.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_simulate::{Options, Route, simulate};

fn options(seed: u64) -> Options {
    Options { seed, length: Some(800.0), rate: 5.0, ..Options::DEFAULT }
}

/// The names and contents of a session's files, sorted by name.
fn files(name: &str, options: &Options) -> Vec<(String, String)> {
    let mut files: Vec<(String, String)> = simulate(name, options)
        .unwrap()
        .files
        .into_iter()
        .map(|file| {
            let mut bytes = Vec::new();
            file.write(&mut bytes).unwrap();
            (file.name, String::from_utf8(bytes).unwrap())
        })
        .collect();
    files.sort();
    files
}

#[test]
fn a_seed_and_a_name_fix_every_byte() {
    assert_eq!(files("2012-01-22", &options(1)), files("2012-01-22", &options(1)));
    assert_ne!(files("2012-01-22", &options(1))[0], files("2012-01-22", &options(2))[0]);
    assert_ne!(
        files("2012-01-22", &options(1))[1],
        files("2012-03-31", &options(1))[1],
        "another date, another route"
    );
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
    let files = files("2012-01-22", &options(1));
    assert_eq!(
        files.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
        columns.map(|(name, _)| name)
    );
    for ((name, text), (_, count)) in files.iter().zip(columns) {
        let times: Vec<i64> =
            text.lines().map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
        assert!(times.is_sorted_by(|before, after| before < after), "{name}: time advances");
        assert!(text.lines().all(|line| line.split(',').count() == count), "{name} has {count} columns");
    }
    assert!(
        files[1].1.lines().next().unwrap().contains("NaN"),
        "as in the real files, the truth starts with NaN"
    );
}

#[test]
fn the_drive_has_the_asked_length() {
    let length = simulate("2012-01-22", &options(3)).unwrap().summary.path_length;
    assert!((length - 800.0).abs() < 8.0, "{length}");
}

/// The shares of the second half's ground-truth rows that are near a row of the first half: driven in the same
/// direction, and in the opposite one.
fn revisits(route: Route) -> [f64; 2] {
    let files = files("2012-01-22", &Options { route, ..options(1) });
    let (_, truth) = files.iter().find(|(name, _)| name == "groundtruth_2012-01-22.csv").unwrap();
    let rows: Vec<Vec<f64>> = truth
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

/// The times and ranges of the planar scanner.
fn scanned(options: &Options) -> Vec<(i64, Vec<f64>)> {
    simulate("2012-01-22", options).unwrap().scanners.planar().collect()
}

#[test]
fn scanners_see_the_campus_and_change_no_other_file() {
    let with = Options { length: Some(100.0), hokuyo: Some(1.0), velodyne: Some(0.2), ..options(1) };
    let without = Options { hokuyo: None, velodyne: None, ..with.clone() };
    assert_eq!(files("2012-01-22", &with), files("2012-01-22", &without));
    let scans = scanned(&with);
    assert!(scanned(&without).is_empty() && scans == scanned(&with));
    assert!(scans.windows(2).all(|pair| pair[1].0 - pair[0].0 == 1_000_000), "one a second");
    let beams: usize = scans.iter().map(|(_, ranges)| ranges.len()).sum();
    let returns = scans.iter().flat_map(|(_, ranges)| ranges).filter(|range| **range > 0.0).count();
    assert!(returns * 3 > beams, "{returns} of {beams} beams have a return");
    let turns: Vec<_> = simulate("2012-01-22", &with).unwrap().scanners.spatial().collect();
    assert!(turns.len() > 5 && turns.iter().all(|(_, hits)| hits.len() > 10_000));
}

#[test]
fn impossible_requests_are_refused() {
    for wrong in [
        Options { rate: 1.0, ..options(1) },
        Options { length: Some(f64::NAN), ..options(1) },
        Options { hokuyo: Some(6.0), ..options(1) },
    ] {
        let error = simulate("x", &wrong).unwrap_err().to_string();
        assert!(
            error.starts_with("--rate is 1,")
                || error.starts_with("--length is NaN")
                || error == "--hokuyo is 6, but must be between 0.1 and the 5 Hz of --rate",
            "{error}"
        );
    }
}
