//! Information matrices: what they claim, and signs that they are placeholders or in other units.
//!
//! - [`units`]: standard deviations compared with measured motions.
//! - [`placeholders`]: identity matrices, and one matrix for odometry and landmark edges.

mod placeholders;
mod units;

use std::collections::BTreeSet;

use posecut_graph::EdgeKind;
use posecut_verify::Verification;

use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Deviation, Seen, Survey, median};
use crate::words::{counted, figure};

/// A standard deviation below the median by this factor is an outlier: the edge weighs ten thousand times as much as others.
const OUTLIER: f64 = 100.0;

/// The edges of one kind, in the median.
pub(crate) struct Scale {
    pub(crate) kind: EdgeKind,
    /// Edges with standard deviations.
    pub(crate) edges: usize,
    /// Median standard deviations.
    pub(crate) deviation: Deviation,
    /// Median length of measured translations that are not zero, metres; 0 if all are.
    pub(crate) length: f64,
    /// Median angle of measured rotations that are not zero, degrees; 0 if all are.
    pub(crate) turn: f64,
    /// Different matrices.
    pub(crate) matrices: usize,
}

pub(crate) fn check(survey: &Survey<'_>, verification: Option<&Verification>, found: &mut Vec<Finding>) {
    for kind in [EdgeKind::Odometry, EdgeKind::Landmark] {
        let edges = survey.of_kind(kind);
        found.extend(singular(kind, edges));
        let Some(scale) = Scale::of(kind, edges) else { continue };
        found.push(scale.note());
        found.extend(units::check(&scale));
        found.extend(outliers(&scale, edges));
    }
    placeholders::check(survey, verification, found);
}

impl Scale {
    pub(crate) fn of(kind: EdgeKind, edges: &[Seen<'_>]) -> Option<Self> {
        let deviations = || edges.iter().filter_map(|edge| edge.deviation);
        let deviation = Deviation {
            translation: median(deviations().map(|deviation| deviation.translation))?,
            rotation: median(deviations().map(|deviation| deviation.rotation))?,
        };
        let typical =
            |values: Vec<f64>| median(values.into_iter().filter(|value| *value > 0.0)).unwrap_or(0.0);
        let bits = |terms: &[f64]| terms.iter().map(|term| term.to_bits()).collect::<Vec<u64>>();
        let matrices: BTreeSet<Vec<u64>> =
            edges.iter().filter_map(|edge| edge.information).map(bits).collect();
        Some(Self {
            kind,
            edges: deviations().count(),
            deviation,
            length: typical(edges.iter().filter_map(Seen::length).collect()),
            turn: typical(edges.iter().filter_map(Seen::turn).collect()),
            matrices: matrices.len(),
        })
    }

    fn note(&self) -> Finding {
        let Deviation { translation, rotation } = self.deviation;
        let motions = match self.kind {
            EdgeKind::Odometry => "steps",
            EdgeKind::Landmark => "motions",
        };
        let matrices = match self.matrices {
            1 if self.edges > 1 => "one matrix for all".to_owned(),
            count if count == self.edges => "a matrix each".to_owned(),
            count => counted(count, "matrix"),
        };
        let title = format!(
            "{} edges: standard deviations {} m and {} degrees for {motions} of {} m and {} degrees (medians); {matrices}",
            self.kind.name(),
            figure(translation),
            figure(rotation),
            figure(self.length),
            figure(self.turn)
        );
        let name = match self.kind {
            EdgeKind::Odometry => "odometry-deviations",
            EdgeKind::Landmark => "landmark-deviations",
        };
        self.numbers(Finding::new(Severity::Note, Topic::Information, name, title))
    }

    /// Adds the numbers to a finding.
    fn numbers(&self, finding: Finding) -> Finding {
        finding
            .with("kind", self.kind.name())
            .with("edges", self.edges)
            .with("matrices", self.matrices)
            .with("deviation_translation", self.deviation.translation)
            .with("deviation_rotation", self.deviation.rotation)
            .with("median_translation", self.length)
            .with("median_rotation", self.turn)
    }
}

/// Matrices without an inverse.
fn singular(kind: EdgeKind, edges: &[Seen<'_>]) -> Option<Finding> {
    let stated = edges.iter().filter(|edge| edge.information.is_some()).count();
    let mut without = edges.iter().filter(|edge| edge.information.is_some() && edge.deviation.is_none());
    let first = without.next()?;
    let count = 1 + without.count();
    let severity =
        if count == stated && kind == EdgeKind::Odometry { Severity::Error } else { Severity::Warning };
    let title = format!(
        "{count} of {stated} {} edges have an information matrix without an inverse (first: edge {} from node {} to {})",
        kind.name(),
        first.edge.id,
        first.edge.from,
        first.edge.to
    );
    let found = Finding::new(severity, Topic::Information, "singular-information", title)
        .with("kind", kind.name())
        .with("edges", count)
        .with("of", stated)
        .with("first", first.edge.id);
    Some(found.therefore(
        "these edges say nothing about some direction; posecut-pcm refuses them, and posecut-verify gives that direction 10^9 times the variance of the others",
        "give every direction a positive information at the source; posecut inspect validate lists these edges",
    ))
}

/// Edges with standard deviations far below the median.
fn outliers(scale: &Scale, edges: &[Seen<'_>]) -> Option<Finding> {
    let share = |edge: &Seen<'_>| {
        edge.deviation.map_or(1.0, |deviation| {
            (deviation.translation / scale.deviation.translation)
                .min(deviation.rotation / scale.deviation.rotation)
        })
    };
    let outliers: Vec<&Seen<'_>> = edges.iter().filter(|edge| share(edge) < 1.0 / OUTLIER).collect();
    let smallest = outliers.iter().min_by(|one, other| share(one).total_cmp(&share(other)))?;
    let Deviation { translation, rotation } = smallest.deviation?;
    let title = format!(
        "{} with a standard deviation under 1/100 of the median of {} m and {} degrees; the smallest: edge {} with {} m and {} degrees",
        counted(outliers.len(), &format!("{} edge", scale.kind.name())),
        figure(scale.deviation.translation),
        figure(scale.deviation.rotation),
        smallest.edge.id,
        figure(translation),
        figure(rotation)
    );
    let found = Finding::new(Severity::Warning, Topic::Information, "information-outliers", title)
        .with("kind", scale.kind.name())
        .with("edges", outliers.len())
        .with("smallest", smallest.edge.id)
        .with("smallest_translation", translation)
        .with("smallest_rotation", rotation);
    Some(found.therefore(
        "each of them weighs more than 10000 other edges; if it is wrong, the map bends to it, and tests of consistency reject what disagrees with it",
        "limit the information at the source to what the sensor can know; posecut inspect edges lists landmark edges with their residuals",
    ))
}
