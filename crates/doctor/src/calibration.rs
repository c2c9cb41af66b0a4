//! Factors on covariances, as posecut-verify estimates them from loops, and broken odometry.

use posecut_graph::{EdgeKind, for_dimension};
use posecut_verify::{Calibration, Verification, verify};
use serde::Serialize;

use crate::chains;
use crate::finding::{Finding, Severity, Topic};
use crate::survey::Survey;
use crate::words::{counted, figure, listed};

/// Factors that are credible if covariances are right. On small graphs with right covariances, estimates for odometry range from
/// 0.04 to 2.7, those for landmark edges from 0.4 to 1.
const ODOMETRY: std::ops::RangeInclusive<f64> = 1.0 / 30.0..=10.0;
const LANDMARK: std::ops::RangeInclusive<f64> = 0.25..=4.0;
/// Ratios of the factor for landmark edges to that for odometry that may mean one factor, by the same experience.
const EQUAL: std::ops::RangeInclusive<f64> = 0.1..=30.0;
/// Errors that accumulate to this share of the distance are those of a wrong wheel size or a bent frame.
const COHERENT: f64 = 0.05;
/// The same below which they are not worth a word.
const SHOWN_COHERENT: f64 = 0.002;

/// The factors of a chain.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct ChainFactors {
    session: String,
    nodes: usize,
    /// Factor on the covariance of its odometry.
    odometry: f64,
    /// Standard deviation of an error that accumulates, as a share of the distance.
    coherent: f64,
}

/// Verifies a graph.
pub(crate) fn verification(survey: &Survey<'_>) -> anyhow::Result<Verification> {
    for_dimension!(survey.graph.header.dimension, |G, DOF| verify::<G, DOF>(survey.graph))
}

/// How much smaller than its limit the factor of landmark edges may be: loops of the laser log intel ask for a tenth of the limit.
const BELOW_LEAST: f64 = 0.1;

/// Whether covariances of odometry and of landmark edges may be wrong by the same factor, if at all.
pub(crate) fn is_one_factor(calibration: &Calibration) -> bool {
    let landmark = calibration.landmark;
    let least = if calibration.is_landmark_least() { BELOW_LEAST * landmark } else { landmark };
    let is_equal =
        |odometry: f64| EQUAL.contains(&(least / odometry)) && EQUAL.contains(&(landmark / odometry));
    !calibration.on_prior && calibration.odometry.iter().all(|&odometry| is_equal(odometry))
}

pub(crate) fn check(survey: &Survey<'_>, verification: &Verification, found: &mut Vec<Finding>) {
    if verification.findings.is_empty() {
        return;
    }
    found.extend(broken(survey, verification));
    found.extend(joins(verification));
    let calibration = &verification.calibration;
    if calibration.on_prior {
        found.push(on_prior(verification));
        return;
    }
    found.push(factors(survey, verification));
    found.extend(coherent(calibration));
}

fn on_prior(verification: &Verification) -> Finding {
    let evidence = verification.calibration.evidence;
    let title = format!(
        "the covariances cannot be checked: {} nats of evidence from {}, and 10 are needed",
        figure(evidence),
        counted(verification.findings.len(), "candidate")
    );
    Finding::new(Severity::Warning, Topic::Calibration, "no-calibration", title)
        .with("candidates", verification.findings.len())
        .with("evidence", evidence)
        .therefore(
            "posecut-verify uses the covariances unchanged, so its verdicts are as good as these",
            "check the covariances, or add landmark edges that close loops near each other",
        )
}

/// The range of numbers, in words.
fn range(values: &[f64]) -> String {
    let (least, most) = values
        .iter()
        .fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), &value| (least.min(value), most.max(value)));
    let (least, most) = (figure(least), figure(most));
    if least == most { least } else { format!("{least} to {most}") }
}

fn factors(survey: &Survey<'_>, verification: &Verification) -> Finding {
    let calibration = &verification.calibration;
    let table = table(survey, verification);
    let odometry: Vec<f64> = if table.is_empty() {
        calibration.odometry.clone()
    } else {
        table.iter().map(|row| row.odometry).collect()
    };
    let usual =
        odometry.iter().all(|factor| ODOMETRY.contains(factor)) && LANDMARK.contains(&calibration.landmark);
    let severity = if usual { Severity::Note } else { Severity::Warning };
    let fit = if usual { "fit the loops" } else { "do not fit the loops" };
    let share = calibration.coherent.iter().copied().fold(0.0, f64::max).sqrt();
    let coherent = if share < SHOWN_COHERENT {
        String::new()
    } else {
        format!(" and errors that accumulate to {} % of the distance", figure(100.0 * share))
    };
    let title = format!(
        "the covariances {fit}; factors: odometry {}{coherent}, landmark edges {} (from {}, {}, {} nats of evidence)",
        range(&odometry),
        figure(calibration.landmark),
        counted(verification.findings.len(), "candidate"),
        counted(odometry.len(), "chain"),
        figure(calibration.evidence)
    );
    let found = Finding::new(severity, Topic::Calibration, "calibration", title)
        .with("odometry", &calibration.odometry)
        .with("landmark", calibration.landmark)
        .with("correct", calibration.correct)
        .with("evidence", calibration.evidence)
        .with("candidates", verification.findings.len())
        .with("chains", table);
    if usual {
        return found;
    }
    found.therefore(
        consequence(&odometry, calibration.landmark),
        "posecut-verify applies these factors by itself; for other methods, posecut pcm --scale auto estimates factors, and --calibrate writes them into the graph",
    )
}

