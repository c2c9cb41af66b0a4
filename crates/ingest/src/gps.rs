//! GPS as priors of positions in NCLT's local frame ([`posecut_geometry::geodetic`]), which is that of the ground truth.
//!
//! A row of `gps.csv` and `gps_rtk.csv` is `utime, mode, satellites, latitude, longitude, altitude, track, speed` in radians and
//! metres. The mode is that of gpsd: 3 is a fix in three dimensions, 2 one without altitude, and below there is none; then latitude
//! and longitude are NaN. Each keyframe gets the fix nearest in time, if it is near: errors of successive fixes are nearly the
//! same, and a prior for each would count one error many times.

use posecut_geometry::geodetic;
use posecut_graph::{Dimension, PoseGraph, Prior};
use serde::Serialize;

use crate::odometry::Reader;
use crate::{FileKind, IngestError, Options, Table};

/// A fix is used for a keyframe at most this many microseconds away, in which the robot moves less than its error.
const LONGEST_DELAY: i64 = 500_000;

/// A receiver of NCLT's robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum GpsSource {
    /// `gps.csv`, the consumer receiver
    Gps,
    /// `gps_rtk.csv`, the receiver with real-time kinematics
    Rtk,
    /// Both
    Both,
}

/// One receiver: its file, the `source` of its priors, and default standard deviations of fixes with and without altitude, metres
/// per horizontal axis. NCLT gives none: these are usual for such receivers among buildings.
struct Receiver {
    kind: FileKind,
    source: &'static str,
    sigmas: [f64; 2],
}

const CONSUMER: Receiver = Receiver { kind: FileKind::Gps, source: "gps", sigmas: [5.0, 15.0] };
const KINEMATIC: Receiver = Receiver { kind: FileKind::GpsRtk, source: "gps_rtk", sigmas: [1.0, 5.0] };

impl Receiver {
    /// The standard deviation of a fix of this mode; `None` if it is no fix.
    fn sigma(&self, mode: f64, options: &Options) -> Option<f64> {
        let [with_altitude, without] = self.sigmas;
        let default = if mode >= 3.0 { with_altitude } else { without };
        (mode >= 2.0).then(|| options.sigma_gps.unwrap_or(default))
    }
}

/// Adds the priors of the receivers that the options name to a session's graph.
pub(crate) fn add(
    reader: &mut Reader<'_>,
    graph: &mut PoseGraph,
    options: &Options,
) -> Result<(), IngestError> {
    let receivers = match options.gps {
        None => return Ok(()),
        Some(GpsSource::Gps) => &[CONSUMER][..],
        Some(GpsSource::Rtk) => &[KINEMATIC],
        Some(GpsSource::Both) => &[CONSUMER, KINEMATIC],
    };
    for receiver in receivers {
        // Rows without a fix have NaN and are left out, which is no fault.
        let table = reader.table_of_fixes(receiver.kind)?;
        add_fixes(&table, receiver, graph, options);
    }
    Ok(())
}

fn add_fixes(table: &Table, receiver: &Receiver, graph: &mut PoseGraph, options: &Options) {
    let fixes: Vec<usize> =
        (0..table.times.len()).filter(|&row| receiver.sigma(table.rows[row][0], options).is_some()).collect();
    for node in &graph.nodes {
        let Some(time) = node.utime else { continue };
        let Some(row) = nearest(&fixes, &table.times, time) else { continue };
        let [mode, satellites, latitude, longitude] = table.rows[row][..] else { continue };
        let Some(sigma) = receiver.sigma(mode, options) else { continue };
        let [north, east, _] = geodetic::to_local([latitude, longitude, 0.0]);
        let weight = 1.0 / (sigma * sigma);
        let (measurement, information) = match graph.header.dimension {
            Dimension::Two => (vec![north, east], vec![weight, 0.0, weight]),
            // Altitudes of GPS are the worst axis, and NCLT's ground truth has another origin there: they have no weight.
            Dimension::Three => (vec![north, east, 0.0], vec![weight, 0.0, 0.0, weight, 0.0, 0.0]),
        };
        let mut prior = Prior {
            id: graph.priors.len() as u64,
            node: node.id,
            measurement,
            information: Some(information),
            source: Some(receiver.source.to_owned()),
            ..Prior::default()
        };
        prior.extra.insert("mode".to_owned(), (mode as i64).into());
        prior.extra.insert("satellites".to_owned(), (satellites as i64).into());
        graph.priors.push(prior);
    }
}

/// The row nearest in time among ascending rows, if it is near enough; the earlier one of two.
fn nearest(rows: &[usize], times: &[i64], time: i64) -> Option<usize> {
    let after = rows.partition_point(|&row| times[row] < time);
    let candidates = [after.checked_sub(1), Some(after)];
    let near = candidates.into_iter().flatten().filter_map(|place| rows.get(place).copied());
    let apart = |row: &usize| times[*row].abs_diff(time);
    near.min_by_key(apart).filter(|row| apart(row) <= LONGEST_DELAY.unsigned_abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_fix_is_taken_if_it_is_near() {
        let times = [0, 400_000, 1_000_000, 3_000_000];
        let rows = [0, 1, 3];
        let found: Vec<_> = [-600_000, -1, 199_999, 200_001, 900_000, 900_001, 2_500_000, 3_500_001]
            .into_iter()
            .map(|time| nearest(&rows, &times, time))
            .collect();
        assert_eq!(found, [None, Some(0), Some(0), Some(1), Some(1), None, Some(3), None]);
    }
}
