//! The program: cuts pose graphs and plain instances, and checks certificates.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Context as _;
use clap::Parser;
use posecut_stage::{CommonArguments, Context, GraphStage as _, Identity, Outcome, Source, info, warn};

use crate::stage::delta::Delta;
use crate::stage::{Costs, CutGraph, StageOptions, note};
use crate::{Graph, Solution, VerifyError, read_mc, solve, verify};

/// What the input is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// A pose graph, JSON Lines
    Jsonl,
    /// A signed graph: a line MULTICUT, then `u v cost` a line; the output is one label a line
    Mc,
}

#[derive(Parser)]
struct Command {
    /// The graph to read (may be compressed); `-` is standard input
    #[arg(value_name = "INPUT", default_value = "-")]
    input: Source,

    /// What the input is
    #[arg(long, value_enum, default_value_t = Format::Jsonl)]
    format: Format,

    #[command(flatten)]
    stage: StageOptions,

    /// Write a certificate of the lower bound, which --verify checks
    #[arg(long, value_name = "FILE", conflicts_with = "verify", help_heading = "Proof")]
    certificate: Option<PathBuf>,

    /// Solve nothing: check a certificate against INPUT and say what it proves; exit status 1 if it does not hold
    #[arg(long, value_name = "FILE", help_heading = "Proof")]
    verify: Option<PathBuf>,

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
    posecut_stage::run_with_doubts::<Command>(
        identity,
        StageOptions::DOUBTS,
        |command| &command.common,
        |command, context| {
            command.check(context)?;
            match (&command.verify, command.format) {
                (Some(certificate), _) => command.check_certificate(certificate, context),
                (None, Format::Mc) => command.cut_instance(context),
                (None, Format::Jsonl) => command.cut_pose_graph(context),
            }
        },
    )
}

impl Command {
    /// Refuses options without a meaning here, and files that would overwrite each other.
    fn check(&self, context: &Context) -> anyhow::Result<()> {
        let options = &self.stage;
        options.solver_options(false)?;
        if self.format == Format::Mc {
            let plain = options.delta == Delta::Frames(1)
                && options.costs == Costs::Support
                && options.graph == CutGraph::Landmark
                && options.odometry_cost == 1.0;
            anyhow::ensure!(
                plain && !self.drop_rejected,
                "--delta, --costs, --graph, --odometry-cost and --drop-rejected are for pose graphs; an mc file has its costs, so leave them out"
            );
        }
        self.certificate.as_ref().map_or(Ok(()), |file| context.check_further_output("--certificate", file))
    }

    fn cut_pose_graph(&self, context: &mut Context) -> anyhow::Result<Outcome> {
        let mut graph = context.read_graph(&self.input, "graph")?;
        let solution = self.stage.cut(&mut graph, self.certificate.is_some(), context)?;
        context.record_provenance(&mut graph, &self.stage, self.stage.seed())?;
        if self.drop_rejected {
            graph.drop_rejected();
        }
        self.write_certificate(&solution)?;
        context.write_graph(&graph)?;
        Ok(Outcome::Done)
    }

    fn cut_instance(&self, context: &mut Context) -> anyhow::Result<Outcome> {
        let graph = self.read_instance()?;
        let options = self.stage.solver_options(self.certificate.is_some())?;
        let solution = solve(&graph, &options);
        if !graph.has_repulsive_edges() && !graph.edges().is_empty() {
            info!("no edge has a negative cost, so nothing is cut");
        }
        if graph.self_loops() > 0 {
            warn!(
                "{}",
                posecut_stage::counted(graph.self_loops(), "self-loop") + " left out: none can be cut"
            );
        }
        let clusters = solution.labels.iter().max().map_or(0, |&label| label as usize + 1);
        info!("objective {}, {}", solution.objective, posecut_stage::counted(clusters, "cluster"));
        let statistics = &mut context.statistics;
        statistics.note("nodes", graph.node_count());
        statistics.note("edges", graph.edges().len());
        statistics.note("self_loops", graph.self_loops());
        statistics.note("clusters", clusters);
        note(&solution, options.solver, context);
        self.write_certificate(&solution)?;
        context.write_bytes(&label_lines(&solution.labels))?;
        Ok(Outcome::Done)
    }

    fn check_certificate(&self, path: &Path, context: &mut Context) -> anyhow::Result<Outcome> {
        let graph = match self.format {
            Format::Mc => self.read_instance()?,
            Format::Jsonl => self.stage.cut_graph(&context.read_graph(&self.input, "graph")?)?,
        };
        let name = path.display();
        let certificate = posecut_stage::open_file(path)?;
        let (holds, words) = match verify(&graph, certificate) {
            Ok(verified) => {
                let statistics = &mut context.statistics;
                statistics.note("objective", verified.objective);
                statistics.note("lower_bound", verified.lower_bound);
                statistics.note(
                    "gap",
                    if verified.optimal { 0.0 } else { verified.objective - verified.lower_bound },
                );
                statistics.note("optimal", verified.optimal);
                let (objective, bound) = (verified.objective, verified.lower_bound);
                let words = if verified.optimal {
                    format!("{name}: proved: the labels cost {objective}, and no multicut costs less\n")
                } else {
                    format!(
                        "{name}: proved: the labels cost {objective}, and no multicut costs less than {bound}\n"
                    )
                };
                (true, words)
            }
            Err(error @ VerifyError::Refuted { .. }) => (false, format!("{name}: proves nothing: {error}\n")),
            Err(error) => return Err(error).context(name.to_string()),
        };
        context.statistics.note("holds", holds);
        context.write_bytes(words.as_bytes())?;
        Ok(if holds { Outcome::Done } else { Outcome::CheckFailed })
    }

    fn read_instance(&self) -> anyhow::Result<Graph> {
        let input = posecut_stage::open(&self.input)?;
        let name = input.name.clone();
        read_mc(input).context(name)
    }

    fn write_certificate(&self, solution: &Solution) -> anyhow::Result<()> {
        let (Some(path), Some(certificate)) = (&self.certificate, &solution.certificate) else {
            return Ok(());
        };
        posecut_stage::write_atomically(path, |mut writer| Ok(certificate.write(&mut writer)?))
    }
}

/// One label a line, in the order of the nodes.
fn label_lines(labels: &[u32]) -> Vec<u8> {
    use std::io::Write as _;
    let mut text = Vec::with_capacity(labels.len() * 8);
    for label in labels {
        // Writing to memory cannot fail.
        let _ = writeln!(text, "{label}");
    }
    text
}
