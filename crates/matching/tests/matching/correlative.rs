//! Correlative matching, against exhaustive search.

use posecut_geometry::{LieGroup, SE2};
use posecut_matching::{Cloud, Field, Neighbours, Window, agreement};
use posecut_random::random;
use proptest::prelude::*;

use crate::rooms::{room, scan};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A window that is a single pose gives that pose's score; branch and bound must find the largest of them.
    #[test]
    fn branch_and_bound_finds_what_exhaustive_search_finds(
        seed in 0_u64..1000,
        x in -0.6..0.6,
        y in -0.6..0.6,
        heading in prop::sample::select(vec![0.0, 3.1, -3.1, 1.5]),
    ) {
        let mut random = random(seed, "exhaustive");
        let motion = SE2::new(x, y, heading);
        let first = SE2::new(0.0, -1.0, 0.3);
        let [reference, query] =
            [first, first.compose(&motion)].map(|pose| Cloud::of_scan(&scan(&room(), &pose, 0.02, &mut random)));
        let query = query.at_most(40);
        let field = Field::new(&reference, 0.1, 0.1);
        let step = 0.05;
        let window = Window { middle: SE2::new(0.0, 0.0, heading + 0.1), distance: 0.75, angle: 0.2 };
        let found = field.search(&query, &[window], step, 0.1).unwrap();
        let mut best = 0.0_f64;
        for turn in -4..=4 {
            for column in -7..=7 {
                for row in -7..=7 {
                    let (x, y) = (f64::from(column) * 0.1, f64::from(row) * 0.1);
                    let middle = SE2::new(x, y, window.middle.angle() + f64::from(turn) * step);
                    let single = Window { middle, distance: 0.0, angle: 0.0 };
                    best = field.search(&query, &[single], step, 0.0).map_or(best, |pose| best.max(pose.score));
                }
            }
        }
        // Cells of moved points are computed anew here, so a point on the edge of a cell may fall into the next one.
        prop_assert!((found.score - best).abs() < 0.02, "{} and {best}", found.score);
        let error = motion.between(&found.pose).log();
        prop_assert!(error.xy().norm() < 0.2 && error.z.abs() < 0.06, "{error}");
    }
}

#[test]
fn a_match_is_found_without_a_start_and_agrees() {
    let mut random = random(9, "window");
    let motion = SE2::new(1.4, 0.8, -2.9);
    let first = SE2::new(-1.0, -1.0, 0.3);
    let [reference, query] =
        [first, first.compose(&motion)].map(|pose| Cloud::of_scan(&scan(&room(), &pose, 0.02, &mut random)));
    let field = Field::new(&reference, 0.1, 0.1);
    let window = Window { middle: SE2::identity(), distance: 3.0, angle: std::f64::consts::PI };
    let found = field.search(&query.at_most(120), &[window], 0.04, 0.5).unwrap();
    let error = motion.between(&found.pose).log();
    assert!(error.xy().norm() < 0.2 && error.z.abs() < 0.06, "{error}");
    let index = Neighbours::new(&reference.points, 0.3);
    let right = agreement(&reference, &index, &query, &motion, 0.1).share();
    let wrong = agreement(&reference, &index, &query, &SE2::new(0.5, -1.0, 1.0), 0.1).share();
    assert!(right > 0.8 && wrong < 0.5, "{right} and {wrong}");
}

#[test]
fn nothing_is_found_below_the_least_score() {
    let mut random = random(9, "least");
    let reference = Cloud::of_scan(&scan(&room(), &SE2::new(0.0, -1.0, 0.0), 0.02, &mut random));
    let field = Field::new(&reference, 0.1, 0.1);
    let far = Window { middle: SE2::new(50.0, 0.0, 0.0), distance: 1.0, angle: 0.5 };
    assert_eq!(field.search(&reference, &[far], 0.05, 0.5), None);
    assert_eq!(field.search(&Cloud::default(), &[far], 0.05, 0.5), None);
    assert_eq!(Field::new(&Cloud::default(), 0.1, 0.1).search(&reference, &[far], 0.05, 0.5), None);
}

/// The nearest point of the grid index is that of an exhaustive search.
#[test]
fn the_nearest_point_is_that_of_an_exhaustive_search() {
    let mut random = random(11, "nearest");
    let cloud = Cloud::of_scan(&scan(&room(), &SE2::new(0.0, -1.0, 0.0), 0.02, &mut random));
    let index = Neighbours::new(&cloud.points, 0.4);
    for query in Cloud::of_scan(&scan(&room(), &SE2::new(0.3, -0.5, 1.0), 0.3, &mut random)).points {
        let expected = (0..cloud.len())
            .map(|at| ((cloud.points[at] - query).norm_squared(), at))
            .filter(|(squared, _)| *squared <= 0.4 * 0.4)
            .min_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        assert_eq!(index.nearest(&query, 0.4, |_| true).map(|(at, squared)| (squared, at)), expected);
    }
}
