//! The number of threads: as many as requested, at most one for each processor.

use std::io;
use std::num::NonZero;
use std::thread::Builder;

use anyhow::Context as _;

use crate::{counted, warn};

/// The environment variables from which rayon reads the number of threads.
const VARIABLES: [&str; 2] = ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"];

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}

/// The requested number of threads, but at most the number of processors, with a warning. 0 stays 0.
pub(crate) fn bounded(threads: usize) -> usize {
    let processors = processors();
    if threads > processors {
        warn!(
            "--threads {threads} exceeds the number of available processors; using {}",
            counted(processors, "thread")
        );
    }
    threads.min(processors)
}

/// Whether a further thread can be started.
pub(crate) fn probe() -> io::Result<()> {
    Builder::new().spawn(|| {}).map(drop)
}

/// Starts the threads for computations: this number, or for 0 the number from the environment or of the processors. Rayon would
/// start them when they are first needed, and panic on a failure; here a failure is an error.
pub(crate) fn start(threads: usize) -> anyhow::Result<()> {
    let of_environment =
        || VARIABLES.iter().filter_map(|name| std::env::var(name).ok()?.trim().parse().ok()).max();
    let threads = match threads {
        // Bound the number from the environment: a program with very many threads never starts.
        0 => of_environment().filter(|&threads: &usize| threads > processors()).map_or(0, |_| processors()),
        threads => threads,
    };
    let mut pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    // Try one thread first, because a pool that failed cannot be built again.
    if let Err(cause) = probe() {
        warn!("no further thread can be started ({cause}); using 1 thread");
        pool = pool.num_threads(1).use_current_thread();
    }
    pool.build_global().context("the threads cannot be started; try fewer with --threads")
}
