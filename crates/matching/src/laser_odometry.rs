//! Steps between keyframes by odometry and scan matching together.
//!
//! Point-to-line ICP starts from the odometry. Where it fails or leads far from the odometry, the best pose of a window around it is another
//! start. The result is the product of match and odometry: along a corridor, where scans say nothing, the odometry decides. Where both
//! contradict each other, one of them is wrong, and the step is the match with a covariance that reaches to the odometry.

use std::cell::OnceCell;

use nalgebra::{Matrix3, Vector3};
use posecut_geometry::{LieGroup, SE2};
use posecut_scan::LaserScan;
use serde::Serialize;

use crate::{Alignment, Cloud, Field, IcpOptions, Neighbours, Window, align, robust_deviation};

/// A match is used only if at least this share of the later scan's points found a partner.
const LEAST_MATCHED: f64 = 0.2;

/// ICP that does not come to rest often circles within less than a millimetre, because points change their partners. It has settled
/// if ICP from its result ends within this distance, metres and radians.
const SETTLED: f64 = 0.002;

/// A match contradicts the odometry if its squared normalised distance from it is above this: 7 standard deviations. Wheels slip farther
/// than a normal distribution says: at the chi-square quantile of 1 - 1e-4 (21.1), seven right matches of aces were lost.
const GATE: f64 = 50.0;

/// How well the odometry agrees with scan matching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// Steps with a match that was used.
    pub matched: usize,
    /// Steps whose scans could not be matched, or are missing: the odometry alone was used.
    pub unmatched: usize,
    /// Steps whose match is too far from the odometry for both to be right: the covariance spans both.
    pub contradicting: usize,
    /// Difference of match and odometry forward, over the matched steps: root mean square and robust standard deviation, metres.
    pub difference_forward_m: [f64; 2],
    /// The same sideways, metres.
    pub difference_sideways_m: [f64; 2],
    /// The same in heading, radians.
    pub difference_heading_rad: [f64; 2],
    /// Mean squared difference, normalised by the covariances of both, for each degree of freedom: 1 if both are right.
    pub normalised_square: f64,
}

/// A measured step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The pose of the later keyframe in the frame of the earlier one.
    pub motion: SE2,
    /// Its information matrix, order x, y, theta.
    pub information: Matrix3<f64>,
}

/// The points of a scan to match others with.
pub struct Reference<'a> {
    cloud: &'a Cloud,
    index: Neighbours,
    field: OnceCell<Field>,
}

impl<'a> Reference<'a> {
    /// Indexes a cloud. O(points log points).
    pub fn new(cloud: &'a Cloud) -> Self {
        let index = Neighbours::new(&cloud.points, IcpOptions::default().first_distance);
        Self { cloud, index, field: OnceCell::new() }
    }
}

/// The result of matching one scan with another.
pub enum Outcome {
    /// A match that is used.
    Matched {
        /// The product of match and odometry.
        measured: Measured,
        /// From the match to the odometry, in the frame of the match: metres and radians.
        difference: Vector3<f64>,
        /// Its square, normalised by both covariances.
        square: f64,
        /// Points with a partner.
        points: usize,
    },
    /// ICP did not settle, or too few points found a partner.
    Unmatched,
    /// The match is too far from the odometry.
    Contradicting {
        /// The match, with a covariance that reaches to the odometry.
        measured: Measured,
        /// Points with a partner.
        points: usize,
    },
}

/// The windows around the odometry in which another start is searched, metres and radians, and their grid. The first is what wheels slipped
/// at most on mit-csail, where turns of 0.4 rad are missing from the odometry of a step. The second, for steps that are without any match
/// still, is where a robot at walking pace may be two seconds later.
const WINDOWS: [[f64; 2]; 2] = [[0.5, 0.4], [3.0, 0.8]];
const GRID: [f64; 2] = [0.05, 0.02];

/// Standard deviation of the likelihood field, metres: two cells of the grid.
const FIELD: f64 = 0.1;

/// The least mean likelihood of a second start.
const LEAST_SCORE: f64 = 0.5;

/// A match is doubted beyond this squared normalised distance from the odometry: the 95 % quantile of chi-square with three degrees of
/// freedom.
const DOUBTFUL: f64 = 7.81;

/// Matches a scan with an earlier one, starting from the odometry, and from the best pose of a window around it where that fails or leads
/// far from the odometry. O(points), with a second start O(points * poses of the window).
pub fn match_step(reference: &Reference<'_>, query: &Cloud, odometry: &Measured) -> Outcome {
    let options = IcpOptions::default();
    let first = match_from(reference, query, odometry, &odometry.motion, &options);
    if let Outcome::Matched { square, .. } = first
        && square <= DOUBTFUL
    {
        return first;
    }
    // The later start is near, and a wider search for partners would lead ICP away again.
    let near = IcpOptions { first_distance: options.least_distance, ..options };
    let mut best = first;
    for [distance, angle] in WINDOWS {
        let window = Window { middle: odometry.motion, distance, angle };
        let field = reference.field.get_or_init(|| Field::new(reference.cloud, GRID[0], FIELD));
        if let Some(found) = field.search(query, &[window], GRID[1], LEAST_SCORE) {
            let next = match_from(reference, query, odometry, &found.pose, &near);
            if next.quality() > best.quality() {
                best = next;
            }
        }
        if !matches!(best, Outcome::Unmatched) {
            break;
        }
    }
    best
}

