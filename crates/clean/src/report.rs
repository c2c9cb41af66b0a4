//! What a run says: the summary, warnings and statistics.

use posecut_graph::{EdgeKind, PoseGraph};
use posecut_stage::{Context, info, warn};
use posecut_verify::verdict::Verdict;
use posecut_verify::{Undecided, Verification};

use crate::command::Command;
use crate::run::Cleaned;
use crate::summary::{self, Input};

/// Prints the summary, and raises the doubts.
pub(crate) fn report(
    command: &Command,
    input: &Input,
    cleaned: &Cleaned,
    graph: &PoseGraph,
    context: &mut Context,
) -> anyhow::Result<()> {
    let keep_undecided = command.judgement.undecided == Undecided::Keep;
    info!("{}", input.line());
    for text in summary::edges(graph, cleaned.verified(), keep_undecided) {
        info!("{text}");
    }
    info!("{}", summary::poses(cleaned.movement, &cleaned.optimization));
    for text in summary::doubtful(&cleaned.findings) {
        info!("{text}");
    }
    explain(command, cleaned.verified(), graph)?;
    if let Some(warning) = cleaned.verified().and_then(|found| found.warning.as_ref()) {
        warn!("{warning}");
    }
    for (doubt, sentence) in &cleaned.doubts {
        context.doubt(*doubt, sentence);
    }
    note(cleaned, input, graph, context);
    Ok(())
}

fn explain(command: &Command, verification: Option<&Verification>, graph: &PoseGraph) -> anyhow::Result<()> {
    let (Some(id), Some(verification)) = (command.explain, verification) else { return Ok(()) };
    for line in verification.story(graph, id)? {
        info!("{line}");
    }
    Ok(())
}

fn note(cleaned: &Cleaned, input: &Input, graph: &PoseGraph, context: &mut Context) {
    let in_use = graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.in_use()).count();
    let count = |verdict| cleaned.verified().map(|found| found.count(verdict));
    let optimized = |name: &str| cleaned.optimization.as_map().get(name).cloned();
    let statistics = &mut context.statistics;
    statistics.note("sessions", input.sessions);
    statistics.note("nodes", input.poses);
    statistics.note("landmark_edges", input.landmark);
    statistics.note("in_use", in_use);
    statistics.note("accepted", count(Verdict::Accepted));
    statistics.note("rejected", count(Verdict::Rejected).unwrap_or(input.landmark - in_use));
    statistics.note("undecided", count(Verdict::Undecided));
    statistics.note("rivals", cleaned.verified().map(|found| &found.rivals));
    statistics.note("calibration", cleaned.verified().map(|found| &found.calibration));
    statistics.note("moved_median", cleaned.movement.map(|moved| moved.median));
    statistics.note("moved_most", cleaned.movement.map(|moved| moved.most));
    statistics
        .note("findings", summary::problems(&cleaned.findings).map(|found| found.name).collect::<Vec<_>>());
    statistics.note("cost", optimized("cost"));
    statistics.note("converged", optimized("converged"));
}
