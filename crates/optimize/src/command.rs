//! The program: batch or incremental.

use std::io::Write as _;
use std::process::ExitCode;

use clap::{Parser, ValueEnum as _};
use posecut_stage::{CommonArguments, Context, GraphStage as _, Identity, Outcome, Source};

use crate::incremental::IncrementalStageOptions;
use crate::stage::{Graduation, RobustOptions, StageOptions};

/// How the graph is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Solver {
    /// All at once
    Batch,
    /// As it comes: pose by pose, edges taken back by `retract` records
    Isam2,
}

#[derive(Parser)]
struct Command {
    /// The pose graph to read (JSON Lines, may be compressed); `-` is standard input
    #[arg(value_name = "INPUT", default_value = "-")]
    input: Source,

    /// How the graph is solved
    #[arg(long, value_enum, default_value_t = Solver::Batch)]
    solver: Solver,

    #[command(flatten)]
    stage: StageOptions,

    #[command(flatten)]
    incremental: IncrementalStageOptions,

    /// Leave rejected edges out of the output instead of marking them
    #[arg(long, help_heading = "Output")]
    drop_rejected: bool,

    #[command(flatten)]
    common: CommonArguments,
}

/// The program's `main`.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: StageOptions::NAME,
        version: env!("CARGO_PKG_VERSION"),
        about: StageOptions::ABOUT,
        place: StageOptions::PLACE,
    };
    if let Some(cost) = separate_cost(std::env::args_os()) {
        // To the parser the cost would be the input file, and the file one argument too many.
        let _ = writeln!(
            std::io::stderr(),
            "posecut-{}: error: --gnc takes its cost with an equals sign: write --gnc={cost} (a file of this name: ./{cost})",
            identity.name
        );
        return ExitCode::from(2);
    }
    posecut_stage::run_with_doubts::<Command>(
        identity,
        StageOptions::DOUBTS,
        |command| &command.common,
        |command, context| {
            let mut graph = command.optimise(context)?;
            if command.drop_rejected {
                graph.drop_rejected();
            }
            context.write_graph(&graph)?;
            Ok(Outcome::Done)
        },
    )
}

/// The name of a cost that follows `--gnc` as an argument of its own.
fn separate_cost(arguments: impl Iterator<Item = std::ffi::OsString>) -> Option<String> {
    let words: Vec<String> =
        arguments.map(|word| word.to_string_lossy().into_owned()).take_while(|word| word != "--").collect();
    words
        .windows(2)
        .find(|pair| pair[0] == "--gnc" && Graduation::from_str(&pair[1], false).is_ok())
        .map(|pair| pair[1].clone())
}

impl Command {
    fn optimise(&self, context: &mut Context) -> anyhow::Result<posecut_graph::PoseGraph> {
        let Self { stage, incremental, .. } = self;
        let defaults = Self::try_parse_from([StageOptions::NAME])?;
        if self.solver == Solver::Isam2 {
            let RobustOptions { kernel_odometry, kernel_landmark, .. } = stage.robust;
            let kernels = RobustOptions { kernel_odometry, kernel_landmark, ..defaults.stage.robust };
            anyhow::ensure!(
                *stage == StageOptions { robust: kernels, ..defaults.stage },
                "of the options of the batch solver, --solver isam2 takes --kernel-odometry and --kernel-landmark only; leave the others out"
            );
            return incremental.run(&self.input, stage, context);
        }
        anyhow::ensure!(
            *incremental == defaults.incremental,
            "options of the incremental solver were given without it; add --solver isam2"
        );
        let mut graph = context.read_graph(&self.input, "graph")?;
        stage.run(&mut graph, context)?;
        context.record_provenance(&mut graph, stage, stage.seed())?;
        Ok(graph)
    }
}
