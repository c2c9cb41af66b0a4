//! Reports what a reader repaired, skipped, added or inferred.

use posecut_stage::{Context, Doubt, counted, info, warn};

use crate::{NextIds, g2o, jrl};

/// Reports on standard error, in the statistics and as a doubt what the reader of g2o and TORO did.
pub(super) fn vertices_and_edges(name: &str, summary: &g2o::ReadSummary, context: &mut Context) {
    if summary.repaired > 0 {
        context.doubt(
            Doubt::CovarianceInvented,
            format!(
                "{name}: {} not positive semidefinite, so negative eigenvalues are set to zero; export the sensor's own covariances",
                match summary.repaired {
                    1 => "1 information matrix is".to_owned(),
                    count => format!("{count} information matrices are"),
                }
            ),
        );
    }
    if let Some((line, from, to)) = summary.first_open {
        warn!(
            "{name}: {} with an information matrix that may be singular within the rounding of its printed digits (first: edge {from} {to} in line {line}); used unchanged",
            counted(summary.open, "edge")
        );
    }
    for (tag, count) in &summary.skipped {
        warn!("{name}: skipped {} of type {tag}", counted(*count, "line"));
    }
    if summary.without_vertex > 0 {
        let nodes = counted(summary.without_vertex, "node");
        info!("{name}: added {nodes} without a pose, because edges name them but no vertex line does");
    }
    next_ids(name, &summary.next_ids);
    context.statistics.note("repaired_information", summary.repaired);
    context.statistics.note("open_information", summary.open);
    context.statistics.note("skipped_lines", summary.skipped.values().sum::<usize>());
    context.statistics.note("nodes_without_vertex", summary.without_vertex);
}

/// Reports on standard error and in the statistics what the reader of JRL did.
pub(super) fn dataset(name: &str, summary: &jrl::ReadSummary, context: &mut Context) {
    for (kind, count) in &summary.skipped {
        warn!("{name}: skipped {} of type {kind}", counted(*count, "record"));
    }
    if summary.priors > 0 {
        warn!(
            "{name}: left out {} on the first pose of a robot, because one prior anchors the graph already",
            counted(summary.priors, "prior")
        );
    }
    if summary.without_value > 0 {
        let nodes = counted(summary.without_value, "node");
        info!("{name}: added {nodes} without a pose, because the initialization does not have them");
    }
    next_ids(name, &summary.next_ids);
    context.statistics.note("skipped_lines", summary.skipped.values().sum::<usize>());
    context.statistics.note("priors_left_out", summary.priors);
    context.statistics.note("labelled_edges", summary.labelled);
    context.statistics.note("nodes_without_vertex", summary.without_value);
}

fn next_ids(name: &str, found: &[NextIds]) {
    for found in found {
        info!(
            "{name}: no edge joins ids n and n + 1, so {} between an id and the next larger one (first: {} {}) became odometry; --odometry consecutive reads such edges as landmark edges",
            counted(found.edges, "edge"),
            found.first.0,
            found.first.1
        );
    }
}
