//! `cargo xtask measure`: measures time and memory of programs, and writes tables of documents.

mod cliques;
mod incremental;
mod lag;
mod memory;
mod multicut;
mod optimize;
mod pcm;
mod peers;
mod priors;
mod programs;
mod proofs;
mod recognition;
mod simulation;
mod verify;

use clap::{Args, Subcommand};

use crate::Verdict;

/// Measure programs, some of them against other tools, and regenerate the tables of docs/results
#[derive(Args)]
pub(crate) struct Measure {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Memory(memory::Memory),
    #[command(hide = true)]
    Graph(memory::graph::Graph),
    Pcm(pcm::Pcm),
    Cliques(cliques::Cliques),
    Verify(verify::Verify),
    Optimize(optimize::Optimize),
    Incremental(incremental::Incremental),
    Lag(lag::Lag),
    Multicut(multicut::Multicut),
    MulticutProofs(proofs::Proofs),
    Recognition(recognition::Recognition),
    Simulation(simulation::Simulation),
    Priors(priors::Priors),
}

impl Measure {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        match self.what {
            What::Memory(task) => task.run(),
            What::Graph(task) => task.run(),
            What::Pcm(task) => task.run(),
            What::Cliques(task) => task.run(),
            What::Verify(task) => task.run(),
            What::Optimize(task) => task.run(),
            What::Incremental(task) => task.run(),
            What::Lag(task) => task.run(),
            What::Multicut(task) => task.run(),
            What::MulticutProofs(task) => task.run(),
            What::Recognition(task) => task.run(),
            What::Simulation(task) => task.run(),
            What::Priors(task) => task.run(),
        }
    }
}
