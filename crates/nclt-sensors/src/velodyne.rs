//! `velodyne_sync/UTIME.bin`: the hits of one turn of a Velodyne HDL-32E, taken at the time that names the file.
//!
//! A record has 8 bytes, little-endian: x, y, z as `u16` ([`scaled`]), the intensity and the number of the laser as `u8`
//! (`read_vel_sync.py`). The points are in the frame of the body, x forward, y right, z down: `project_vel_to_cam.py` of the dataset
//! carries them to the camera by the pose of the camera in the body.

use std::io::{self, Write};

use nalgebra::Vector3;

use crate::{SensorError, scaled};

/// Bytes of a record.
pub const HIT: usize = 8;

/// A point that the scanner saw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// In the frame of the body, metres.
    pub point: Vector3<f64>,
    /// The strength of the return.
    pub intensity: u8,
    /// The number of the laser, 0 to 31.
    pub laser: u8,
}

/// Reads the hits of a file, whose name is `place` in messages. O(hits).
///
/// # Errors
///
/// The file is empty, or its last record is cut.
pub fn read_hits(place: &str, bytes: &[u8]) -> Result<Vec<Hit>, SensorError> {
    if bytes.is_empty() {
        return Err(SensorError::File {
            place: place.to_owned(),
            problem: "it is empty".to_owned(),
            remedy: "download it again, or delete it: its keyframe then has no points",
        });
    }
    let (records, cut) = bytes.as_chunks::<HIT>();
    if !cut.is_empty() {
        return Err(SensorError::Record {
            place: place.to_owned(),
            record: records.len() + 1,
            problem: format!("has {} of {HIT} bytes", cut.len()),
            remedy: "download the file again, or cut it after the record before",
        });
    }
    let length = |low, high| scaled::length(u16::from_le_bytes([low, high]));
    let hit = |[a, b, c, d, e, f, intensity, laser]: [u8; HIT]| Hit {
        point: Vector3::new(length(a, b), length(c, d), length(e, f)),
        intensity,
        laser,
    };
    Ok(records.iter().copied().map(hit).collect())
}

/// Writes hits. Coordinates are rounded to 5 mm.
pub fn write_hits(hits: &[Hit], writer: &mut dyn Write) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(HIT * hits.len());
    for hit in hits {
        for coordinate in &hit.point {
            bytes.extend(scaled::value(*coordinate).to_le_bytes());
        }
        bytes.extend([hit.intensity, hit.laser]);
    }
    writer.write_all(&bytes)
}

/// The time in the name of a file of `velodyne_sync`, microseconds.
pub fn time_of_name(name: &str) -> Option<i64> {
    name.strip_suffix(".bin")?.parse().ok()
}
