//! Wrong edges between the right places, in numbers.

use nalgebra::SVector;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::EdgeKind;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_verify::verdict::Verdict;
use posecut_verify::{Motion, verify};
use rand::RngExt as _;

/// Numbers of wrong edges accepted, and of correct edges not accepted, among 300 candidates of which this share is measured metres and,
/// with `turned`, tens of degrees off. The correct ones are off by a decimetre and a degree.
fn mistakes<G: LieGroup<DOF> + Motion<DOF>, const DOF: usize>(
    wrong: f64,
    turned: bool,
    seed: u64,
) -> [usize; 2] {
    let scenario = Scenario { candidates: 300, outliers: 0.0, falsehood: Falsehood::Uniform, seed };
    let mut graph = scenario.draw::<G, DOF>();
    let mut random = posecut_stage::random(seed, "local errors");
    let mut is_wrong = vec![false; graph.edges.len()];
    for (number, edge) in
        graph.edges.iter_mut().enumerate().filter(|(_, edge)| edge.kind == EdgeKind::Landmark)
    {
        if random.random_bool(wrong) {
            is_wrong[number] = true;
            let translations = DOF.div_ceil(2);
            let off = SVector::<f64, DOF>::from_fn(|axis, _| {
                let side = if random.random_bool(0.5) { 1.0 } else { -1.0 };
                side * if axis < translations {
                    random.random_range(1.0..3.0)
                } else {
                    f64::from(u8::from(turned)) * random.random_range(0.2..0.6)
                }
            });
            let measured = G::from_components(edge.measurement.as_ref().unwrap()).unwrap();
            edge.measurement = Some(measured.compose(&G::exp(&off)).components());
        }
    }
    let mut mistakes = [0; 2];
    for finding in verify::<G, DOF>(&graph).unwrap().findings {
        if (finding.verdict == Verdict::Accepted) == is_wrong[finding.edge] {
            mistakes[usize::from(!is_wrong[finding.edge])] += 1;
        }
    }
    mistakes
}

/// With local errors as exceptions, the calibration explained them as noise, more than ten standard deviations of the claim large, and accepted
/// all in the plane. The correct edges lost here are undecided: local errors are so common that little evidence is not enough.
#[test]
fn wrong_measurements_of_the_right_places_are_found_where_most_are_wrong() {
    for (wrong, seed) in [(0.3, 1), (0.6, 2), (0.7, 4), (0.8, 7)] {
        for [kept, lost] in [mistakes::<SE2, 3>(wrong, true, seed), mistakes::<SE3, 6>(wrong, true, seed)] {
            assert_eq!(kept, 0, "{wrong}, seed {seed}");
            assert!(lost <= 15, "{wrong}, seed {seed}: {lost} correct edges lost");
        }
    }
}

/// Errors in translation alone: with one width for translation and rotation, the calibration explained them as drift of a few per cent, and
/// accepted most.
#[test]
fn wrong_translations_with_the_right_heading_are_found() {
    for (wrong, seed) in [(0.3, 1), (0.5, 2), (0.7, 4)] {
        for [kept, lost] in [mistakes::<SE2, 3>(wrong, false, seed), mistakes::<SE3, 6>(wrong, false, seed)] {
            assert_eq!(kept, 0, "{wrong}, seed {seed}");
            assert!(lost <= 10, "{wrong}, seed {seed}: {lost} correct edges lost");
        }
    }
}
