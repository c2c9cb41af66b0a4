//! Matrices that nobody measured: the identity, one number for metres and radians, one matrix for edges of all kinds.

use posecut_graph::EdgeKind;
use posecut_verify::Verification;

use crate::calibration::is_one_factor;
use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Seen, Survey};
use crate::words::figure;

/// Fewer edges say nothing about a habit.
const FEWEST: usize = 3;

pub(super) fn check(survey: &Survey<'_>, verification: Option<&Verification>, found: &mut Vec<Finding>) {
    let degrees = survey.graph.header.dimension.degrees_of_freedom();
    let multiple = |kind| common(survey.of_kind(kind)).and_then(|terms| multiple_of_identity(terms, degrees));
    let [odometry, landmark] = [EdgeKind::Odometry, EdgeKind::Landmark].map(multiple);
    let both = format!("{} odometry and {} landmark edges", survey.odometry.len(), survey.landmark.len());
    if let Some(factor) = odometry.filter(|_| odometry == landmark) {
        found.push(isotropic("placeholder", &both, factor));
        return;
    }
    for (name, kind, factor) in [
        ("odometry-placeholder", EdgeKind::Odometry, odometry),
        ("landmark-placeholder", EdgeKind::Landmark, landmark),
    ] {
        let edges = format!("{} {} edges", survey.of_kind(kind).len(), kind.name());
        found.extend(factor.map(|factor| isotropic(name, &edges, factor)));
    }
    found.extend(shared(survey, verification));
}

/// The matrix that all edges have, if they have one.
fn common<'a>(edges: &[Seen<'a>]) -> Option<&'a [f64]> {
    let mut matrices = edges.iter().filter_map(|edge| edge.information);
    let first = matrices.next()?;
    let others = matrices.try_fold(0, |count, terms| (terms == first).then_some(count + 1))?;
    (1 + others >= FEWEST).then_some(first)
}

/// The factor, if a matrix is a multiple of the identity.
fn multiple_of_identity(terms: &[f64], degrees: usize) -> Option<f64> {
    let factor = *terms.first()?;
    let mut terms = terms.iter();
    for row in 0..degrees {
        for column in row..degrees {
            let expected = if row == column { factor } else { 0.0 };
            if (terms.next()? - expected).abs() > 1e-9 * factor {
                return None;
            }
        }
    }
    (factor > 0.0).then_some(factor)
}

fn isotropic(name: &'static str, edges: &str, factor: f64) -> Finding {
    let deviation = 1.0 / factor.sqrt();
    let what = if factor == 1.0 {
        "the identity".to_owned()
    } else {
        format!("{} times the identity", figure(factor))
    };
    let title = format!(
        "all {edges} have {what} as information matrix: {} m and {} degrees",
        figure(deviation),
        figure(deviation.to_degrees())
    );
    Finding::new(Severity::Warning, Topic::Information, name, title)
        .with("factor", factor)
        .with("deviation_translation", deviation)
        .with("deviation_rotation", deviation.to_degrees())
        .therefore(
            "one number for metres and radians is a placeholder: translations and rotations are not weighted as the sensor measures them, and no factor on the matrix corrects that",
            "export the sensor's own covariances; a rough guess is better, such as 1 to 5 % of a step and 0.1 to 1 degree for odometry",
        )
}

/// One matrix for odometry and landmark edges.
fn shared(survey: &Survey<'_>, verification: Option<&Verification>) -> Option<Finding> {
    let matrix = common(&survey.odometry)?;
    if common(&survey.landmark)? != matrix {
        return None;
    }
    let deviation = survey.odometry.first()?.deviation;
    let size = deviation.map_or_else(String::new, |deviation| {
        format!(" ({} m and {} degrees)", figure(deviation.translation), figure(deviation.rotation))
    });
    let title = format!(
        "all {} odometry edges and all {} landmark edges have the same information matrix{size}",
        survey.odometry.len(),
        survey.landmark.len()
    );
    let found = |severity| {
        Finding::new(severity, Topic::Information, "shared-information", title.clone())
            .with("odometry_edges", survey.odometry.len())
            .with("landmark_edges", survey.landmark.len())
    };
    if verification.is_some_and(|verification| is_one_factor(&verification.calibration)) {
        return Some(found(Severity::Note).therefore("the loops do not contradict it", ""));
    }
    Some(found(Severity::Warning).therefore(
        "the error of a place match is not that of an odometry step, so one of the two is wrong; methods that trust covariances keep wrong edges or reject correct ones",
        "export the covariances of the matches; posecut-verify estimates a factor for each kind by itself, posecut-pcm with --scale auto",
    ))
}
