//! Standard deviations that no sensor has, compared with measured motions: matrices or measurements in other units.

use posecut_graph::EdgeKind;

use super::Scale;
use crate::finding::{Finding, Severity, Topic};
use crate::words::figure;

/// The smallest credible standard deviation, metres, and as a share of an odometry step.
const LEAST_TRANSLATION: f64 = 2e-4;
const LEAST_SHARE: f64 = 3e-4;
/// The smallest credible standard deviation, degrees.
const LEAST_ROTATION: f64 = 1e-3;
/// The largest credible standard deviation, metres, and as a multiple of an odometry step. At three steps, the position is
/// uncertain by a third of the path after 100 steps.
const MOST_TRANSLATION: f64 = 50.0;
const MOST_STEPS: f64 = 3.0;
/// The largest credible standard deviation, degrees: more than that of an identity matrix, one radian.
const MOST_ROTATION: f64 = 58.0;
/// A standard deviation that somebody may mean, degrees.
const CREDIBLE_ROTATION: f64 = 20.0;

pub(super) fn check(scale: &Scale) -> Vec<Finding> {
    [tiny_translation(scale), huge_translation(scale), tiny_rotation(scale), huge_rotation(scale)]
        .into_iter()
        .flatten()
        .collect()
}

fn suspect(scale: &Scale, name: &'static str, title: String) -> Finding {
    scale.numbers(Finding::new(Severity::Warning, Topic::Information, name, title))
}

fn tiny_translation(scale: &Scale) -> Option<Finding> {
    let deviation = scale.deviation.translation;
    let steps = scale.kind == EdgeKind::Odometry && deviation < LEAST_SHARE * scale.length;
    (deviation < LEAST_TRANSLATION || steps).then(|| {
        let title = format!(
            "{} edges claim a standard deviation of {} m for motions of {} m (medians)",
            scale.kind.name(),
            figure(deviation),
            figure(scale.length)
        );
        suspect(scale, "translation-too-certain", title).therefore(
            "no sensor is that good, so correct edges contradict each other: tests of consistency reject nearly all of them",
            "check the units (1/m^2), and whether the matrix is the fit of a registration, which is no error of the pose; posecut-verify estimates a factor by itself, posecut-pcm with --scale auto",
        )
    })
}

fn huge_translation(scale: &Scale) -> Option<Finding> {
    let deviation = scale.deviation.translation;
    let steps =
        scale.kind == EdgeKind::Odometry && deviation > MOST_STEPS * scale.length && scale.length > 0.0;
    (deviation > MOST_TRANSLATION || steps).then(|| {
        let title = format!(
            "{} edges claim a standard deviation of {} m for motions of {} m (medians)",
            scale.kind.name(),
            figure(deviation),
            figure(scale.length)
        );
        suspect(scale, "translation-too-uncertain", title).therefore(
            "such covariances explain any measurement, so wrong edges are not contradicted",
            format!(
                "check the units: multiply the information by 10^6 if it is in 1/mm^2, and invert it if it is a covariance ({} m); posecut-verify estimates a factor by itself, posecut-pcm with --scale auto",
                figure(1.0 / deviation)
            ),
        )
    })
}

fn tiny_rotation(scale: &Scale) -> Option<Finding> {
    let deviation = scale.deviation.rotation;
    (deviation < LEAST_ROTATION).then(|| {
        let title = format!(
            "{} edges claim a standard deviation of {} degrees (median)",
            scale.kind.name(),
            figure(deviation)
        );
        suspect(scale, "rotation-too-certain", title).therefore(
            "no sensor is that good, so correct edges contradict each other: tests of consistency reject nearly all of them",
            "check the units (1/rad^2), and whether the matrix is the fit of a registration, which is no error of the pose; posecut-verify estimates a factor by itself, posecut-pcm with --scale auto",
        )
    })
}

fn huge_rotation(scale: &Scale) -> Option<Finding> {
    let deviation = scale.deviation.rotation;
    (deviation > MOST_ROTATION).then(|| {
        let radians = deviation.to_radians();
        let title = format!(
            "{} edges claim a standard deviation of {} degrees, {} rad (median)",
            scale.kind.name(),
            figure(deviation),
            figure(radians)
        );
        let inverse = (1.0 / radians).to_degrees();
        let mut remedies = vec!["export the covariance of the heading".to_owned()];
        if radians < CREDIBLE_ROTATION {
            remedies.push(format!(
                "if {} degrees are meant, the information is in 1/degree^2: multiply its rotation terms by 3283 (57.3 squared)",
                figure(radians)
            ));
        }
        if inverse < CREDIBLE_ROTATION {
            remedies.push(format!("if {} degrees are meant, it is a covariance: invert it", figure(inverse)));
        }
        suspect(scale, "rotation-too-uncertain", title)
            .therefore("such a covariance allows any heading, so wrong edges are not contradicted", remedies.join("; "))
    })
}
