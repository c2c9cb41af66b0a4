//! The lowest known cost is reached on every benchmark graph, from the file's poses and from odometry.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use crate::{best_known, g2o};
use posecut_optimize::initialisation::spanning_tree;
use posecut_optimize::{Edge, Options, PoseGroup, Problem, ProblemError, optimize};

fn check<G: PoseGroup<DOF>, const DOF: usize>(name: &str, best: f64, graph: (Vec<G>, Vec<Edge<G, DOF>>)) {
    let (poses, edges) = graph;
    let odometry = spanning_tree(&poses, &edges);
    for poses in [poses, odometry] {
        let problem = Problem::new(poses, edges.clone()).unwrap();
        let solution = optimize(&problem, &Options::default());
        let gap = (solution.chi_square - best) / best;
        assert!(solution.converged, "{name}: {:?}", solution.components);
        // The published figures have twelve digits.
        assert!((-1e-10..1e-6).contains(&gap), "{name}: {} is {gap:e} above {best}", solution.chi_square);
    }
}

#[test]
fn the_lowest_known_cost_is_reached() {
    for (name, best) in best_known::BEST_KNOWN {
        let Some(text) = g2o::text(name) else { continue };
        if g2o::is_planar(&text) {
            check(name, best, g2o::planar(&text));
        } else {
            check(name, best, g2o::spatial(&text));
        }
    }
}

#[test]
fn indefinite_information_is_refused_by_edge() {
    let Some(text) = g2o::text("cubicle") else { return };
    let (poses, edges) = g2o::spatial(&text);
    let error = Problem::new(poses, edges).unwrap_err();
    assert!(matches!(error, ProblemError::Indefinite { edge: 2, from: 1, to: 2, .. }), "{error}");
}

/// Eigenvalues from 11 to 3e12, and from 1.5e-9 to 4 (by numpy): accepted and listed.
#[test]
fn information_that_is_singular_in_print_is_accepted_and_listed() {
    if let Some(text) = g2o::text("intel_carlone") {
        let (poses, edges) = g2o::planar(&text);
        assert_eq!(Problem::new(poses, edges).unwrap().semidefinite(), [160]);
    }
    if let Some(text) = g2o::text("parking-garage") {
        let (poses, edges) = g2o::spatial(&text);
        let problem = Problem::new(poses, edges).unwrap();
        assert_eq!((problem.semidefinite().len(), problem.semidefinite()[0]), (3, 1932));
    }
    if let Some(text) = g2o::text("torus3D") {
        let (poses, edges) = g2o::spatial(&text);
        assert!(Problem::new(poses, edges).unwrap().semidefinite().is_empty());
    }
}
