//! Generated worlds: a city and a sphere whose size is free, and noise and false edges that are added to any graph.

#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "support of tests and benches, none of which needs every world"
)]

use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Matrix3, Rotation3, SMatrix, SVector, UnitQuaternion, Vector3};
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_optimize::{Edge, EdgeKind};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Standard deviation of every component of a measurement, metres and radians.
const NOISE: f64 = 0.02;

/// True poses and edges.
pub(crate) type Graph<G, const DOF: usize> = (Vec<G>, Vec<Edge<G, DOF>>);

fn measured<G: LieGroup<DOF>, const DOF: usize>(
    truth: &[G],
    from: usize,
    to: usize,
    kind: EdgeKind,
    random: &mut ChaCha8Rng,
) -> Edge<G, DOF> {
    let noise = SVector::<f64, DOF>::from_fn(|_, _| {
        let value: f64 = StandardNormal.sample(random);
        NOISE * value
    });
    let measurement = truth[from].between(&truth[to]).compose(&G::exp(&noise));
    Edge::new(from, to, measurement, SMatrix::identity() / (NOISE * NOISE), kind)
}

/// A walk along the streets of a city whose area grows with the walk. It turns at one crossing in three; half of the
/// positions that it meets again get a landmark edge to the last visit.
pub(crate) fn manhattan(poses: usize, random: &mut ChaCha8Rng) -> Graph<SE2, 3> {
    const BLOCK: i64 = 4;
    let side = ((poses as f64).sqrt() as i64 / BLOCK).max(2) * BLOCK;
    let (mut x, mut y, mut heading) = (0_i64, 0_i64, 0_i64);
    let mut truth = Vec::with_capacity(poses);
    let mut visits: HashMap<(i64, i64), usize> = HashMap::new();
    let mut edges = Vec::new();
    for index in 0..poses {
        truth.push(SE2::new(x as f64, y as f64, FRAC_PI_2 * heading as f64));
        if index > 0 {
            edges.push(measured(&truth, index - 1, index, EdgeKind::Odometry, random));
        }
        if let Some(before) = visits.insert((x, y), index)
            && index - before > 4
            && random.random_range(0..2) == 0
        {
            edges.push(measured(&truth, before, index, EdgeKind::Landmark, random));
        }
        let crossing = x % BLOCK == 0 && y % BLOCK == 0;
        if crossing && random.random_range(0..3) == 0 {
            heading += if random.random_range(0..2) == 0 { 1 } else { 3 };
        }
        let ahead = |heading: i64| match heading.rem_euclid(4) {
            0 => (x + 1, y),
            1 => (x, y + 1),
            2 => (x - 1, y),
            _ => (x, y - 1),
        };
        let inside = |(x, y): (i64, i64)| (0..=side).contains(&x) && (0..=side).contains(&y);
        while !inside(ahead(heading)) {
            heading += 1;
        }
        (x, y) = ahead(heading);
        heading = heading.rem_euclid(4);
    }
    (truth, edges)
}

/// A spiral over a sphere, with a landmark edge from every pose to the one a turn earlier, as in the graph sphere2500.
pub(crate) fn sphere(poses: usize, random: &mut ChaCha8Rng) -> Graph<SE3, 6> {
    let turn = (poses as f64).sqrt().round() as usize;
    let radius = turn as f64 / TAU;
    let pose = |index: usize| {
        let longitude = TAU * index as f64 / turn as f64;
        let latitude = std::f64::consts::PI * ((index as f64 + 0.5) / poses as f64 - 0.5);
        let out =
            Vector3::new(latitude.cos() * longitude.cos(), latitude.cos() * longitude.sin(), latitude.sin());
        let east = Vector3::new(-longitude.sin(), longitude.cos(), 0.0);
        let axes = Matrix3::from_columns(&[east, out.cross(&east), out]);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        SE3::new(out * radius, rotation)
    };
    let truth: Vec<SE3> = (0..poses).map(pose).collect();
    let mut edges = Vec::new();
    for index in 1..poses {
        edges.push(measured(&truth, index - 1, index, EdgeKind::Odometry, random));
        if index >= turn {
            edges.push(measured(&truth, index - turn, index, EdgeKind::Landmark, random));
        }
    }
    (truth, edges)
}

