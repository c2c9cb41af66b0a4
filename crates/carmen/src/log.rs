//! A log as a whole: its scans in the order of the lines, with what was repaired.
//!
//! The order of the lines is that of the motion, even where the times are not in order: on the log *intel* of the radish collection 631
//! of 13631 scans are earlier than the scan before them, by up to 0.9 s, and the path in the order of the times is 30 % longer.

use std::io::BufRead;

use nalgebra::Vector3;
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::bounded_lines;
use posecut_scan::LaserScan;
use serde::Serialize;

use crate::line::{self, Message};
use crate::{LogError, LogOptions};

/// A scan of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct LoggedScan {
    /// The line, counted from 1.
    pub line: usize,
    /// Microseconds, by the clock of the sender.
    pub time: i64,
    /// The robot in the frame of the odometry.
    pub robot: SE2,
    /// The scan.
    pub scan: LaserScan,
}

/// A log that was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// The scans, in the order of the lines.
    pub scans: Vec<LoggedScan>,
    /// True poses with their times in microseconds, in the order of the lines; of simulated logs.
    pub truth: Vec<(i64, SE2)>,
    /// What was left out.
    pub repairs: Repairs,
}

/// What was repaired or left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Repairs {
    /// Scans that are earlier than the one before them. They are kept, in the order of the lines and with their times.
    pub out_of_order: usize,
    /// Scans with another number of beams than the first one.
    pub other_beams: usize,
    /// Scans without odometry, and of a second scanner.
    pub unused_scans: usize,
    /// Ranges that are no distances: NaN, infinite, negative.
    pub meaningless_ranges: usize,
    /// Scans without any return.
    pub empty_scans: usize,
    /// Whether the poses of the scanner in the log are not at one position on the robot. They are ignored then.
    pub moving_scanner: bool,
}

/// A clock that goes back by more than this has been set, microseconds. Loggers write messages of one moment in any order.
const CLOCK_SET: i64 = 10_000_000;

/// Refuse a log if more than one in this many scans has to be left out.
const MOST_LEFT_OUT: usize = 10;

/// The poses of the scanner on the robot may differ by this, metres and radians: the digits of a log.
const MOUNT: f64 = 0.01;

impl Log {
    /// Reads the scans of a log; errors call it `place`. O(size).
    pub fn read(place: &str, reader: impl BufRead, options: &LogOptions) -> Result<Self, LogError> {
        let mut reading = Reading::default();
        for (number, text) in bounded_lines(reader).enumerate() {
            let line = number + 1;
            let refused = |problem, remedy| LogError::Line { place: place.to_owned(), line, problem, remedy };
            let text = text.map_err(|error| refused(format!("cannot be read: {error}"), DOWNLOAD))?;
            let message = line::parse(line, &text, options.field_of_view, options.max_range)
                .map_err(|problem| refused(problem, DOWNLOAD))?;
            reading
                .add(line, message)
                .map_err(|problem| refused(problem, "cut the log here and read its parts"))?;
        }
        reading.finish(place)
    }
}

const DOWNLOAD: &str = "download the log again if it is cut short, or delete the line";

#[derive(Default)]
struct Reading {
    log: Log,
    lasers: Vec<SE2>,
    beams: Option<usize>,
    /// The line and the beams of the first scan with another number of beams.
    first_other: Option<(usize, usize)>,
    /// The line of the first scan that is not used.
    first_unused: Option<usize>,
}

impl Reading {
    fn add(&mut self, line: usize, message: Message) -> Result<(), String> {
        match message {
            Message::Scan(scan) => self.add_scan(*scan)?,
            Message::Truth(time, pose) => self.log.truth.push((time, pose)),
            Message::Unused => {
                self.first_unused.get_or_insert(line);
                self.log.repairs.unused_scans += 1;
            }
            Message::Other => {}
        }
        Ok(())
    }