impl Outcome {
    /// How good a match is: a point without a partner counts as much as half a squared standard deviation from the odometry. In a turn, ICP
    /// may come to rest at a pose that matches half of the points.
    fn quality(&self) -> (u8, f64) {
        match self {
            Self::Matched { points, square, .. } => (2, *points as f64 - 0.5 * square),
            Self::Contradicting { points, .. } => (1, *points as f64),
            Self::Unmatched => (0, 0.0),
        }
    }
}

fn match_from(
    reference: &Reference<'_>,
    query: &Cloud,
    odometry: &Measured,
    start: &SE2,
    options: &IcpOptions,
) -> Outcome {
    let found = settled(reference, query, start, options)
        .filter(|found| found.matched as f64 >= LEAST_MATCHED * query.len() as f64);
    let Some(found) = found else { return Outcome::Unmatched };
    let difference = found.pose.between(&odometry.motion).log();
    let square = normalised_square(&difference, &odometry.information, &found);
    if square > GATE {
        let measured = spanning(&difference, &odometry.information, square, &found);
        return Outcome::Contradicting { measured, points: found.matched };
    }
    Outcome::Matched {
        measured: fused(&difference, &odometry.information, &found),
        difference,
        square,
        points: found.matched,
    }
}

/// The steps between keyframes by odometry and scan matching, from those by odometry and from the scan of each keyframe, if it has one.
/// O(keyframes * beams).
pub fn by_matching(odometry: &[Measured], scans: &[Option<&LaserScan>]) -> (Vec<Measured>, Comparison) {
    let clouds: Vec<Option<Cloud>> = scans.iter().map(|scan| scan.map(Cloud::of_scan)).collect();
    let mut comparison = Comparison::default();
    let mut differences = Vec::new();
    let mut squares = 0.0;
    let measured = odometry.iter().zip(clouds.windows(2)).map(|(step, pair)| {
        let matched = match pair {
            [Some(earlier), Some(later)] => match_step(&Reference::new(earlier), later, step),
            _ => Outcome::Unmatched,
        };
        match matched {
            Outcome::Matched { measured, difference, square, .. } => {
                comparison.matched += 1;
                differences.push(difference);
                squares += square;
                measured
            }
            Outcome::Contradicting { measured, .. } => {
                comparison.contradicting += 1;
                measured
            }
            Outcome::Unmatched => {
                comparison.unmatched += 1;
                *step
            }
        }
    });
    let measured = measured.collect();
    let spread =
        |row: usize| spread(&differences.iter().map(|difference| difference[row]).collect::<Vec<_>>());
    comparison.difference_forward_m = spread(0);
    comparison.difference_sideways_m = spread(1);
    comparison.difference_heading_rad = spread(2);
    comparison.normalised_square = squares / (3 * comparison.matched.max(1)) as f64;
    (measured, comparison)
}

/// The match of two scans, if ICP comes to rest or settles.
fn settled(reference: &Reference<'_>, query: &Cloud, start: &SE2, options: &IcpOptions) -> Option<Alignment> {
    let Reference { cloud, index, .. } = reference;
    let found = align(cloud, index, query, start, options)?;
    if found.converged {
        return Some(found);
    }
    let near = IcpOptions { first_distance: options.least_distance, ..*options };
    let again = align(cloud, index, query, &found.pose, &near)?;
    let moved = found.pose.between(&again.pose).log().amax();
    (again.converged || moved <= SETTLED).then_some(again)
}

/// `d^T (S_odometry + S_match)^-1 d`, written with information matrices, so that a match may be undetermined along a corridor:
/// `(A^-1 + B^-1)^-1 = A - A (A + B)^-1 A`.
fn normalised_square(difference: &Vector3<f64>, odometry: &Matrix3<f64>, found: &Alignment) -> f64 {
    let Some(inverse) = (odometry + found.information).try_inverse() else { return 0.0 };
    let both = odometry - odometry * inverse * odometry;
    difference.dot(&(both * difference)).max(0.0)
}

/// The product of two independent normal distributions of one pose, in the tangent space at the match (first order); the difference leads
/// from there to the odometry.
fn fused(difference: &Vector3<f64>, odometry: &Matrix3<f64>, found: &Alignment) -> Measured {
    let information = odometry + found.information;
    let shift =
        information.try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * odometry * difference);
    Measured { motion: found.pose.compose(&SE2::exp(&shift)), information }
}

/// Match and odometry where one of both is wrong: the match, with odometry as uncertain as the difference says, and a covariance that reaches
/// from there to the odometry. A wheel that slipped leaves a step that is loose, and neither wrong nor tight.
fn spanning(difference: &Vector3<f64>, odometry: &Matrix3<f64>, square: f64, found: &Alignment) -> Measured {
    let near = fused(difference, &(odometry * (3.0 / square)), found);
    let reach = near.motion.between(&found.pose.compose(&SE2::exp(difference))).log();
    // (A^-1 + d d^T)^-1, by the formula of Sherman and Morrison.
    let weighted = near.information * reach;
    let information = near.information - weighted * weighted.transpose() / (1.0 + reach.dot(&weighted));
    Measured { motion: near.motion, information }
}

/// Root mean square and robust standard deviation (1.4826 times the median of the sizes); 0 of none. O(values).
pub fn spread(values: &[f64]) -> [f64; 2] {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    [(squares / values.len().max(1) as f64).sqrt(), robust_deviation(values)]
}
