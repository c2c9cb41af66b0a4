//! Benchmark graphs as sessions: gaps to the batch optimum during the session, at its end, and after the final
//! relinearisation.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "functions of tests may panic, and this one prints its figures"
)]

use crate::{best_known, g2o, replay};
use posecut_isam::{IncrementalGroup, IncrementalOptions, IncrementalSolver};
use posecut_optimize::{Edge, Initialisation, Options, Problem, optimize};

fn check<G: IncrementalGroup<DOF>, const DOF: usize>(
    name: &str,
    (poses, edges): (Vec<G>, Vec<Edge<G, DOF>>),
) {
    let best = best_known::BEST_KNOWN.iter().find(|(known, _)| *known == name).unwrap().1;
    let mut solver = IncrementalSolver::<G, DOF>::new(IncrementalOptions::default()).unwrap();
    let mut seen = Vec::new();
    let spacing = poses.len() / 10;
    for (node, arrived) in replay::by_later_end(poses.len(), &edges).iter().enumerate() {
        // The poses of the file are not used: every pose starts where its first edge puts it.
        solver.add_pose(G::identity()).unwrap();
        for edge in arrived {
            solver.add_edge(*edge).unwrap();
        }
        solver.update();
        seen.extend_from_slice(arrived);
        if (node + 1) % spacing == 0 {
            let given = Options { initialisation: Initialisation::Given, ..Options::default() };
            let problem = Problem::new(solver.estimates(), seen.clone()).unwrap();
            let optimum = optimize(&problem, &given).cost;
            let gap = (solver.cost() - optimum) / optimum;
            println!("{name}: gap {gap:.1e} at pose {node}");
            assert!(gap < 1e-4, "{name}: {gap:e} at pose {node}");
        }
    }
    let gap = |cost: f64| (cost - best) / best;
    solver.relinearise_all();
    let polished = gap(solver.cost());
    let finish = solver.finish();
    println!("{name}: gap {polished:.1e} after one full relinearisation, {:.1e} after all", gap(finish.cost));
    assert!(polished < 1e-6, "{name}: {polished:e}");
    assert!(finish.converged && !finish.restarted && gap(finish.cost).abs() < 1e-8, "{name}: {finish:?}");
}

#[test]
fn benchmark_graphs_stay_near_the_optimum() {
    for name in ["M3500", "sphere2500", "city10000"] {
        let Some(text) = g2o::text(name) else { continue };
        if g2o::is_planar(&text) {
            check(name, g2o::planar(&text));
        } else {
            check(name, g2o::spatial(&text));
        }
    }
}
