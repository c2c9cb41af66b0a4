//! Writes logs.

use std::io::Write;

use posecut_geometry::{LieGroup, SE2};

use crate::log::LoggedScan;

/// What a beam without a return has in a log: the maximum of SICK scanners, metres.
const NO_RETURN: f64 = 81.91;

/// Writes the lines of a moment: `TRUEPOS` if the true pose is known, `ODOM`, and the scan as `FLASER`. Ranges have two digits and poses
/// six, as CARMEN writes them. The scanner must look forward as `FLASER` demands: the beams begin at the right end.
pub fn write_scan(scan: &LoggedScan, truth: Option<&SE2>, writer: &mut dyn Write) -> std::io::Result<()> {
    let pose =
        |pose: &SE2| format!("{:.6} {:.6} {:.6}", pose.translation.x, pose.translation.y, pose.angle());
    let seconds = seconds(scan.time);
    let end = format!("{seconds} nohost {seconds}");
    let robot = pose(&scan.robot);
    if let Some(truth) = truth {
        writeln!(writer, "TRUEPOS {} {robot} {end}", pose(truth))?;
    }
    writeln!(writer, "ODOM {robot} 0.000000 0.000000 0.000000 {end}")?;
    write!(writer, "FLASER {}", scan.scan.ranges.len())?;
    for range in &scan.scan.ranges {
        write!(writer, " {:.2}", if *range > 0.0 { *range } else { NO_RETURN })?;
    }
    writeln!(writer, " {} {robot} {end}", pose(&scan.robot.compose(&scan.scan.sensor)))
}

/// Microseconds as seconds with six digits.
pub fn seconds(time: i64) -> String {
    format!("{}.{:06}", time / 1_000_000, time % 1_000_000)
}
