//! Contexts turn with the heading.

use std::f64::consts::TAU;

use nalgebra::{Rotation2, Vector2};
use posecut_matching::Cloud;
use posecut_recognize::columns::heading;
use posecut_recognize::places::Context as _;
use posecut_recognize::polar_context::{PolarContext, SECTORS};
use proptest::prelude::*;

/// Points with the polar coordinates of a cell's middle, so that a turn by whole sectors moves none across a border.
fn cloud(cells: &[(usize, usize)]) -> Cloud {
    let points: Vec<Vector2<f64>> = cells
        .iter()
        .map(|(ring, sector)| {
            let angle = (*sector as f64 + 0.5) * TAU / SECTORS as f64;
            Vector2::new(angle.cos(), angle.sin()) * (*ring as f64 + 0.5) * 0.5
        })
        .collect();
    let count = points.len();
    Cloud { points, normals: vec![None; count], origins: vec![Vector2::zeros(); count] }
}

fn turned(cloud: &Cloud, angle: f64) -> Cloud {
    let rotation = Rotation2::new(angle);
    let points = cloud.points.iter().map(|point| rotation * point).collect();
    Cloud { points, normals: cloud.normals.clone(), origins: cloud.origins.clone() }
}

proptest! {
    #[test]
    fn a_turned_place_has_the_same_key_and_is_most_alike_at_its_heading(
        cells in prop::collection::vec((0_usize..20, 0_usize..SECTORS), 30..200),
        shift in 0..SECTORS,
    ) {
        let here = cloud(&cells);
        // A robot whose heading is larger by an angle sees all turned back by it.
        let there = PolarContext::new(&turned(&here, -heading(shift, SECTORS)), 10.0);
        let here = PolarContext::new(&here, 10.0);
        for (one, other) in here.key().iter().zip(there.key()) {
            prop_assert!((one - other).abs() < 1e-9);
        }
        let similarities = here.similarities(&there);
        let best = similarities.iter().copied().fold(0.0, f64::max);
        prop_assert!((similarities[shift] - best).abs() < 1e-6, "{} is not {best}", similarities[shift]);
    }
}

#[test]
fn nothing_is_alike_to_an_empty_place() {
    let (empty, full) =
        (PolarContext::new(&Cloud::default(), 10.0), PolarContext::new(&cloud(&[(3, 7)]), 10.0));
    assert!(empty.similarities(&full).iter().all(|similarity| *similarity == 0.0));
    assert!(empty.key().iter().all(|number| *number == 0.0));
}
