//! Simulates a session: the rows of its files.

use std::io::{self, Write};

use posecut_random::random;
use rand::RngExt as _;

use crate::campus::Campus;
use crate::drive::{Instant, drive};
use crate::scanners::{HOKUYO, Scanners, VELODYNE};
use crate::sensors::{self, Row};
use crate::{OptionError, Options};

/// A simulated session.
#[derive(Clone, Debug)]
pub struct Session {
    /// Its files, the ground truth first.
    pub files: Vec<SessionFile>,
    /// What its laser scanners see, cast when it is written.
    pub scanners: Scanners,
    /// The drive in numbers.
    pub summary: Summary,
}

/// One file of a session.
#[derive(Clone, Debug)]
pub struct SessionFile {
    /// Its name, without a directory.
    pub name: String,
    /// Its rows in the order of time.
    pub rows: Vec<Row>,
}

/// A drive in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Length of the path, metres.
    pub path_length: f64,
    /// Duration, seconds.
    pub duration: f64,
    /// Share of the time that the robot stands still or nearly so: below 0.15 m/s.
    pub stopped_share: f64,
    /// Crossings of the campus.
    pub crossings: usize,
    /// Paths between them.
    pub paths: usize,
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
        || [HOKUYO, VELODYNE].contains(&name)
        || name.strip_prefix("groundtruth_").is_some_and(|rest| rest.strip_suffix(".csv").is_some())
}

/// Simulates a session. `name` is its date: it is part of the ground-truth file's name, and determines the route together
/// with the seed.
pub fn simulate(name: &str, options: &Options) -> Result<Session, OptionError> {
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
    let mut files = vec![SessionFile { name: format!("groundtruth_{name}.csv"), rows: truth }];
    files.extend(FILES.into_iter().zip(rows).map(|(file, rows)| SessionFile { name: file.to_owned(), rows }));
    let summary = Summary::of(&instants, &campus);
    let scanners = Scanners::new(name, options, &campus, start, instants);
    Ok(Session { files, scanners, summary })
}

impl Summary {
    fn of(instants: &[Instant], campus: &Campus) -> Self {
        let way = |pair: &[Instant]| (pair[1].pose.translation - pair[0].pose.translation).norm();
        let stopped = instants.iter().filter(|instant| instant.speed < 0.15).count();
        Self {
            path_length: instants.windows(2).map(way).sum(),
            duration: instants.last().map_or(0.0, |last| last.seconds),
            stopped_share: stopped as f64 / instants.len().max(1) as f64,
            crossings: campus.paths.node_count(),
            paths: campus.paths.edge_count(),
        }
    }
}

impl SessionFile {
    /// Writes the rows as CSV without a header: the time, then the numbers.
    pub fn write(&self, writer: &mut impl Write) -> io::Result<()> {
        for (time, numbers) in &self.rows {
            write!(writer, "{time}")?;
            for number in numbers {
                // Nine decimals are finer than any of the sensors, but latitudes in radians need them.
                write!(writer, ",{number:.9}")?;
            }
            writeln!(writer)?;
        }
        Ok(())
    }
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
