//! One solver on one graph: seconds of the optimisation alone, the best of some repeats.
//!
//! `posecut-optimize-peers SOLVER IN.g2o OUT.g2o REPEATS` prints a line of JSON. Every solver gets the same parsed graph,
//! builds its own structures before the clock starts, and uses its own default or recommended tolerances.

mod apex;
mod arael_planar;
mod arael_spatial;
mod factrs_solver;
mod graph;
mod posecut;
mod tiny;

use graph::{Graph, Outcome};

/// Repeats end after this time in total.
const MOST_SECONDS: f64 = 3.0;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [solver, input, output, repeats] = arguments.as_slice() else {
        eprintln!("usage: posecut-optimize-peers SOLVER IN.g2o OUT.g2o REPEATS");
        std::process::exit(2);
    };
    let graph = Graph::read(input);
    let solve: fn(&Graph, &str) -> Outcome = match (solver.as_str(), graph.planar) {
        ("posecut", _) => posecut::solve,
        ("posecut-given", _) => posecut::solve_given,
        ("arael", true) => arael_planar::solve,
        ("arael", false) => arael_spatial::solve,
        ("factrs", _) => factrs_solver::solve,
        ("apex", _) => apex::solve,
        ("tiny", _) => tiny::solve,
        _ => panic!("{solver} is none of posecut, posecut-given, arael, factrs, apex, tiny"),
    };
    let (mut seconds, mut total) = (f64::INFINITY, 0.0);
    let mut last = None;
    for _ in 0..repeats.parse().expect("a number of repeats") {
        let outcome = solve(&graph, input);
        seconds = seconds.min(outcome.seconds);
        total += outcome.seconds;
        last = Some(outcome);
        if total > MOST_SECONDS {
            break;
        }
    }
    let outcome = last.expect("at least one repeat");
    graph.write(&outcome.poses, output);
    let iterations = outcome.iterations.map_or("null".to_owned(), |count| count.to_string());
    println!("{{\"seconds\":{seconds},\"iterations\":{iterations}}}");
}
