//! Simulates a session and writes its files.

use std::io::Write as _;
use std::path::Path;

use anyhow::{Context as _, bail};
use posecut_stage::{Statistics, close, random};
use rand::RngExt as _;
use serde::Serialize;

use crate::campus::Campus;
use crate::drive::{Instant, drive};
use crate::route::Route;
use crate::sensors::{self, Row};

/// What shapes a session.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// Seed of the session: route, drive and all sensors
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,

    /// Seed of the campus, which sessions to be compared share
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub campus: u64,

    /// Length of the drive, metres; between 5500 and 6100 by the seed unless given
    #[arg(long, value_name = "METRES")]
    pub length: Option<f64>,

    /// Which way the robot takes
    #[arg(long, value_enum, default_value_t = Route::Wander)]
    pub route: Route,

    /// Rows a second of the fast sensors; NCLT's own rates are 40 to 150, which makes files ten times as large
    #[arg(long, value_name = "HZ", default_value_t = 10.0)]
    pub rate: f64,
}

impl Options {
    /// Refuses options with which no session can be simulated.
    pub fn check(&self) -> anyhow::Result<()> {
        if !(5.0..=200.0).contains(&self.rate) {
            bail!("--rate is {}, and must lie between 5 (the camera's) and 200 Hz", self.rate);
        }
        if let Some(length) = self.length
            && !(50.0..=100_000.0).contains(&length)
        {
            bail!("--length is {length}, and must lie between 50 and 100000 m");
        }
        Ok(())
    }
}

/// The time stamp of an instant, microseconds.
pub(crate) fn time(start: i64, seconds: f64) -> i64 {
    start + (seconds * 1e6).round() as i64
}

/// Names of a session's files except its ground truth.
const FILES: [&str; 8] = [
    "odometry_mu_100hz.csv",
    "odometry_mu.csv",
    "odometry_cov.csv",
    "wheels.csv",
    "ms25.csv",
    "ms25_euler.csv",
    "kvh.csv",
    "gps.csv",
];

/// Whether a simulated session has a file of this name. Real sessions have more files.
pub fn is_session_file(name: &str) -> bool {
    FILES.contains(&name)
        || name.strip_prefix("groundtruth_").is_some_and(|rest| rest.strip_suffix(".csv").is_some())
}

/// Simulates a session and writes its files into an existing directory. `name` is the session's date: it is part of the
/// ground-truth file's name, and determines the route together with the seed.
pub fn simulate(directory: &Path, name: &str, options: &Options) -> anyhow::Result<Statistics> {
    options.check()?;
    let campus = Campus::new(options.campus);
    let draw = |purpose: &str| random(options.seed, &format!("{name} {purpose}"));
    let mut route_draw = draw("route");
    let length = options.length.unwrap_or_else(|| route_draw.random_range(5_500.0..6_100.0));
    let line = options.route.line(&campus, length, &mut route_draw, &mut draw("line"));
    let period = 1.0 / options.rate;
    let instants = drive(&campus, &line, period, &mut draw("drive"));
    let start = start_time(name);
    let odometry = sensors::odometry(&instants, start, period, &mut draw("odometry"));
    let truth = sensors::ground_truth(&instants, start, period, &mut draw("truth"));
    write(&directory.join(format!("groundtruth_{name}.csv")), &truth)?;
    let rows: [Vec<Row>; FILES.len()] = [
        odometry.integrated,
        odometry.relative,
        odometry.covariance,
        sensors::wheels(&instants, start, period, &mut draw("wheels")),
        sensors::imu(&campus, &instants, start, period, &mut draw("imu")),
        sensors::euler(&campus, &instants, start, period, &mut draw("compass")),
        sensors::fibre_optic_gyro(&instants, start, period, &mut draw("gyro")),
        sensors::gps(&instants, start, period, &mut draw("gps")),
    ];
    for (file, rows) in FILES.into_iter().zip(&rows) {
        write(&directory.join(file), rows)?;
    }
    Ok(statistics(name, &instants, &campus))
}

fn statistics(name: &str, instants: &[Instant], campus: &Campus) -> Statistics {
    let mut statistics = Statistics::default();
    let way = |pair: &[Instant]| (pair[1].pose.translation - pair[0].pose.translation).norm();
    let stopped = instants.iter().filter(|instant| instant.speed < 0.15).count();
    statistics.note("session", name);
    statistics.note("path_length_m", instants.windows(2).map(way).sum::<f64>());
    statistics.note("duration_s", instants.last().map_or(0.0, |last| last.seconds));
    statistics.note("stopped_share", stopped as f64 / instants.len().max(1) as f64);
    statistics.note("crossings", campus.paths.node_count());
    statistics.note("paths", campus.paths.edge_count());
    statistics
}

/// Noon UTC of a date YYYY-MM-DD, microseconds. A name that is not a date gets a fixed day.
fn start_time(name: &str) -> i64 {
    let parts: Vec<i64> = name.split('-').filter_map(|part| part.parse().ok()).collect();
    let [year, month, day] = parts[..] else { return 1_325_419_200_000_000 };
    // Days since 1970-01-01 in the Gregorian calendar, counting years from March.
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let days = 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5 + day - 1 - 719_468;
    (days * 86_400 + 43_200) * 1_000_000
}

fn write(path: &Path, rows: &[Row]) -> anyhow::Result<()> {
    // The user does not know the temporary folder: name only the file.
    let place = || path.file_name().unwrap_or_default().display().to_string();
    let file = std::fs::File::create(path).with_context(place)?;
    let mut writer = std::io::BufWriter::new(file);
    for (time, numbers) in rows {
        write!(writer, "{time}").with_context(place)?;
        for number in numbers {
            // Nine decimals are finer than any of the sensors, but latitudes in radians need them.
            write!(writer, ",{number:.9}").with_context(place)?;
        }
        writeln!(writer).with_context(place)?;
    }
    let file = writer.into_inner().map_err(std::io::IntoInnerError::into_error).with_context(place)?;
    close(file).with_context(place)
}

#[cfg(test)]
mod tests {
    use super::start_time;

    #[test]
    fn sessions_start_at_noon_of_their_date() {
        // date -u -d '2012-01-22 12:00' +%s
        assert_eq!(start_time("2012-01-22"), 1_327_233_600_000_000);
        assert_eq!(start_time("2012-11-17"), 1_353_153_600_000_000);
        assert_eq!(start_time("campus"), 1_325_419_200_000_000);
    }
}
