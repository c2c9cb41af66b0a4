//! Point-to-line ICP.

use nalgebra::Vector3;
use posecut_geometry::{LieGroup, SE2};
use posecut_matching::{Cloud, IcpOptions, Neighbours, align};
use posecut_random::random;
use rand_distr::{Distribution, Normal};

use crate::rooms::{corridor, room, scan};

/// Errors of matches in their own frames, with their normalised squares, over random pairs of poses in the room.
fn trials(deviation: f64, count: usize, purpose: &str) -> Vec<(Vector3<f64>, f64)> {
    let mut random = random(3, purpose);
    let walls = room();
    let near = Normal::new(0.0, 0.3).unwrap();
    let start = Normal::new(0.0, 0.05).unwrap();
    let options = IcpOptions { floor: [0.0; 3], least_deviation: 1e-4, ..IcpOptions::default() };
    (0..count)
        .map(|_| {
            let mut draw = |distribution: &Normal<f64>| {
                SE2::exp(&Vector3::from_fn(|_, _| distribution.sample(&mut random)))
            };
            let first = SE2::new(0.0, -1.0, 0.0).compose(&draw(&near));
            let motion = draw(&near);
            let start = motion.compose(&draw(&start));
            let clouds = [first, first.compose(&motion)]
                .map(|pose| Cloud::of_scan(&scan(&walls, &pose, deviation, &mut random)));
            let index = Neighbours::new(&clouds[0].points, options.first_distance);
            let found = align(&clouds[0], &index, &clouds[1], &start, &options).unwrap();
            let error = found.pose.between(&motion).log();
            (error, error.dot(&(found.information * error)))
        })
        .collect()
}

/// The mean of the normalised squared errors is 3 for a right covariance. With 400 trials the mean of chi-square values with three
/// degrees of freedom has a standard deviation of 0.12. The normals of both scans are estimates, which the covariance does not
/// count, so the upper bound leaves a fifth more.
#[test]
fn the_covariance_of_a_match_passes_a_chi_square_test() {
    for deviation in [0.01, 0.02] {
        let squares: Vec<f64> =
            trials(deviation, 400, "chi-square").iter().map(|(_, square)| *square).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        assert!((2.4..4.0).contains(&mean), "deviation {deviation}: mean of squares {mean}");
        let beyond = squares.iter().filter(|square| **square > 16.27).count();
        assert!(beyond <= 8, "{beyond} of 400 beyond the 0.999 quantile");
    }
}

#[test]
fn a_match_is_within_some_millimetres() {
    for (error, _) in trials(0.01, 50, "precision") {
        assert!(error.xy().norm() < 0.01 && error.z.abs() < 0.005, "{error}");
    }
}

#[test]
fn along_a_corridor_there_is_no_information_and_the_start_stays() {
    let mut random = random(5, "corridor");
    let walls = corridor();
    let poses = [SE2::new(0.0, 0.0, 0.1), SE2::new(0.4, 0.1, 0.15)];
    let clouds = poses.map(|pose| Cloud::of_scan(&scan(&walls, &pose, 0.01, &mut random)));
    let options = IcpOptions::default();
    let index = Neighbours::new(&clouds[0].points, options.first_distance);
    let start = SE2::new(0.9, 0.1, 0.0);
    let found = align(&clouds[0], &index, &clouds[1], &start, &options).unwrap();
    let eigen = found.information.fixed_view::<2, 2>(0, 0).into_owned().symmetric_eigen();
    assert!(eigen.eigenvalues.min() < 1e-6 * eigen.eigenvalues.max(), "{}", found.information);
    let moved = poses[0].compose(&found.pose).translation - poses[0].compose(&start).translation;
    assert!(moved.x.abs() < 0.1, "along the corridor: {moved}");
    let across = poses[0].compose(&found.pose).translation.y - poses[1].translation.y;
    assert!(across.abs() < 0.02, "across the corridor: {across}");
}

#[test]
fn clouds_without_common_points_do_not_match() {
    let mut random = random(6, "apart");
    let cloud = Cloud::of_scan(&scan(&room(), &SE2::new(0.0, -1.0, 0.0), 0.01, &mut random));
    let options = IcpOptions::default();
    let index = Neighbours::new(&cloud.points, options.first_distance);
    assert_eq!(align(&cloud, &index, &cloud, &SE2::new(100.0, 0.0, 0.0), &options), None);
    let empty = Neighbours::new(&[], 0.5);
    assert_eq!(align(&Cloud::default(), &empty, &cloud, &SE2::identity(), &options), None);
}
