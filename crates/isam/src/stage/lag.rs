//! The options of a lag, and lags in seconds.

use std::collections::VecDeque;

use anyhow::{Context as _, ensure};
use posecut_graph::Node;
use serde::Serialize;

use crate::IncrementalOptions;
use crate::lag::BLOCKS;

/// What happens to an edge that reaches a marginalised node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum BeyondLag {
    /// End with an error that names the edge
    #[default]
    Refuse,
    /// Mark the edge with `rejected_by: "lag"`, count it, and go on
    Reject,
}

/// The options of a lag.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, clap::Args)]
pub struct LagOptions {
    /// Marginalise poses older than the newest N: bounds memory and time per step [default: keep all poses]
    ///
    /// Marginalised poses keep their last estimate in the output. Their edges turn into a prior on the poses around them, linear
    /// about frozen relative poses, and can no longer be retracted. Poses leave in blocks of N/10. Fixed poses stay. For example,
    /// `--lag 1000`.
    #[arg(long, value_name = "N", help_heading = "Bounded memory")]
    pub lag: Option<usize>,

    /// Marginalise poses older than the newest by more than this, seconds, as `--lag` does; every node needs a `utime`
    #[arg(long, value_name = "SECONDS", conflicts_with = "lag", help_heading = "Bounded memory")]
    pub lag_time: Option<f64>,

    /// Keep every K-th pose beyond the lag, so that landmark edges can still reach it
    ///
    /// Memory grows with the session. Priors over many keyframes fill in where marginalised poses had landmark edges.
    #[arg(long, value_name = "K", help_heading = "Bounded memory")]
    pub keep_every: Option<usize>,

    /// Keep the poses that have a landmark edge when the lag passes them
    ///
    /// Memory grows with the number of such poses. The others have odometry only, so that every prior joins two poses, as an edge
    /// does.
    #[arg(long, help_heading = "Bounded memory")]
    pub keep_landmark_poses: bool,

    /// What to do with an edge that reaches a marginalised pose
    #[arg(long, value_enum, default_value_t, value_name = "ACTION", help_heading = "Bounded memory")]
    pub beyond_lag: BeyondLag,
}

impl LagOptions {
    /// Checks that the options belong together.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        if let Some(seconds) = self.lag_time {
            ensure!(
                seconds > 0.0 && seconds.is_finite(),
                "--lag-time is {seconds}, but must be a positive number of seconds"
            );
        }
        let has_lag = self.lag.is_some() || self.lag_time.is_some();
        for (name, given) in [
            ("--keep-every", self.keep_every.is_some()),
            ("--keep-landmark-poses", self.keep_landmark_poses),
            ("--beyond-lag reject", self.beyond_lag == BeyondLag::Reject),
        ] {
            ensure!(
                has_lag || !given,
                "{name} has no effect without a lag; give --lag or --lag-time, or leave it out"
            );
        }
        Ok(())
    }

    /// The options of the library.
    pub(super) fn add_to(&self, options: IncrementalOptions) -> IncrementalOptions {
        let Self { lag, keep_every, keep_landmark_poses, .. } = *self;
        IncrementalOptions { lag, keep_every, keep_landmark_poses, ..options }
    }
}

/// The times of the nodes that a lag in seconds has not passed.
#[derive(Debug)]
pub(super) struct TimeWindow {
    /// Microseconds.
    lag: Option<i64>,
    times: VecDeque<i64>,
    /// Number of nodes that have passed.
    passed: usize,
}

impl TimeWindow {
    pub(super) fn new(seconds: Option<f64>) -> Self {
        Self { lag: seconds.map(|seconds| (seconds * 1e6) as i64), times: VecDeque::new(), passed: 0 }
    }

    /// Notes the time of a new node.
    pub(super) fn add(&mut self, node: &Node) -> anyhow::Result<()> {
        if self.lag.is_some() {
            let time = node.utime.with_context(|| {
                format!(
                    "node {} has no field \"utime\", which --lag-time needs; give it one, or use --lag",
                    node.id
                )
            })?;
            self.times.push_back(time);
        }
        Ok(())
    }

    /// The number of nodes that have passed, if the next block is due: once the oldest exceeds the lag by a tenth.
    pub(super) fn due(&mut self) -> Option<usize> {
        let (lag, newest) = (self.lag?, *self.times.back()?);
        let age = |time: Option<&i64>| time.map_or(0, |&time| newest.saturating_sub(time));
        if age(self.times.front()) <= lag.saturating_add(lag / BLOCKS as i64) {
            return None;
        }
        while age(self.times.front()) > lag {
            self.times.pop_front();
            self.passed += 1;
        }
        Some(self.passed)
    }
}
