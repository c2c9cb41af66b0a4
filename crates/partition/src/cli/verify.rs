//! Checks a certificate and reports what it proves.

use std::io::BufRead as _;
use std::path::PathBuf;

use anyhow::{Context as _, ensure};
use posecut_graph::PoseGraph;
use posecut_multicut::stage::cut_graph::CutOptions;
use posecut_multicut::{Graph, Verified, VerifyError, read_mc, verify};
use posecut_stage::{Context, Outcome, Source};

#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The certificate to check, from `posecut-partition solve` or `posecut-multicut`
    #[arg(value_name = "CERTIFICATE")]
    certificate: PathBuf,

    /// The graph that was cut (may be compressed): a signed graph as `solve` reads it, or a pose graph (JSON Lines); `-` is standard input
    #[arg(value_name = "INPUT", default_value = "-")]
    input: Source,

    /// Which signed graph the pose graph stands for.
    #[command(flatten, next_help_heading = "Pose graphs")]
    cut: CutOptions,
}

pub(crate) fn run(arguments: &Arguments, context: &mut Context) -> anyhow::Result<Outcome> {
    let graph = read(arguments, context)?;
    let path = &arguments.certificate;
    let name = path.display();
    let certificate = posecut_stage::open_file(path)?;
    context.note_read(path);
    let (outcome, words) = match verify(&graph, certificate) {
        Ok(verified) => {
            note(&verified, context);
            (Outcome::Done, format!("{name}: proved: {}\n", statement(&verified)))
        }
        Err(error @ VerifyError::Refuted { .. }) => {
            (Outcome::CheckFailed, format!("{name}: proves nothing: {error}\n"))
        }
        Err(error) => return Err(error).context(name.to_string()),
    };
    context.statistics.note("holds", outcome == Outcome::Done);
    context.write_bytes(words.as_bytes())?;
    Ok(outcome)
}

fn statement(verified: &Verified) -> String {
    let (objective, bound) = (verified.objective, verified.lower_bound);
    if verified.optimal {
        format!("the labels cost {objective}, and no multicut costs less")
    } else {
        format!("the labels cost {objective}, and no multicut costs less than {bound}")
    }
}

fn note(verified: &Verified, context: &mut Context) {
    let gap = if verified.optimal { 0.0 } else { verified.objective - verified.lower_bound };
    let statistics = &mut context.statistics;
    statistics.note("objective", verified.objective);
    statistics.note("lower_bound", verified.lower_bound);
    statistics.note("gap", gap);
    statistics.note("optimal", verified.optimal);
}

/// The signed graph of the input, which is an instance or a pose graph. JSON starts with a brace and an instance with a word,
/// so the first byte distinguishes them.
fn read(arguments: &Arguments, context: &mut Context) -> anyhow::Result<Graph> {
    let mut input = posecut_stage::open(&arguments.input)?;
    let name = input.name.clone();
    if let Source::File(path) = &arguments.input {
        context.note_read(path);
    }
    let start = input.fill_buf().with_context(|| format!("{name}: cannot be read"))?;
    if start.trim_ascii_start().starts_with(b"{") {
        return arguments.cut.cut_graph(&PoseGraph::read(&name, &mut input)?);
    }
    ensure!(
        arguments.cut == CutOptions::default(),
        "{name}: this is not a pose graph, but --delta, --costs, --graph and --odometry-cost are for pose graphs; a signed graph \
         has its own costs, so leave these options out"
    );
    read_mc(input).context(name)
}
