//! What is said of matched scans, of NCLT sessions and of logs.

use posecut_matching::laser_odometry::Comparison;
use posecut_stage::{Statistics, counted, info};

/// Reports how many steps were matched.
pub(super) fn report(comparison: Option<&Comparison>) {
    if let Some(comparison) = comparison {
        info!(
            "{} matched; {} whose match contradicts the odometry; odometry alone for {} without a match",
            counted(comparison.matched, "step"),
            comparison.contradicting,
            comparison.unmatched
        );
    }
}

/// Notes the same with how far odometry and scans are apart.
pub(super) fn note(comparison: Option<&Comparison>, statistics: &mut Statistics) {
    statistics.note("scan_matching", comparison);
}