/// Adds normal noise of this standard deviation, in radians, about every axis to every measured rotation. The information of a
/// rotation becomes that of both noises together.
pub(crate) fn add_rotation_noise<G: LieGroup<DOF>, const DOF: usize>(
    edges: &mut [Edge<G, DOF>],
    deviation: f64,
    random: &mut ChaCha8Rng,
) {
    let translations = if DOF == 6 { 3 } else { 2 };
    for edge in edges {
        let noise = SVector::<f64, DOF>::from_fn(|axis, _| {
            let value: f64 = StandardNormal.sample(random);
            if axis < translations { 0.0 } else { deviation * value }
        });
        edge.measurement = edge.measurement.compose(&G::exp(&noise));
        let mut covariance = edge.information.try_inverse().unwrap();
        for axis in translations..DOF {
            covariance[(axis, axis)] += deviation * deviation;
        }
        let information = covariance.try_inverse().unwrap();
        edge.information = (information + information.transpose()) * 0.5;
    }
}

/// Adds landmark edges between poses drawn at random, in groups of five neighbours that agree with each other, as false matches of two places
/// do that look alike: each group says that the second place is the first.
pub(crate) fn add_false_closures<G: LieGroup<DOF>, const DOF: usize>(
    (truth, edges): &mut Graph<G, DOF>,
    groups: usize,
    random: &mut ChaCha8Rng,
) {
    const GROUP: usize = 5;
    let last = truth.len() - GROUP;
    for _ in 0..groups {
        let (from, to) = (random.random_range(0..last), random.random_range(0..last));
        for offset in (0..GROUP).filter(|_| from.abs_diff(to) > GROUP) {
            let mut edge = measured(truth, from + offset, to + offset, EdgeKind::Landmark, random);
            let place = truth[to].between(&truth[to + offset]);
            edge.measurement = truth[from].between(&truth[from + offset]).between(&place);
            edges.push(edge);
        }
    }
}

/// A long drive with few landmark edges: a route of gentle turns that crosses its own path now and then. The information of edges spans
/// six orders of magnitude, in stretches, as where a robot's wheels slip or its sensors see little.
pub(crate) fn long_route(poses: usize, closures: usize, random: &mut ChaCha8Rng) -> Graph<SE2, 3> {
    let mut truth = vec![SE2::identity()];
    let mut turn = 0.0_f64;
    while truth.len() < poses {
        let noise: f64 = StandardNormal.sample(random);
        turn = 0.98 * turn + 0.01 * noise;
        truth.push(truth[truth.len() - 1].compose(&SE2::new(1.0, 0.0, turn)));
    }
    let normal = |random: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(random) };
    let measure = |from: usize, to: usize, deviation: (f64, f64), kind, random: &mut ChaCha8Rng| {
        let (along, about) = deviation;
        let error =
            SVector::<f64, 3>::new(along * normal(random), along * normal(random), about * normal(random));
        let information = SMatrix::<f64, 3, 3>::from_diagonal(&SVector::<f64, 3>::new(
            along.powi(-2),
            along.powi(-2),
            about.powi(-2),
        ));
        Edge::new(from, to, truth[from].between(&truth[to]).compose(&SE2::exp(&error)), information, kind)
    };
    let mut edges = Vec::new();
    // Standard deviations in metres and radians, independent of each other: from 1 mm to 1 m, and from 0.0001 to 0.1 rad.
    let draw = |random: &mut ChaCha8Rng| {
        (10.0_f64.powf(random.random_range(-3.0..0.0)), 10.0_f64.powf(random.random_range(-4.0..-1.0)))
    };
    let mut deviation = (0.01, 0.001);
    for index in 1..poses {
        if index % 200 == 1 {
            deviation = draw(random);
        }
        edges.push(measure(index - 1, index, deviation, EdgeKind::Odometry, random));
    }
    for _ in 0..closures {
        let (a, b) = (random.random_range(0..poses), random.random_range(0..poses));
        if a.abs_diff(b) > 100 {
            let deviation = draw(random);
            edges.push(measure(a.min(b), a.max(b), deviation, EdgeKind::Landmark, random));
        }
    }
    (truth, edges)
}
