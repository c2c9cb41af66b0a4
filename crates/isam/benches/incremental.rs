//! Benchmark graphs as sessions: one pose per step, with its edges. Times per step, and gaps to the batch optimum at
//! checkpoints.
//!
//! `POSECUT_SHARED_DATA=... cargo bench -p posecut-isam --bench incremental [NAME...] [THRESHOLD=VALUE...]`
//!
//! Thresholds: `translation`, `rotation`, `propagate`, `error`, `every`, `iterations`. `checkpoints=N` sets the number of
//! checkpoints; with 0 it measures only times. Prints one JSON object per graph.

#![allow(clippy::print_stdout, reason = "a bench prints its figures")]

#[path = "../../optimize/tests/g2o/best_known.rs"]
mod best_known;
#[path = "../../optimize/tests/g2o/mod.rs"]
mod g2o;
#[path = "../tests/replay/mod.rs"]
mod replay;

use std::time::Instant;

use posecut_isam::{IncrementalGroup, IncrementalOptions, IncrementalSolver, UpdateReport};
use posecut_optimize::{Edge, Initialisation, Options, Problem, optimize};

/// The times of the steps: milliseconds for each update, and seconds for all estimates of the newest pose and of all poses.
#[derive(Default)]
struct Times {
    update: Vec<f64>,
    newest: f64,
    all: f64,
}

/// What updates did, over all steps.
#[derive(Default)]
struct Work {
    relinearised: usize,
    linearised: usize,
    eliminated: usize,
    solved: usize,
    restarts: usize,
}

impl Work {
    fn add(&mut self, report: &UpdateReport) {
        self.relinearised += report.relinearised;
        self.linearised += report.linearised;
        self.eliminated += report.eliminated;
        self.solved += report.solved;
        self.restarts += usize::from(report.restarted);
    }
}

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// The share by which the cost exceeds that of a batch solution of these edges.
fn gap<G: IncrementalGroup<DOF>, const DOF: usize>(
    solver: &IncrementalSolver<G, DOF>,
    edges: &[Edge<G, DOF>],
) -> Outcome<f64> {
    let problem = Problem::new(solver.estimates(), edges.to_vec())?;
    let given = Options { initialisation: Initialisation::Given, ..Options::default() };
    let optimum = optimize(&problem, &given).cost;
    Ok((solver.cost() - optimum) / optimum.max(1.0))
}

fn measure<G: IncrementalGroup<DOF>, const DOF: usize>(
    name: &str,
    best: f64,
    (poses, edges): (Vec<G>, Vec<Edge<G, DOF>>),
    options: IncrementalOptions,
    checkpoints: usize,
) -> Outcome<()> {
    let arrivals = replay::by_later_end(poses.len(), &edges);
    let mut solver = IncrementalSolver::<G, DOF>::new(options)?;
    let (mut times, mut work, mut gaps) = (Times::default(), Work::default(), Vec::new());
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
        work.add(&report);
        if checkpoints > 0 {
            seen.extend_from_slice(arrived);
            if (node + 1) % spacing == 0 || node + 1 == poses.len() {
                gaps.push(gap(&solver, &seen)?);
            }
        }
    }
    print(name, best, edges.len(), &mut solver, options, times, &work, &gaps);
    Ok(())
}

/// Relinearises, finishes, and prints the results.
#[allow(clippy::too_many_arguments, reason = "all of it is printed once")]
fn print<G: IncrementalGroup<DOF>, const DOF: usize>(
    name: &str,
    best: f64,
    edges: usize,
    solver: &mut IncrementalSolver<G, DOF>,
    options: IncrementalOptions,
    mut times: Times,
    work: &Work,
    gaps: &[f64],
) {
    let cost = solver.cost();
    let start = Instant::now();
    solver.relinearise_all();
    let polish = start.elapsed().as_secs_f64() * 1e3;
    let polished = solver.cost();
    let finish = solver.finish();
    let total = times.update.iter().sum::<f64>() * 1e-3;
    times.update.sort_by(f64::total_cmp);
    let quantile = |share: f64| times.update[((times.update.len() - 1) as f64 * share).round() as usize];
    let Work { relinearised, linearised, eliminated, solved, restarts } = work;
    let worst_gap = gaps.iter().copied().fold(0.0, f64::max);
    let gaps: Vec<String> = gaps.iter().map(|gap| format!("{gap:.2e}")).collect();
    println!(
        "{{\"graph\":\"{name}\",\"poses\":{},\"edges\":{},\"translation\":{},\"rotation\":{},\"propagate\":{},\"every\":{},\"iterations\":{},\
         \"total_s\":{:.4},\"newest_s\":{:.4},\"all_s\":{:.4},\"median_ms\":{:.4},\"p95_ms\":{:.4},\"p99_ms\":{:.4},\"max_ms\":{:.3},\
         \"relinearised\":{relinearised},\"linearised\":{linearised},\"eliminated\":{eliminated},\"solved\":{solved},\"restarts\":{restarts},\"cost\":{cost:.9},\"gap\":{:.2e},\"polish_ms\":{polish:.2},\
         \"polished_gap\":{:.2e},\"finished_gap\":{:.2e},\"finish_iterations\":{},\"restarted\":{},\"worst_checkpoint_gap\":{worst_gap:.2e},\"checkpoint_gaps\":[{}],\"megabytes\":{:.1}}}",
        solver.poses(),
        edges,
        options.relinearise_translation,
        options.relinearise_rotation,
        options.propagate,
        options.relinearise_every,
        options.iterations,
        total,
        total + times.newest,
        total + times.all,
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
}

fn main() -> Outcome<()> {
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
