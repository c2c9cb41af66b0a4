//! Stages on graphs that were read: whatever the reader takes, a stage answers with a graph or a sentence.

use clap::Parser as _;
use posecut_graph::PoseGraph;
use posecut_stage::{CommonArguments, Context, GraphStage, Identity};

use super::Outcome;

#[derive(clap::Parser)]
struct Arguments<O: clap::Args> {
    #[command(flatten)]
    options: O,
    #[command(flatten)]
    common: CommonArguments,
}

fn arguments<O: clap::Args>(more: &[&str]) -> Arguments<O> {
    let line = ["stage"].iter().chain(more);
    Arguments::try_parse_from(line).expect("these are its options")
}

/// The stage's graph is sound, or cannot be written because a number left the range of doubles, which is said. No edge
/// is lost.
fn graph_stage<S: GraphStage>(input: &[u8], options: &[&str]) -> Outcome {
    let Ok(mut graph) = PoseGraph::read("input", input) else {
        return Outcome::Refused("no graph".to_owned());
    };
    let edges = graph.edges.len();
    let arguments = arguments::<S>(options);
    let identity = Identity { name: S::NAME, version: "0", about: S::ABOUT };
    let mut context = Context::new(identity, arguments.common);
    if let Err(error) = arguments.options.run(&mut graph, &mut context) {
        return Outcome::refused(error);
    }
    assert_eq!(graph.edges.len(), edges, "a stage marks edges and removes none");
    sound(&graph)
}

fn sound(graph: &PoseGraph) -> Outcome {
    let mut bytes = Vec::new();
    if let Err(error) = graph.write(&mut bytes) {
        return Outcome::refused(error);
    }
    PoseGraph::read("again", bytes.as_slice()).expect("a stage writes sound graphs");
    let rejected = graph.edges.iter().filter(|edge| !edge.in_use()).count();
    Outcome::Read(format!(
        "{} nodes, {} edges, {} rejected",
        graph.nodes.len().min(9),
        graph.edges.len().min(9),
        rejected.min(3)
    ))
}

pub(super) fn pcm(input: &[u8]) -> Outcome {
    graph_stage::<posecut_pcm::Options>(input, &["--work-limit", "1000", "--grow", "0.9999", "--chance", "3"])
}

pub(super) fn multicut(input: &[u8]) -> Outcome {
    graph_stage::<posecut_multicut::stage::StageOptions>(
        input,
        &["--costs", "field", "--work-limit", "100000"],
    );
    graph_stage::<posecut_multicut::stage::StageOptions>(
        input,
        &["--graph", "full", "--work-limit", "100000"],
    );
    graph_stage::<posecut_multicut::stage::StageOptions>(input, &[])
}

pub(super) fn optimize(input: &[u8]) -> Outcome {
    graph_stage::<posecut_optimize::stage::StageOptions>(input, &["--max-iterations", "5"])
}

pub(super) fn gnc(input: &[u8]) -> Outcome {
    graph_stage::<posecut_optimize::stage::StageOptions>(
        input,
        &["--gnc", "--reject-below", "0.5", "--max-iterations", "5"],
    )
}

pub(super) fn ransac(input: &[u8]) -> Outcome {
    graph_stage::<posecut_ransac::Options>(input, &["--set-size", "2", "--most-trials", "100"]);
    graph_stage::<posecut_ransac::Options>(input, &["--most-trials", "100"])
}

pub(super) fn islands(input: &[u8]) -> Outcome {
    graph_stage::<posecut_islands::Options>(input, &[])
}

pub(super) fn densest(input: &[u8]) -> Outcome {
    graph_stage::<posecut_densest::Options>(input, &["--select", "rounded"]);
    graph_stage::<posecut_densest::Options>(input, &[])
}

pub(super) fn voting(input: &[u8]) -> Outcome {
    graph_stage::<posecut_voting::Options>(input, &["--election", "joint"]);
    graph_stage::<posecut_voting::Options>(input, &[])
}

pub(super) fn oracle(input: &[u8]) -> Outcome {
    graph_stage::<posecut_oracle::Options>(input, &[])
}

pub(super) fn evaluate(input: &[u8]) -> Outcome {
    let Ok(graph) = PoseGraph::read("input", input) else { return Outcome::Refused("no graph".to_owned()) };
    let options = arguments::<posecut_evaluate::Options>(&[]).options;
    match posecut_evaluate::evaluate(&graph, None, &options) {
        Ok(result) => {
            Outcome::Read(format!("{} poses, {} parts", result.poses.min(9), result.components.min(3)))
        }
        Err(error) => Outcome::refused(error),
    }
}

pub(super) fn construct(input: &[u8]) -> Outcome {
    let Ok(graph) = PoseGraph::read("input", input) else { return Outcome::Refused("no graph".to_owned()) };
    let options =
        arguments::<posecut_construct::Options>(&["--radius", "8", "--incorrect-rate", "0.3"]).options;
    match posecut_construct::construct(vec![graph], &posecut_construct::Landmarks::Truth, &options) {
        Ok((graph, _)) => sound(&graph),
        Err(error) => Outcome::refused(error),
    }
}
