//! Measured motions: degrees instead of radians, quaternions in another order, matches without geometry.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use posecut_graph::{Dimension, EdgeKind};

use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Seen, Survey, median};
use crate::words::{counted, figure, percent};

/// Steps above this length are probably not metres.
const LONG_STEP: f64 = 100.0;
/// Share of edges that make a habit: of zeros, and of repeated measurements.
const HABIT: f64 = 0.05;
/// Fewer edges are no habit.
const FEWEST: usize = 5;
/// Odometry that turns around at nine of ten steps has its quaternions in another order.
const TURNED: f64 = 170.0;

pub(crate) fn check(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    for kind in [EdgeKind::Odometry, EdgeKind::Landmark] {
        found.extend(degrees(survey, kind));
    }
    found.extend(quaternions(survey));
    found.extend(long_steps(survey));
    found.extend(standing(survey));
    found.extend(unmeasured(survey));
    found.extend(zeros(survey));
    found.extend(repeated(survey));
}

/// Planar headings beyond a full turn.
fn degrees(survey: &Survey<'_>, kind: EdgeKind) -> Option<Finding> {
    if survey.graph.header.dimension != Dimension::Two {
        return None;
    }
    let heading = |edge: &Seen<'_>| edge.edge.measurement.as_ref().and_then(|pose| pose.get(2)).copied();
    let headings: Vec<f64> = survey.of_kind(kind).iter().filter_map(heading).map(f64::abs).collect();
    let beyond = headings.iter().filter(|heading| **heading > TAU).count();
    let largest = headings.iter().copied().fold(0.0, f64::max);
    if beyond == 0 {
        return None;
    }
    let severity =
        if (beyond as f64) < HABIT * headings.len() as f64 { Severity::Warning } else { Severity::Error };
    let title = format!(
        "{beyond} of {} {} edges turn by more than a full turn of 6.28 rad, by up to {}",
        headings.len(),
        kind.name(),
        figure(largest)
    );
    let found = Finding::new(severity, Topic::Measurements, "degrees", title)
        .with("kind", kind.name())
        .with("edges", beyond)
        .with("of", headings.len())
        .with("largest", largest);
    Some(found.therefore(
        "these angles are probably degrees; read as radians, they are random headings",
        "convert measurements and information matrices to radians where the file is written",
    ))
}

/// Odometry in space that turns around at every step.
fn quaternions(survey: &Survey<'_>) -> Option<Finding> {
    if survey.graph.header.dimension != Dimension::Three {
        return None;
    }
    let turns: Vec<f64> = survey.odometry.iter().filter_map(Seen::turn).collect();
    let turned = turns.iter().filter(|turn| **turn > TURNED).count();
    if turns.len() < FEWEST || (turned as f64) < 0.9 * turns.len() as f64 {
        return None;
    }
    let title = format!("{turned} of {} odometry edges turn by more than 170 degrees", turns.len());
    let found = Finding::new(Severity::Error, Topic::Measurements, "quaternion-order", title)
        .with("edges", turned)
        .with("of", turns.len());
    Some(found.therefore(
        "the quaternions are probably written w first; read as x, y, z, w, a small rotation becomes half a turn",
        "write qx qy qz qw, in measurements and poses",
    ))
}

fn long_steps(survey: &Survey<'_>) -> Option<Finding> {
    let step = median(survey.odometry.iter().filter_map(Seen::length).filter(|step| *step > 0.0))?;
    (step > LONG_STEP).then(|| {
        let title = format!("an odometry step is {} m long (median)", figure(step));
        Finding::new(Severity::Warning, Topic::Measurements, "long-steps", title).with("step", step).therefore(
            "if these are millimetres, all lengths in results are 1000 times too large, and the information matrices do not fit them",
            "convert measurements and information matrices to metres where the file is written",
        )
    })
}

/// Odometry that measures nothing.
fn standing(survey: &Survey<'_>) -> Option<Finding> {
    let measured = survey.odometry.iter().filter(|edge| edge.motion.is_some()).count();
    let zeros = survey.odometry.iter().filter(|edge| edge.is_zero()).count();
    (measured > 0 && 2 * zeros > measured).then(|| {
        let title = format!("{zeros} of {measured} odometry edges measure no motion at all");
        Finding::new(Severity::Warning, Topic::Measurements, "no-motion", title)
            .with("edges", zeros)
            .with("of", measured)
            .therefore(
                "if these are placeholders, the odometry contradicts every correct landmark edge",
                "write the measured odometry; if the robot really stood still, keep fewer nodes there",
            )
    })
}

