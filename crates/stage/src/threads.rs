//! As many threads as asked for, and no more than processors.

use std::io;
use std::num::NonZero;
use std::thread::Builder;

use anyhow::Context as _;

use crate::{counted, warn};

/// The variables by which rayon learns how many threads to start.
const VARIABLES: [&str; 2] = ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"];

fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}

/// The number asked for, or that of processors if it is less, with a warning; 0 stays 0.
pub(crate) fn bounded(threads: usize) -> usize {
    let processors = processors();
    if threads > processors {
        warn!(
            "--threads {threads} is more than this machine has use for; using {}",
            counted(processors, "thread")
        );
    }
    threads.min(processors)
}

/// Whether a further thread can be started.
pub(crate) fn probe() -> io::Result<()> {
    Builder::new().spawn(|| {}).map(drop)
}

/// Starts the threads of computations: this number, or for 0 what the environment or the processors say. Started here, and not where
/// they are first needed, a failure is no panic.
pub(crate) fn start(threads: usize) -> anyhow::Result<()> {
    let of_environment =
        || VARIABLES.iter().filter_map(|name| std::env::var(name).ok()?.trim().parse().ok()).max();
    let threads = match threads {
        // Many more would never start.
        0 => of_environment().filter(|&threads: &usize| threads > processors()).map_or(0, |_| processors()),
        threads => threads,
    };
    let mut pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    // Tried before, since a pool that failed cannot be asked for again.
    if let Err(cause) = probe() {
        warn!("no further thread can be started ({cause}); using one");
        pool = pool.num_threads(1).use_current_thread();
    }
    pool.build_global().context("the threads cannot be started; try fewer with --threads")
}
