//! A log from a seed.

use std::io::Write;

use posecut_carmen::{LoggedScan, write_scan};
use posecut_geometry::SE2;
use posecut_random::random;

use crate::drive::{PERIOD, drive};
use crate::plan::Plan;
use crate::route::route;
use crate::{Options, sensors};

/// The time of the first scan, microseconds.
const START: i64 = 1_000_000_000;

/// A simulated log.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// The building.
    pub plan: Plan,
    /// Scans with odometry.
    pub scans: Vec<LoggedScan>,
    /// The true pose at each scan.
    pub truth: Vec<SE2>,
}

/// Simulates a log. O(scans * beams * walls).
pub fn simulate(options: &Options) -> Simulated {
    let plan = Plan::new(options.building, options.blocks as usize);
    let truth = drive(&route(&plan, options.seed, options.length), options.length);
    let odometry = sensors::odometry(&truth, options.slip, &mut random(options.seed, "odometry"));
    let mut noise = random(options.seed, "ranges");
    let scans = truth.iter().zip(&odometry).enumerate().map(|(index, (pose, robot))| LoggedScan {
        line: 0,
        time: START + PERIOD * index as i64,
        robot: *robot,
        scan: sensors::scan(&plan.walls, pose, options.range_noise, &mut noise),
    });
    let scans = scans.collect();
    Simulated { plan, scans, truth }
}

impl Simulated {
    /// The times of the scans, microseconds.
    pub fn times(&self) -> Vec<i64> {
        self.scans.iter().map(|scan| scan.time).collect()
    }

    /// The length of the true path, metres.
    pub fn path_length(&self) -> f64 {
        self.truth.windows(2).map(|pair| (pair[1].translation - pair[0].translation).norm()).sum()
    }

    /// Writes the log, with the true poses as `TRUEPOS` lines.
    pub fn write_log(&self, options: &Options, writer: &mut dyn Write) -> std::io::Result<()> {
        writeln!(writer, "# CARMEN log simulated by posecut-simulate-log")?;
        writeln!(
            writer,
            "# seed {}, building {}, blocks {}, length {} m, range noise {} m, slip {}",
            options.seed, options.building, options.blocks, options.length, options.range_noise, options.slip
        )?;
        writeln!(writer, "# message_name [message contents] ipc_timestamp ipc_hostname logger_timestamp")?;
        writeln!(writer, "PARAM robot_frontlaser_offset 0.0 nohost 0")?;
        for (scan, truth) in self.scans.iter().zip(&self.truth) {
            write_scan(scan, Some(truth), writer)?;
        }
        Ok(())
    }
}