fn consequence(odometry: &[f64], landmark: f64) -> String {
    let (mut small, mut large) = (Vec::new(), Vec::new());
    for (what, factors, credible) in
        [("odometry", odometry, ODOMETRY), ("landmark edges", &[landmark][..], LANDMARK)]
    {
        let above: Vec<f64> = factors.iter().copied().filter(|factor| factor > credible.end()).collect();
        let below: Vec<f64> =
            factors.iter().copied().filter(|factor| factor < credible.start()).map(f64::recip).collect();
        if !above.is_empty() {
            small.push(format!("of {what} {} times", range(&above)));
        }
        if !below.is_empty() {
            large.push(format!("of {what} {} times", range(&below)));
        }
    }
    let mut said = Vec::new();
    if !small.is_empty() {
        said.push(format!(
            "covariances are too small ({}), so methods that trust them reject correct edges",
            small.join(", ")
        ));
    }
    if !large.is_empty() {
        said.push(format!(
            "covariances are too large ({}), so methods that trust them keep wrong edges",
            large.join(", ")
        ));
    }
    said.join("; ")
}

/// The factors of each chain of several nodes that has landmark edges; empty if chains cannot be named.
fn table(survey: &Survey<'_>, verification: &Verification) -> Vec<ChainFactors> {
    let calibration = &verification.calibration;
    let chains = chains::in_order(survey.graph, &verification.broken);
    if chains.len() != calibration.odometry.len() {
        return Vec::new();
    }
    let mut judged = vec![false; survey.graph.nodes.len()];
    for finding in &verification.findings {
        let Some(edge) = survey.graph.edges.get(finding.edge) else { return Vec::new() };
        let Some((from, to)) = survey.graph.ends(edge) else { continue };
        (judged[from], judged[to]) = (true, true);
    }
    let factors = calibration.odometry.iter().zip(&calibration.coherent);
    chains
        .iter()
        .zip(factors)
        .filter(|(nodes, _)| nodes.len() > 1 && nodes.iter().any(|&node| judged[node]))
        .map(|(nodes, (&odometry, &coherent))| ChainFactors {
            session: survey.name(survey.places[nodes[0]].0),
            nodes: nodes.len(),
            odometry,
            coherent: coherent.sqrt(),
        })
        .collect()
}

fn coherent(calibration: &Calibration) -> Option<Finding> {
    let most = calibration.coherent.iter().copied().fold(0.0, f64::max).sqrt();
    (most >= COHERENT).then(|| {
        let title = format!("odometry errors accumulate to {} % of the distance or more", figure(100.0 * most));
        Finding::new(Severity::Warning, Topic::Calibration, "coherent-odometry", title)
            .with("share", most)
            .therefore(
                "a wrong scale, or a heading that drifts steadily, is no independent error of each step: covariances of long stretches are too small",
                "check wheel size, the gyro's bias and the calibration of cameras; posecut-verify allows for it by itself",
            )
    })
}

fn broken(survey: &Survey<'_>, verification: &Verification) -> Option<Finding> {
    let ids: Vec<u64> =
        verification.broken.iter().filter_map(|&edge| Some(survey.graph.edges.get(edge)?.id)).collect();
    let first = ids.first()?;
    let shown: Vec<String> = ids.iter().map(u64::to_string).collect();
    let title =
        format!("the odometry is broken at {} (odometry {})", counted(ids.len(), "step"), listed(&shown, 5));
    let found = Finding::new(Severity::Warning, Topic::Calibration, "broken-odometry", title)
        .with("edges", &ids)
        .with("first", first);
    Some(found.therefore(
        "landmark edges that agree with each other and with the usual motion contradict these steps; the optimiser still uses them",
        "remove them, or set \"rejected_by\" on them, if the sensor slipped or was moved there",
    ))
}

fn joins(verification: &Verification) -> Option<Finding> {
    let Verification { joins_proposed, joins_established, .. } = verification;
    let open = joins_proposed.saturating_sub(*joins_established);
    (open > 0).then(|| {
        let title = format!(
            "no overlap is established for {open} of {} that landmark edges propose between pieces of the graph",
            counted(*joins_proposed, "join")
        );
        Finding::new(Severity::Warning, Topic::Sessions, "unproved-joins", title)
            .with("open", open)
            .with("proposed", joins_proposed)
            .therefore(
                "the candidates there do not agree with each other on any alignment: the pieces stay separate, or wrong edges join them",
                "add landmark edges between them, or examine theirs with posecut-verify --explain EDGE",
            )
    })
}

/// The note that replaces calibration where it was not asked for.
pub(crate) fn skipped(survey: &Survey<'_>) -> Finding {
    let edges = survey.graph.edges_of(EdgeKind::Landmark).count();
    let title = format!("the calibration of {edges} landmark edges was not estimated");
    Finding::new(Severity::Note, Topic::Calibration, "calibration-skipped", title)
        .with("landmark_edges", edges)
        .therefore("covariances are checked less well", "--thorough estimates it, which may take minutes")
}

/// The error of a verification that failed.
pub(crate) fn failed(error: &anyhow::Error) -> Finding {
    let title = format!("posecut-verify refuses the graph: {error:#}");
    Finding::new(Severity::Error, Topic::Calibration, "verification-failed", title)
        .therefore("landmark edges cannot be judged", "correct what the message names")
}
