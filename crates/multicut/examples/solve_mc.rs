//! Solves an instance in the mc format and prints its solution and bound.
#![allow(clippy::print_stdout)]

use std::time::{Duration, Instant};

use posecut_multicut::{Options, Solver, read_mc, solve};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: solve_mc FILE.mc [exact|klj|gaec] [SECONDS [certificate]]")?;
    let solver = match arguments.next().as_deref() {
        Some("klj") => Solver::Klj,
        Some("gaec") => Solver::Gaec,
        _ => Solver::Exact,
    };
    let seconds = arguments.next().map_or(Ok(60.0), |text| text.parse())?;
    let certificate = arguments.next().is_some();
    let start = Instant::now();
    let graph = read_mc(std::fs::File::open(&path)?)?;
    let read = start.elapsed().as_secs_f64();
    let time_limit = Some(Duration::from_secs_f64(seconds));
    let solution = solve(&graph, &Options { solver, time_limit, certificate, ..Options::default() });
    if let Some(certificate) = &solution.certificate {
        let mut text = Vec::new();
        certificate.write(&mut text)?;
        let start = Instant::now();
        let verified = posecut_multicut::verify(&graph, text.as_slice())?;
        println!("{verified:?} from {} bytes in {:.2} s", text.len(), start.elapsed().as_secs_f64());
    }
    println!(
        "{path}: objective {} bound {} optimal {} kernel {}/{} (largest {:?}) read {read:.2} s solve {:.2} s work {:.2e}",
        solution.objective,
        solution.lower_bound,
        solution.optimal,
        solution.kernel_nodes,
        solution.kernel_edges,
        solution.largest_kernel,
        solution.seconds,
        solution.work as f64,
    );
    Ok(())
}
