//! The lines of a log: `message_name [message contents] ipc_timestamp ipc_hostname logger_timestamp`.
//!
//! ```text
//! FLASER num_readings [range_readings] x y theta odom_x odom_y odom_theta
//! ROBOTLASER1 laser_type start_angle field_of_view angular_resolution maximum_range accuracy remission_mode
//!     num_readings [range_readings] num_remissions [remission values] laser_x laser_y laser_theta robot_x robot_y robot_theta
//!     laser_tv laser_rv forward_safety_dist side_safety_dist turn_axis
//! TRUEPOS true_x true_y true_theta odom_x odom_y odom_theta
//! ```
//!
//! Older logs have ROBOTLASER1 without remissions, and some without the turn axis. Poses are those of the scanner and of the robot in
//! the frame of the odometry.

use std::f64::consts::PI;

use posecut_geometry::{LieGroup, SE2};

/// A scan with the odometry of its moment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Scan {
    /// The line, counted from 1.
    pub(crate) line: usize,
    /// Microseconds, by the clock of the sender.
    pub(crate) time: i64,
    /// The robot in the frame of the odometry.
    pub(crate) robot: SE2,
    /// The scanner in the frame of the odometry.
    pub(crate) laser: SE2,
    /// Direction of the first beam and angle between beams, radians.
    pub(crate) angles: [f64; 2],
    /// The range from which on there is no return, metres.
    pub(crate) max_range: f64,
    /// The ranges as the line has them; text that says `nan` is NaN.
    pub(crate) ranges: Vec<f64>,
}

/// A message that matters here.
pub(crate) enum Message {
    /// A scan with odometry.
    Scan(Box<Scan>),
    /// Where the robot truly was: microseconds and pose.
    Truth(i64, SE2),
    /// A scan without odometry, or of a second scanner.
    Unused,
    /// Any other.
    Other,
}

/// Times beyond this are no seconds since 1970 or since the start: the year 2200.
const LATEST: f64 = 7.3e9;

/// No scanner has more beams.
const MOST_BEAMS: usize = 100_000;

/// Parses a line. The error says what is wrong with it. O(length).
pub(crate) fn parse(line: usize, text: &str, field_of_view: f64, max_range: f64) -> Result<Message, String> {
    let mut fields = Fields { words: text.split_ascii_whitespace().collect(), next: 1 };
    match fields.words.first().copied() {
        Some("FLASER") => {
            let ranges = fields.list("num_readings")?;
            let angles = forward(ranges.len(), field_of_view);
            fields.scan(line, angles, max_range, ranges, &[6])
        }
        Some("ROBOTLASER1") => {
            let [_, start, _, step, own, _, _] = fields.numbers("the scanner's configuration")?;
            let ranges = fields.list("num_readings")?;
            if step == 0.0 && ranges.len() > 1 {
                return Err("its angular_resolution is 0".to_owned());
            }
            for (name, angle) in [("start_angle", start), ("angular_resolution", step)] {
                if angle.abs() > 2.0 * PI {
                    return Err(format!("its {name} is {angle} rad, more than a turn"));
                }
            }
            let own = if own > 0.0 { own } else { max_range };
            fields.skip_remissions();
            fields.scan(line, [start, step], own.min(max_range), ranges, &[10, 11])
        }
        Some("TRUEPOS") => {
            let [x, y, theta, _, _, _] = fields.numbers("the poses")?;
            Ok(Message::Truth(fields.time()?, SE2::new(x, y, theta)))
        }
        Some("RAWLASER1" | "RLASER" | "ROBOTLASER2") => Ok(Message::Unused),
        _ => Ok(Message::Other),
    }
}

/// CARMEN's convention for FLASER: the beams begin at the right end of the field of view. Odd numbers (181, 361) count both ends.
fn forward(beams: usize, field_of_view: f64) -> [f64; 2] {
    let width = field_of_view * PI / 180.0;
    let steps = if beams % 2 == 1 { beams - 1 } else { beams };
    [-0.5 * width, width / steps.max(1) as f64]
}

struct Fields<'a> {
    words: Vec<&'a str>,
    next: usize,
}

impl Fields<'_> {
    fn number(&mut self, what: &str) -> Result<f64, String> {
        let value = self.any_number(what)?;
        if value.is_finite() { Ok(value) } else { Err(format!("{what} is {value}")) }
    }

    fn any_number(&mut self, what: &str) -> Result<f64, String> {
        let at = self.next;
        let Some(word) = self.words.get(at) else {
            return Err(format!("it ends after {} fields, before {what}", self.words.len()));
        };
        self.next += 1;
        word.parse().map_err(|_| format!("field {} ({what}) is {word:?}, not a number", at + 1))
    }

    fn numbers<const N: usize>(&mut self, what: &str) -> Result<[f64; N], String> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.number(what)?;
        }
        Ok(values)
    }

    /// A count and as many numbers.
    fn list(&mut self, what: &str) -> Result<Vec<f64>, String> {
        let count = self.number(what)?;
        if !(count >= 0.0 && count.fract() == 0.0 && count <= MOST_BEAMS as f64) {
            return Err(format!("{what} is {count}"));
        }
        (0..count as usize).map(|_| self.any_number("range_readings")).collect()
    }

    /// Skips `num_remissions [remission values]` if the number of fields says that they are there.
    fn skip_remissions(&mut self) {
        let left = self.words.len().saturating_sub(self.next);
        let count = self.words.get(self.next).and_then(|word| word.parse::<usize>().ok());
        if let Some(count) = count
            && [10, 11].map(|rest| 1 + count + rest + 3).contains(&left)
            && left > 14
        {
            self.next += 1 + count;
        }
    }

    /// The rest of a line with a scan: poses, perhaps more, and times. `rests` are the possible numbers of fields before the times.
    fn scan(
        mut self,
        line: usize,
        angles: [f64; 2],
        max_range: f64,
        ranges: Vec<f64>,
        rests: &[usize],
    ) -> Result<Message, String> {
        let left = self.words.len().saturating_sub(self.next);
        if !rests.iter().any(|rest| rest + 3 == left) {
            let expected: Vec<String> = rests.iter().map(|rest| (rest + 3).to_string()).collect();
            return Err(format!(
                "it has {left} fields after its {} ranges, but should have {}",
                ranges.len(),
                expected.join(" or ")
            ));
        }
        let laser = self.numbers::<3>("the pose of the scanner")?;
        let robot = self.numbers::<3>("the pose of the odometry")?;
        let pose = |pose: [f64; 3]| SE2::from_components(&pose).unwrap_or_else(SE2::identity);
        let time = self.time()?;
        let (laser, robot) = (pose(laser), pose(robot));
        Ok(Message::Scan(Box::new(Scan { line, time, robot, laser, angles, max_range, ranges })))
    }

    /// The third field from the end, in microseconds.
    fn time(&mut self) -> Result<i64, String> {
        self.next = self.words.len().checked_sub(3).ok_or("it has no time")?.max(self.next);
        let seconds = self.number("ipc_timestamp")?;
        if !(0.0..LATEST).contains(&seconds) {
            return Err(format!("its ipc_timestamp is {seconds}, which are no seconds"));
        }
        Ok((seconds * 1e6).round() as i64)
    }
}