/// Landmark edges without a measurement.
fn unmeasured(survey: &Survey<'_>) -> Option<Finding> {
    let edges = survey.landmark.len();
    let without = survey.landmark.iter().filter(|edge| edge.edge.measurement.is_none()).count();
    (without > 0).then(|| {
        let title = format!("{without} of {edges} landmark edges have no measurement");
        let severity = if without == edges { Severity::Warning } else { Severity::Note };
        Finding::new(severity, Topic::Measurements, "unmeasured", title)
            .with("edges", without)
            .with("of", edges)
            .therefore(
                "only posecut-multicut can judge them, and the optimiser leaves them out",
                "measure the relative poses; or state \"the same place\" as the identity with standard deviations as large as the recogniser's reach, such as 3 m and 15 degrees",
            )
    })
}

/// Landmark edges that measure exactly the identity.
fn zeros(survey: &Survey<'_>) -> Option<Finding> {
    let measured: Vec<&Seen<'_>> = survey.landmark.iter().filter(|edge| edge.motion.is_some()).collect();
    let zeros = measured.iter().filter(|edge| edge.is_zero()).count();
    if zeros == 0 {
        return None;
    }
    let all = zeros == measured.len();
    if !all && (zeros < FEWEST || (zeros as f64) < HABIT * measured.len() as f64) {
        return None;
    }
    let deviation = median(
        measured
            .iter()
            .filter(|edge| edge.is_zero())
            .filter_map(|edge| edge.deviation.map(|deviation| deviation.translation)),
    );
    let claim = deviation.map_or_else(String::new, |deviation| format!(", to {} m", figure(deviation)));
    let found = |name, title: String| {
        Finding::new(Severity::Warning, Topic::Measurements, name, title)
            .with("edges", zeros)
            .with("of", measured.len())
            .with("deviation_translation", deviation)
    };
    Some(if all {
        found("without-geometry", format!("all {} measure exactly zero{claim}: place recognition without geometry", counted(zeros, "landmark edge")))
            .therefore(
                "they claim that both nodes are at one pose; a recogniser's matches are metres and many degrees apart, so correct edges look wrong",
                "state standard deviations as large as the recogniser's reach, such as 3 m and 15 degrees; posecut-verify estimates a factor by itself, posecut-pcm with --scale auto",
            )
    } else {
        let share = percent(zeros, measured.len());
        found("partly-without-geometry", format!("{zeros} of {} landmark edges ({share}) measure exactly zero{claim}, the others do not", measured.len()))
            .therefore(
                "a zero is usually the default of an alignment that failed or was never made, but it claims a measurement as good as the others",
                "leave these edges out, or give them standard deviations as large as the recogniser's reach, such as 3 m and 15 degrees",
            )
    })
}

/// A measurement that many landmark edges share.
fn repeated(survey: &Survey<'_>) -> Option<Finding> {
    let mut groups: BTreeMap<Vec<u64>, Vec<&Seen<'_>>> = BTreeMap::new();
    for edge in survey.landmark.iter().filter(|edge| edge.motion.is_some() && !edge.is_zero()) {
        let measurement = edge.edge.measurement.iter().flatten();
        groups.entry(measurement.map(|number| number.to_bits()).collect()).or_default().push(edge);
    }
    let total: usize = groups.values().map(Vec::len).sum();
    let largest = groups
        .into_values()
        .max_by(|one, other| (one.len(), other[0].edge.id).cmp(&(other.len(), one[0].edge.id)))?;
    if largest.len() < FEWEST || (largest.len() as f64) < HABIT * total as f64 {
        return None;
    }
    let first = &largest[0].edge;
    let title = format!(
        "{} of {total} landmark edges have the same measurement to the last digit (first: edge {})",
        largest.len(),
        first.id
    );
    let found = Finding::new(Severity::Warning, Topic::Measurements, "repeated-measurement", title)
        .with("edges", largest.len())
        .with("of", total)
        .with("first", first.id)
        .with("measurement", &first.measurement);
    Some(found.therefore(
        "these are a default or copies, not measurements, but they agree with each other, which counts as evidence for them",
        "measure each of them, or keep one of the copies",
    ))
}
