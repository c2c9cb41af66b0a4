//! `hokuyo_30m.bin`: the scans of a Hokuyo UTM-30LX.
//!
//! A record has 2170 bytes, little-endian: the time in microseconds as `u64`, then 1081 ranges as `u16`
//! ([`scaled`]). The beams begin at -135 degrees and are 0.25 degrees apart (`read_hokuyo_30m.py`: `rad0`, `radstep`,
//! `num_hits`), anticlockwise seen from above.
//!
//! The scanner is level, 0.28 m in front of the origin of the body, and looks forwards. This is not in `read_hokuyo_30m.py`: it is the
//! transform of nclt2ros (`converter/hokuyo_data.py`), a converter of the dataset for ROS. That converter turns its scans, which it says
//! begin at -90 degrees, by -45 degrees: the same first beam.

use std::io::{self, Write};

use posecut_geometry::{LieGroup, SE2};
use posecut_scan::LaserScan;

use crate::times::nearest;
use crate::{SensorError, scaled};

/// Beams of a scan.
pub const BEAMS: usize = 1081;

/// Bytes of a record.
pub const RECORD: usize = 8 + 2 * BEAMS;

/// Direction of the first beam, radians anticlockwise from forwards, seen from above.
pub const FIRST_ANGLE: f64 = -0.75 * std::f64::consts::PI;

/// Angle from one beam to the next, radians.
pub const ANGLE_STEP: f64 = 0.25 * std::f64::consts::PI / 180.0;

/// The scanner is in front of the origin of the body, metres.
pub const FORWARD: f64 = 0.28;

/// The ranges that count as returns, metres: what the data sheet of the UTM-30LX guarantees.
pub const RANGES: std::ops::Range<f64> = 0.1..30.0;

/// What a beam without a return has in files that [`write_hokuyo_scan`] writes.
const NO_RETURN: u16 = u16::MAX;

/// If more than one record in this many goes back in time, the clock is broken: that is more than jitter.
const LARGEST_REVERSED_SHARE: usize = 100;

/// The checked records of a file, which are decoded on demand: at the 40 Hz of the scanner, an hour and a half has 200 000 of them.
#[derive(Clone, Debug)]
pub struct Hokuyo<'a> {
    bytes: &'a [u8],
    /// The time and the position of each usable record; times ascend strictly.
    records: Vec<(i64, usize)>,
    /// Records that were left out because their time does not advance.
    pub out_of_order: usize,
}

impl<'a> Hokuyo<'a> {
    /// Checks the records of a file, whose name is `place` in messages. Records whose time does not advance are left out and counted.
    /// O(records).
    ///
    /// # Errors
    ///
    /// The file is empty, its last record is cut, a time is beyond 63 bits, or more than 1 in 100 records go back in time.
    pub fn parse(place: &str, bytes: &'a [u8]) -> Result<Self, SensorError> {
        let file = |problem: String, remedy| SensorError::File { place: place.to_owned(), problem, remedy };
        let refused = |record: usize, problem: String, remedy| SensorError::Record {
            place: place.to_owned(),
            record: record + 1,
            problem,
            remedy,
        };
        if bytes.is_empty() {
            return Err(file("it is empty".to_owned(), "download it again"));
        }
        let (whole, cut) = (bytes.len() / RECORD, bytes.len() % RECORD);
        if cut > 0 {
            return Err(refused(
                whole,
                format!("has {cut} of {RECORD} bytes"),
                "download the file again, or cut it after the record before",
            ));
        }
        let mut found = Self { bytes, records: Vec::with_capacity(whole), out_of_order: 0 };
        let mut first_reversal = None;
        for (record, content) in bytes.chunks_exact(RECORD).enumerate() {
            let time = content.first_chunk::<8>().map_or(0, |time| u64::from_le_bytes(*time));
            let Ok(time) = i64::try_from(time) else {
                return Err(refused(
                    record,
                    format!("its time {time} is not in microseconds UTC"),
                    "check that the file is NCLT's hokuyo_30m.bin",
                ));
            };
            if found.records.last().is_some_and(|(last, _)| time <= *last) {
                found.out_of_order += 1;
                first_reversal.get_or_insert((record, time));
            } else {
                found.records.push((time, record));
            }
        }
        if let Some((record, time)) = first_reversal
            && found.out_of_order * LARGEST_REVERSED_SHARE > whole
        {
            return Err(refused(
                record,
                format!(
                    "its time {time} does not advance, and so are those of {} of {whole} records",
                    found.out_of_order
                ),
                "check that the file is NCLT's hokuyo_30m.bin, and download it again",
            ));
        }
        Ok(found)
    }

    /// The number of usable records.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// The time of a usable record.
    pub fn time(&self, index: usize) -> i64 {
        self.records[index].0
    }

    /// The usable record nearest to a time, the earlier of two; `None` if all are further away than `within` microseconds. O(log records).
    pub fn nearest(&self, time: i64, within: u64) -> Option<usize> {
        nearest(&self.records, time, within)
    }

    /// The ranges of a usable record, metres; 0 for a beam without a return in [`RANGES`]. O(beams).
    pub fn ranges(&self, index: usize) -> Vec<f64> {
        let start = self.records[index].1 * RECORD + 8;
        let (values, _) = self.bytes[start..start + 2 * BEAMS].as_chunks::<2>();
        let ranges = values.iter().map(|value| scaled::length(u16::from_le_bytes(*value)));
        ranges.map(|range| if RANGES.contains(&range) { range } else { 0.0 }).collect()
    }

    /// The scan of a usable record, in the frame of a body from which the body at the time of the scan has the pose `body`. In NCLT's
    /// frames angles are clockwise seen from above, so the angles of the beams descend. O(beams).
    pub fn scan(&self, index: usize, body: &SE2) -> LaserScan {
        LaserScan {
            sensor: body.compose(&SE2::new(FORWARD, 0.0, 0.0)),
            first_angle: -FIRST_ANGLE,
            angle_step: -ANGLE_STEP,
            ranges: self.ranges(index),
        }
    }
}

/// Writes a record. `ranges` are those of the beams, metres, 0 for a beam without a return. Missing ones have no return.
pub fn write_hokuyo_scan(time: u64, ranges: &[f64], writer: &mut dyn Write) -> io::Result<()> {
    let mut record = Vec::with_capacity(RECORD);
    record.extend(time.to_le_bytes());
    for beam in 0..BEAMS {
        let range = ranges.get(beam).copied().unwrap_or(0.0);
        let value = if range > 0.0 { scaled::value(range) } else { NO_RETURN };
        record.extend(value.to_le_bytes());
    }
    writer.write_all(&record)
}
