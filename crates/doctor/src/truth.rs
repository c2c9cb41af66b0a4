//! Ground truth: whether there is any, and whether the covariances describe the errors.
//!
//! [`nees`] has the normalised estimation errors.

mod nees;

use posecut_geometry::LieGroup as _;
use posecut_graph::{EdgeKind, for_dimension};

use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Survey, length};
use crate::words::{counted, figure};
use nees::{Nees, landmark, odometry};

/// A factor between squared errors and covariances beyond which methods fail: errors three times as large as stated. The truth
/// has errors of its own, so a smaller one proves nothing.
const FACTOR: f64 = 10.0;
/// A longer window has less than this share of the value of a shorter one if most of it comes from errors of the truth.
const FALLING: f64 = 0.5;
/// Path lengths that differ by more than this share come from another scale.
const SCALE: f64 = 0.05;
/// Fewer windows prove nothing.
const FEWEST: usize = 10;

pub(crate) fn check(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    let nodes = &survey.graph.nodes;
    let truth =
        nodes.iter().filter(|node| node.truth.as_ref().is_some_and(|truth| truth.pose.is_some())).count();
    let labels = |correct| {
        survey.graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.truth_correct() == Some(correct)).count()
    };
    let (correct, incorrect) = (labels(true), labels(false));
    if truth == 0 && correct + incorrect == 0 {
        return;
    }
    let title = format!(
        "{truth} of {} with a true pose; landmark edges labelled: {correct} correct, {incorrect} incorrect",
        counted(nodes.len(), "node")
    );
    found.push(
        Finding::new(Severity::Note, Topic::Truth, "truth", title)
            .with("nodes", truth)
            .with("correct", correct)
            .with("incorrect", incorrect),
    );
    if truth == 0 {
        return;
    }
    found.extend(path_length(survey));
    for_dimension!(survey.graph.header.dimension, |G, DOF| {
        found.extend(consistency(EdgeKind::Odometry, &odometry::<G, DOF>(survey)));
        found.extend(consistency(EdgeKind::Landmark, &landmark::<G, DOF>(survey)));
    });
}

/// The path by odometry compared with the true one.
fn path_length(survey: &Survey<'_>) -> Option<Finding> {
    let dimension = survey.graph.header.dimension;
    let truth = |node: usize| dimension.spatial(survey.graph.nodes[node].truth.as_ref()?.pose.as_deref()?);
    let (mut measured, mut real) = (0.0, 0.0);
    for edge in &survey.odometry {
        if let (Some(motion), Some(from), Some(to)) = (&edge.motion, truth(edge.ends.0), truth(edge.ends.1)) {
            measured += length(motion);
            real += length(&from.between(&to));
        }
    }
    let ratio = measured / real;
    if !(ratio.is_finite() && ratio > 0.0) {
        return None;
    }
    let off = (ratio - 1.0).abs() > SCALE;
    let severity = if off { Severity::Warning } else { Severity::Note };
    let title = format!(
        "the path by odometry is {} times as long as the true one ({} m)",
        figure(ratio),
        figure(real)
    );
    let found = Finding::new(severity, Topic::Truth, "path-length", title)
        .with("ratio", ratio)
        .with("true_length", real);
    Some(if off {
        found.therefore(
            "an error of scale adds up over the path, unlike the independent errors that covariances describe",
            "check units and wheel size (posecut-ingest --wheel-scale corrects it); noise in the truth also lengthens its path",
        )
    } else {
        found
    })
}

fn consistency(kind: EdgeKind, nees: &[Nees]) -> Option<Finding> {
    let first = nees.first()?;
    let last = nees.iter().rposition(|nees| nees.windows >= FEWEST);
    let judged = last.map(|last| &nees[last]);
    // Errors of the truth itself do not add up over a window, so what they contribute falls with its length.
    let falls =
        last.filter(|&last| last > 0).is_some_and(|last| nees[last].value < FALLING * nees[last - 1].value);
    let shown: Vec<String> = nees.iter().map(ToString::to_string).collect();
    let what = match kind {
        EdgeKind::Odometry => "odometry",
        EdgeKind::Landmark => "correct landmark edges",
    };
    let title =
        format!("NEES of {what} per degree of freedom (95 % interval if right): {}", shown.join(", "));
    let is_bad = |judged: &&Nees| {
        judged.value < 1.0 / FACTOR && judged.value < judged.expected[0] || judged.value > FACTOR && !falls
    };
    let bad = judged.filter(is_bad);
    let severity = if bad.is_some() { Severity::Warning } else { Severity::Note };
    let name = if kind == EdgeKind::Odometry { "odometry-nees" } else { "landmark-nees" };
    let found = Finding::new(severity, Topic::Truth, name, title).with("windows", nees);
    let Some(bad) = bad else {
        let noise = if falls && first.value > FACTOR {
            "noise of the truth itself raises it over short windows"
        } else {
            ""
        };
        return Some(found.therefore(noise, ""));
    };
    let scale = figure(bad.value);
    let consequence = if bad.value > 1.0 {
        let grows = first.value * 2.0 < bad.value;
        let grows = if grows { ", and it grows with the window, as errors that accumulate do" } else { "" };
        format!(
            "the covariances of {what} are {scale} times too small over {}{grows}: correct edges look wrong",
            bad.span()
        )
    } else {
        let factor = figure(1.0 / bad.value);
        format!(
            "the covariances of {what} are {factor} times too large over {}: wrong edges look right",
            bad.span()
        )
    };
    let remedy = format!(
        "multiply these covariances by {scale} (posecut pcm --scale {}); posecut-verify estimates a factor by itself",
        scale_argument(kind, &scale)
    );
    Some(found.therefore(consequence, remedy))
}

/// The argument of `--scale` that multiplies the covariances of one kind.
fn scale_argument(kind: EdgeKind, scale: &str) -> String {
    match kind {
        EdgeKind::Odometry => format!("{scale},1"),
        EdgeKind::Landmark => format!("1,{scale}"),
    }
}
