//! Benchmark graphs as sessions: one pose a step, with its edges. Times per step, and gaps to the batch optimum at
//! checkpoints.
//!
//! `POSECUT_SHARED_DATA=... cargo bench -p posecut-isam --bench incremental [NAME...] [THRESHOLD=VALUE...]`
//!
//! Thresholds: `translation`, `rotation`, `propagate`, `error`, `every`, `iterations`; `checkpoints=N` says how many, 0 leaves only
//! times. Prints one JSON object a graph.

#![allow(clippy::print_stdout, reason = "a bench prints its figures")]

#[path = "../../optimize/tests/g2o/best_known.rs"]
mod best_known;
#[path = "../../optimize/tests/g2o/mod.rs"]
mod g2o;
#[path = "../tests/replay/mod.rs"]
mod replay;

use std::time::Instant;

use posecut_isam::{IncrementalOptions, IncrementalSolver};
use posecut_optimize::{Edge, Initialisation, Options, PoseGroup, Problem, optimize};

/// The time of a step: the update, and the estimate of the newest pose or of all.
struct Times {
    update: Vec<f64>,
    newest: f64,
    all: f64,
}

fn measure<G: PoseGroup<DOF>, const DOF: usize>(
    name: &str,
    best: f64,
    (poses, edges): (Vec<G>, Vec<Edge<G, DOF>>),
    options: IncrementalOptions,
    checkpoints: usize,
) -> Result<(), Box<dyn std::error::Error>> {
    let arrivals = replay::by_later_end(poses.len(), &edges);
    let mut solver = IncrementalSolver::<G, DOF>::new(options)?;
    let mut times = Times { update: Vec::new(), newest: 0.0, all: 0.0 };
    let (mut relinearised, mut linearised, mut eliminated, mut solved, mut restarts) = (0, 0, 0, 0, 0);
    let (mut worst_gap, mut gaps) = (0.0_f64, Vec::new());
    let spacing = if checkpoints == 0 { usize::MAX } else { poses.len().div_ceil(checkpoints) };
    let mut seen: Vec<Edge<G, DOF>> = Vec::new();
    for (node, arrived) in arrivals.iter().enumerate() {
        let start = Instant::now();
        solver.add_pose(G::identity())?;
        for edge in arrived {
            solver.add_edge(*edge)?;
        }
        let report = solver.update();
        times.update.push(start.elapsed().as_secs_f64() * 1e3);
        let start = Instant::now();
        std::hint::black_box(solver.estimate(node));
        times.newest += start.elapsed().as_secs_f64();
        let start = Instant::now();
        std::hint::black_box(solver.estimates());
        times.all += start.elapsed().as_secs_f64();
        relinearised += report.relinearised;
        linearised += report.linearised;
        eliminated += report.eliminated;
        solved += report.solved;
        restarts += usize::from(report.restarted);
        if checkpoints > 0 {
            seen.extend_from_slice(arrived);
            if (node + 1) % spacing == 0 || node + 1 == poses.len() {
                let problem = Problem::new(solver.estimates(), seen.clone())?;
                let given = Options { initialisation: Initialisation::Given, ..Options::default() };
                let optimum = optimize(&problem, &given).cost;
                let gap = (solver.cost() - optimum) / optimum.max(1.0);
                worst_gap = worst_gap.max(gap);
                gaps.push(format!("{gap:.2e}"));
            }
        }
    }
    let cost = solver.cost();
    let start = Instant::now();
    solver.relinearise_all();
    let polish = start.elapsed().as_secs_f64() * 1e3;
    let polished = solver.cost();
    let finish = solver.finish();
    let total: f64 = times.update.iter().sum();
    times.update.sort_by(f64::total_cmp);
    let quantile = |share: f64| times.update[((times.update.len() - 1) as f64 * share).round() as usize];
    println!(
        "{{\"graph\":\"{name}\",\"poses\":{},\"edges\":{},\"translation\":{},\"rotation\":{},\"propagate\":{},\"every\":{},\"iterations\":{},\
         \"total_s\":{:.4},\"newest_s\":{:.4},\"all_s\":{:.4},\"median_ms\":{:.4},\"p95_ms\":{:.4},\"p99_ms\":{:.4},\"max_ms\":{:.3},\
         \"relinearised\":{relinearised},\"linearised\":{linearised},\"eliminated\":{eliminated},\"solved\":{solved},\"restarts\":{restarts},\"cost\":{cost:.9},\"gap\":{:.2e},\"polish_ms\":{polish:.2},\
         \"polished_gap\":{:.2e},\"finished_gap\":{:.2e},\"finish_iterations\":{},\"restarted\":{},\"worst_checkpoint_gap\":{worst_gap:.2e},\"checkpoint_gaps\":[{}],\"megabytes\":{:.1}}}",
        poses.len(),
        edges.len(),
        options.relinearise_translation,
        options.relinearise_rotation,
        options.propagate,
        options.relinearise_every,
        options.iterations,
        total * 1e-3,
        total * 1e-3 + times.newest,
        total * 1e-3 + times.all,
        quantile(0.5),
        quantile(0.95),
        quantile(0.99),
        quantile(1.0),
        (cost - best) / best,
        (polished - best) / best,
        (finish.cost - best) / best,
        finish.iterations,
        finish.restarted,
        gaps.join(","),
        solver.bytes() as f64 / 1e6,
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut options = IncrementalOptions::default();
    let mut checkpoints = 10;
    let mut wanted = Vec::new();
    for word in std::env::args().skip(1).filter(|word| !word.starts_with("--")) {
        match word.split_once('=') {
            Some(("translation", value)) => options.relinearise_translation = value.parse()?,
            Some(("rotation", value)) => options.relinearise_rotation = value.parse()?,
            Some(("propagate", value)) => options.propagate = value.parse()?,
            Some(("error", value)) => options.linearisation_error = value.parse()?,
            Some(("every", value)) => options.relinearise_every = value.parse()?,
            Some(("iterations", value)) => options.iterations = value.parse()?,
            Some(("checkpoints", value)) => checkpoints = value.parse()?,
            Some((name, _)) => return Err(format!("there is no threshold '{name}'").into()),
            None => wanted.push(word),
        }
    }
    if wanted.is_empty() {
        wanted = ["M3500", "sphere2500", "city10000"].map(str::to_owned).to_vec();
    }
    for name in &wanted {
        let Some(&(name, best)) = best_known::BEST_KNOWN.iter().find(|(known, _)| known == name) else {
            return Err(format!("there is no benchmark graph '{name}'").into());
        };
        let Some(text) = g2o::text(name) else { continue };
        if g2o::is_planar(&text) {
            measure(name, best, g2o::planar(&text), options, checkpoints)?;
        } else {
            measure(name, best, g2o::spatial(&text), options, checkpoints)?;
        }
    }
    Ok(())
}
