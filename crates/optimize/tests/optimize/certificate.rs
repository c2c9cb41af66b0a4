//! Certificates: global where SE-Sync's is, never on a planted local minimum.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "functions of tests may panic and print")]

use crate::g2o;
use nalgebra::Matrix3;
use posecut_geometry::SE2;
use posecut_optimize::{Edge, EdgeKind, Initialisation, Options, PoseGroup, Problem, certify, optimize};

/// A ring whose steps do not turn; its start turns once along its length.
#[test]
fn a_planted_local_minimum_is_never_called_global() {
    let nodes = 30;
    let edges: Vec<_> = (0..nodes)
        .map(|i| {
            Edge::new(i, (i + 1) % nodes, SE2::new(0.0, 0.0, 0.0), Matrix3::identity(), EdgeKind::Odometry)
        })
        .collect();
    for turns in [0, 1, 2, -1] {
        let turn = f64::from(turns) * std::f64::consts::TAU / nodes as f64;
        let poses: Vec<_> = (0..nodes).map(|i| SE2::new(0.0, 0.0, turn * i as f64)).collect();
        let problem = Problem::new(poses, edges.clone()).unwrap();
        let options = Options { initialisation: Initialisation::Given, ..Options::default() };
        let solution = optimize(&problem, &options);
        let certificate = &certify(&problem, &solution.poses)[0];
        assert_eq!(certificate.global, turns == 0, "{turns} {} {certificate:?}", solution.chi_square);
        assert!(certificate.lower_bound <= 1e-6, "the least cost is zero: {certificate:?}");
        assert_eq!(certificate.eigenvalue < -certificate.tolerance, turns != 0, "{certificate:?}");
    }
}

fn check<G: PoseGroup<DOF>, const DOF: usize>(name: &str, best: f64, graph: (Vec<G>, Vec<Edge<G, DOF>>)) {
    let problem = Problem::new(graph.0, graph.1).unwrap();
    let solution = optimize(&problem, &Options::default());
    let certificate = &certify(&problem, &solution.poses)[0];
    println!("{name}: {certificate:?}");
    assert!(certificate.global, "{name}: {certificate:?}");
    // The published costs have seven digits; that of sphere_a is 3e-6 above the minimum.
    assert!(certificate.cost < best * (1.0 + 1e-6), "{name}: {certificate:?}");
}

#[test]
fn graphs_that_se_sync_certifies_are_global() {
    let planar = [
        ("CSAIL", 31.70372),
        ("MIT", 61.15412),
        ("intel", 52.34823),
        ("intel_carlone", 393.6525),
        ("ringCity", 271.7759),
        ("kitti_00", 125.6935),
        ("M3500", 193.8623),
        ("M3500a", 1597.636),
        ("city10000", 638.6246),
    ];
    for (name, best) in planar {
        let Some(text) = g2o::text(name) else { continue };
        check(name, best, g2o::planar(&text));
    }
    let spatial = [
        ("smallGrid3D", 1025.398),
        ("parking-garage", 1.262_524),
        ("torus3D", 24_227.05),
        ("sphere2500", 1687.006),
        ("sphere_a", 2_961_764.5),
    ];
    for (name, best) in spatial {
        let Some(text) = g2o::text(name) else { continue };
        check(name, best, g2o::spatial(&text));
    }
}
