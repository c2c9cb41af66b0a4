//! Laser scans at the keyframes, from `hokuyo_30m.bin`.

use posecut_geometry::{LieGroup, SE2};
use posecut_graph::PoseGraph;
use posecut_nclt_sensors::Hokuyo;
use posecut_scan::LaserScan;

use crate::odometry::Reader;
use crate::{Event, FileKind, IngestError, Trajectory, Warning};

/// The scan of a keyframe is taken within this time of it, microseconds. The odometry between both goes into the pose of the scanner.
const WITHIN: u64 = 250_000;

/// The laser scans of a session.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Laser {
    /// The scan of each keyframe that has one, by node.
    pub scans: Vec<(u64, LaserScan)>,
    /// Usable scans in the file.
    pub in_file: usize,
    /// Scans whose time does not advance, which were left out.
    pub out_of_order: usize,
    /// Keyframes without a scan near them in time.
    pub keyframes_without: usize,
    /// Scans of keyframes without any return.
    pub empty: usize,
}

/// The scan nearest in time to each keyframe; `None` if the session has no file of scans. O(records + keyframes * (log records + beams)).
pub(crate) fn read(
    reader: &mut Reader<'_>,
    graph: &PoseGraph,
    odometry: &Trajectory,
) -> Result<Option<Laser>, IngestError> {
    let Some(content) = reader.files.content(FileKind::Hokuyo)? else { return Ok(None) };
    (reader.report)(Event::Opened { name: &content.name, bytes: &content.bytes });
    let file = Hokuyo::parse(&content.shown, &content.bytes)?;
    (reader.report)(Event::Parsed(content.bytes.len() as u64));
    let mut laser = Laser { in_file: file.len(), out_of_order: file.out_of_order, ..Laser::default() };
    for node in &graph.nodes {
        let scan = node.utime.and_then(|time| {
            let index = file.nearest(time, WITHIN)?;
            Some(file.scan(index, &motion(odometry, time, file.time(index))?))
        });
        match scan {
            None => laser.keyframes_without += 1,
            Some(scan) => {
                laser.empty += usize::from(scan.returns() == 0);
                laser.scans.push((node.id, scan));
            }
        }
    }
    check(&content.shown, &laser, graph.nodes.len())?;
    if laser.out_of_order + laser.keyframes_without + laser.empty > 0 {
        reader.warn(Warning::Scans {
            file: content.shown,
            out_of_order: laser.out_of_order,
            keyframes_without: laser.keyframes_without,
            empty: laser.empty,
        });
    }
    Ok(Some(laser))
}

/// The motion in the plane between two times, by odometry. `None` where the odometry has a gap or ends.
fn motion(odometry: &Trajectory, from: i64, to: i64) -> Option<SE2> {
    if from == to {
        return Some(SE2::new(0.0, 0.0, 0.0));
    }
    Some(odometry.at(from)?.to_planar().between(&odometry.at(to)?.to_planar()))
}

/// Refuses a file that has nothing for this session.
fn check(file: &str, laser: &Laser, keyframes: usize) -> Result<(), IngestError> {
    if laser.scans.is_empty() {
        return Err(IngestError::session(
            file,
            format!(
                "none of its {} scans is within {} s of one of the {keyframes} keyframes",
                laser.in_file,
                WITHIN as f64 * 1e-6
            ),
            "name the file of the same session",
        ));
    }
    if laser.empty == laser.scans.len() {
        return Err(IngestError::session(
            file,
            format!("all {} scans at keyframes are without a return from 0.1 to 30 m", laser.empty),
            "check that the file is NCLT's hokuyo_30m.bin, or remove it from the session",
        ));
    }
    Ok(())
}