    fn add_scan(&mut self, scan: line::Scan) -> Result<(), String> {
        let repairs = &mut self.log.repairs;
        if let Some(last) = self.log.scans.last()
            && scan.time < last.time
        {
            let back = last.time - scan.time;
            if back > CLOCK_SET {
                return Err(format!(
                    "the clock goes back by {:.3} s to {:.6} s",
                    seconds(back),
                    seconds(scan.time)
                ));
            }
            repairs.out_of_order += 1;
        }
        if *self.beams.get_or_insert(scan.ranges.len()) != scan.ranges.len() {
            repairs.other_beams += 1;
            self.first_other.get_or_insert((scan.line, scan.ranges.len()));
            return Ok(());
        }
        let mut ranges = scan.ranges;
        for range in &mut ranges {
            if !(*range >= 0.0 && range.is_finite()) {
                repairs.meaningless_ranges += 1;
                *range = 0.0;
            }
            if *range >= scan.max_range {
                *range = 0.0;
            }
        }
        let [first_angle, angle_step] = scan.angles;
        let laser = LaserScan { sensor: SE2::identity(), first_angle, angle_step, ranges };
        repairs.empty_scans += usize::from(laser.returns() == 0);
        self.lasers.push(scan.laser);
        self.log.scans.push(LoggedScan { line: scan.line, time: scan.time, robot: scan.robot, scan: laser });
        Ok(())
    }

    fn finish(mut self, place: &str) -> Result<Log, LogError> {
        let refused = |problem: String, remedy: &str| {
            Err(LogError::Log { place: place.to_owned(), problem, remedy: remedy.to_owned() })
        };
        let at = |line: usize, problem: String, remedy: &'static str| {
            Err(LogError::Line { place: place.to_owned(), line, problem, remedy })
        };
        let (read, repairs) = (self.log.scans.len(), self.log.repairs);
        if read == 0
            && let Some(line) = self.first_unused
        {
            let problem = format!(
                "this scan, the first of {}, has no odometry or is of a second scanner, and so are all others",
                repairs.unused_scans
            );
            return at(line, problem, "use the log of a robot that wrote FLASER or ROBOTLASER1 lines");
        }
        if read == 0 {
            return refused(
                "it has no scans".to_owned(),
                "name a CARMEN log with FLASER or ROBOTLASER1 lines",
            );
        }
        let all = read + repairs.other_beams;
        if let Some((line, beams)) = self.first_other
            && repairs.other_beams * MOST_LEFT_OUT > all
        {
            let problem = format!(
                "this scan has {beams} beams, but the first one of the log has {}; {} of {all} scans have another number than the first",
                self.beams.unwrap_or(0),
                repairs.other_beams
            );
            return at(line, problem, "split the log here");
        }
        if repairs.empty_scans == read {
            let problem = format!("none of its {read} scans has a return");
            return refused(problem, "increase --max-range if the ranges are farther than that");
        }
        self.mount();
        Ok(self.log)
    }

    /// Finds the position of the scanner on the robot.
    fn mount(&mut self) {
        let mounts =
            || self.log.scans.iter().zip(&self.lasers).map(|(scan, laser)| scan.robot.between(laser));
        let Some(first) = mounts().next() else { return };
        if mounts().any(|mount| first.between(&mount).log().amax() > MOUNT) {
            self.log.repairs.moving_scanner = true;
            return;
        }
        let sum: Vector3<f64> = mounts().map(|mount| first.between(&mount).log()).sum();
        let mean = first.compose(&SE2::exp(&(sum / self.lasers.len() as f64)));
        // Rounded to 10 um and 10 urad, because poses in a log have six digits: a scanner at the robot's origin stays there.
        let round = |value: f64| (value * 1e5).round() / 1e5;
        let sensor = SE2::new(round(mean.translation.x), round(mean.translation.y), round(mean.angle()));
        for scan in &mut self.log.scans {
            scan.scan.sensor = sensor;
        }
    }
}

fn seconds(microseconds: i64) -> f64 {
    microseconds as f64 * 1e-6
}
