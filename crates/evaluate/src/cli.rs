//! The command line of `posecut-evaluate`: compares an estimate with a reference and writes one JSON result.

use std::process::ExitCode;

use crate::alignment::Freedom;
use crate::edges::EdgeScores;
use crate::relations::{RelationErrors, Track, relation_errors, relations};
use crate::result::AlignmentUsed;
use crate::summary::Summary;
use crate::{Options, Scope, evaluate_with_relations};
use anyhow::bail;
use clap::Parser;
use posecut_graph::{PoseGraph, StageDoubt};
use posecut_stage::{
    CommonArguments, Context, Doubt, Examples, Identity, Outcome, Phase, Place, Source, counted, info,
    run_with_doubts,
};

#[derive(Parser)]
struct Command {
    /// Evaluate this optimised pose graph; `-` is standard input
    #[arg(value_name = "ESTIMATE", default_value = "-")]
    estimate: Source,

    /// Compare with this graph, matched by node ids [default: the estimate's own ground truth]
    #[arg(long, value_name = "FILE")]
    reference: Option<Source>,

    /// Compare relative motions with those of this file, a line `t1 t2 x y z roll pitch yaw` each, in seconds, metres and radians
    #[arg(long, value_name = "FILE", help_heading = "Relations")]
    relations: Option<Source>,

    /// Find the poses between keyframes along this trajectory (TUM format) and not along geodesics
    #[arg(long, value_name = "FILE", requires = "relations", help_heading = "Relations")]
    trajectory: Option<Source>,

    /// Use the first or last keyframe of a session for times up to this before or after it, seconds
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 0.5,
        requires = "relations",
        help_heading = "Relations"
    )]
    relations_tolerance: f64,

    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    ("Compare with the ground truth in the graph", "posecut evaluate map.jsonl -o map.result.json"),
    (
        "Compare with another graph, and label the result for tables",
        "posecut evaluate map.jsonl --reference reference.jsonl \\\n    --label method=pcm --label session=2012-01-22 -o map.result.json",
    ),
    (
        "Compare with relations between times",
        "posecut evaluate map.jsonl --relations aces.relations -o map.result.json",
    ),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "evaluate",
        version: env!("CARGO_PKG_VERSION"),
        about: "Compare an estimate with a reference: RMSE, ATE, RPE, and precision and recall of landmark edges",
        place: Place(Phase::Results, 10),
        examples: EXAMPLES,
    };
    run_with_doubts::<Command>(
        identity,
        &[Doubt::PartsNotConnected],
        |command| &command.common,
        |command, context| {
            let estimate = context.read_graph(&command.estimate, "estimate")?;
            let reference = command
                .reference
                .as_ref()
                .map(|source| context.read_graph(source, "reference"))
                .transpose()?;
            let relations = compare_relations(command, &estimate, context)?;
            let mut result =
                evaluate_with_relations(&estimate, reference.as_ref(), relations, &command.options)?;
            if let Some(rmse) = result.rmse {
                let poses = counted(result.poses, "pose");
                info!("RMSE {rmse:.3} m over {poses} {}", alignment(&result.alignment));
            }
            if let Some(relations) = &result.relations {
                info!("{}", described(relations));
            }
            if let Some(edges) = &result.edges {
                info!("{}", scores(edges));
            }
            let aligned = result.alignment.found.len();
            if result.alignment.scope == Scope::PerComponent && aligned > 1 {
                context.doubt(
                    Doubt::PartsNotConnected,
                    format!(
                        "the {aligned} components of the reference are aligned separately, so the RMSE does not measure their \
                         relative poses; use --scope joint to include them"
                    ),
                );
            }
            let own = |doubt: &str| StageDoubt { stage: identity.name.to_owned(), doubt: doubt.to_owned() };
            result.doubts.extend(context.doubts().into_iter().map(own));
            context.statistics.note("rmse", result.rmse);
            context.statistics.note("poses", result.poses);
            context.statistics.note("relations", &result.relations);
            context.statistics.note("edges", &result.edges);
            let mut bytes = serde_json::to_vec_pretty(&result)?;
            bytes.push(b'\n');
            context.write_bytes(&bytes)?;
            Ok(Outcome::Done)
        },
    )
}

/// The errors of the relations that the command line names.
fn compare_relations(
    command: &Command,
    estimate: &PoseGraph,
    context: &mut Context,
) -> anyhow::Result<Option<RelationErrors>> {
    let Some(source) = &command.relations else { return Ok(None) };
    let tolerance = command.relations_tolerance;
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        bail!("--relations-tolerance is {tolerance}, but must be a number of seconds from 0 on");
    }
    let (place, bytes) = context.read_bytes(source, "relations")?;
    let known = relations(&place, &bytes[..])?;
    let track = match &command.trajectory {
        None => None,
        Some(source) => {
            let (place, bytes) = context.read_bytes(source, "trajectory")?;
            Some(Track::read(&place, &bytes[..])?)
        }
    };
    let errors = relation_errors(estimate, &known, track.as_ref(), tolerance);
    if errors.compared == 0 {
        bail!(
            "{place}: none of its {} has both times within the times of the estimate's nodes (utime); name the file that belongs to \
             the log, or increase --relations-tolerance",
            counted(known.len(), "relation")
        );
    }
    Ok(Some(errors))
}

/// Mean and standard deviation of the errors of relations in words.
fn described(relations: &RelationErrors) -> String {
    let mean = |summary: &Option<Summary>| summary.map_or((0.0, 0.0), |summary| (summary.mean, summary.std));
    let (distance, distance_deviation) = mean(&relations.translation_m);
    let (angle, angle_deviation) = mean(&relations.rotation_rad);
    format!(
        "relative errors {distance:.4} +- {distance_deviation:.4} m, {:.3} +- {:.3} degrees over {}, {} skipped",
        angle.to_degrees(),
        angle_deviation.to_degrees(),
        counted(relations.compared, "relation"),
        relations.skipped
    )
}

/// Precision and recall of the landmark edges in words.
fn scores(edges: &EdgeScores) -> String {
    let share =
        |share: Option<f64>| share.map_or_else(|| "undefined".to_owned(), |share| format!("{share:.4}"));
    format!(
        "precision {}, recall {}: {} of {} in use incorrect, {} of {} rejected",
        share(edges.precision),
        share(edges.recall),
        edges.false_positive,
        counted(edges.true_positive + edges.false_positive, "landmark edge"),
        edges.false_negative,
        counted(edges.true_positive + edges.false_negative, "correct edge"),
    )
}

/// The alignment in words.
fn alignment(used: &AlignmentUsed) -> String {
    match used.freedom {
        Freedom::None => "without alignment".to_owned(),
        freedom => format!("after {} alignment of {}", freedom.name(), used.scope.name()),
    }
}
