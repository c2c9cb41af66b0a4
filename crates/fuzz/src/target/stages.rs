//! Targets for stages: on every graph that the reader accepts, a stage must return a graph or one sentence.

use clap::Parser as _;
use posecut_graph::{EdgeKind, PoseGraph};
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

/// Checks that the stage's graph is valid, or is refused on writing because a number overflowed, and that no edge is lost.
fn graph_stage<S: GraphStage>(input: &[u8], options: &[&str]) -> Outcome {
    checked_stage::<S>(input, options, |_, _| ())
}

/// Like [`graph_stage`], with a further law on the graphs before and after the stage.
fn checked_stage<S: GraphStage>(
    input: &[u8],
    options: &[&str],
    check: impl Fn(&PoseGraph, &PoseGraph),
) -> Outcome {
    let Ok(mut graph) = PoseGraph::read("input", input) else {
        return Outcome::Refused("no graph".to_owned());
    };
    let before = graph.clone();
    let arguments = arguments::<S>(options);
    let identity =
        Identity { name: S::NAME, version: "0", about: S::ABOUT, place: S::PLACE, examples: S::EXAMPLES };
    let mut context = Context::new(identity, arguments.common);
    if let Err(error) = arguments.options.run(&mut graph, &mut context) {
        return Outcome::refused(error);
    }
    assert_eq!(graph.edges.len(), before.edges.len(), "a stage marks edges and removes none");
    check(&before, &graph);
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
    graph_stage::<posecut_pcm::stage::StageOptions>(
        input,
        &["--work-limit", "1000", "--grow", "0.9999", "--chance", "3"],
    )
}

pub(super) fn readmit(input: &[u8]) -> Outcome {
    graph_stage::<posecut_readmit::Options>(input, &["--scale", "auto", "--apply-scale"]);
    graph_stage::<posecut_readmit::Options>(input, &[])
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

pub(super) fn verify(input: &[u8]) -> Outcome {
    checked_stage::<posecut_verify::Options>(input, &["--undecided", "keep"], |before, after| {
        verdicts(before, after, true);
    });
    checked_stage::<posecut_verify::Options>(input, &[], |before, after| {
        verdicts(before, after, false);
    })
}

/// Checks that every landmark edge that was in use and has a measurement gets a verdict consistent with its other fields, and
/// that nothing else changes.
fn verdicts(before: &PoseGraph, after: &PoseGraph, undecided_stay: bool) {
    assert_eq!((&before.header, &before.nodes), (&after.header, &after.nodes));
    for (old, new) in before.edges.iter().zip(&after.edges) {
        let judged = old.kind == EdgeKind::Landmark && old.in_use() && old.measurement.is_some();
        if !judged {
            assert_eq!(old, new, "an edge that is not judged does not change");
            continue;
        }
        let text = |field: &str| new.extra[field].as_str().expect("a verdict and a reason are words");
        let verdict = text("verify_verdict");
        let in_use = match verdict {
            "accepted" => true,
            "rejected" => false,
            "undecided" => undecided_stay,
            other => panic!("{}: verdict {other}", new.name()),
        };
        assert_eq!(new.rejected_by.as_deref(), (!in_use).then_some("verify"), "{}: {verdict}", new.name());
        let reason = text("verify_reason");
        let known =
            ["supported", "contradicted", "chance", "vague", "alone", "other-hypothesis"].contains(&reason);
        assert!(
            known && (verdict == "accepted") == (reason == "supported"),
            "{}: {verdict}, {reason}",
            new.name()
        );
        let probability = new.extra["verify_probability"].as_f64().expect("a probability is a number");
        assert!((0.0..=1.0).contains(&probability), "{}: probability {probability}", new.name());
        let hypothesis = &new.extra["verify_hypothesis"];
        assert!(hypothesis.is_null() || hypothesis.is_u64(), "{}: hypothesis {hypothesis}", new.name());
        assert_eq!(
            verdict == "accepted",
            hypothesis.as_u64() == Some(0),
            "{}: hypothesis {hypothesis}",
            new.name()
        );
        let witnesses = new.extra["verify_witness"].as_array().expect("witnesses are a list");
        assert!(witnesses.len() <= 3);
        for witness in witnesses {
            let named = after.edges.iter().find(|edge| Some(edge.id) == witness.as_u64());
            let named = named.expect("a witness is an edge of the graph");
            assert_eq!(named.extra["verify_verdict"], "accepted", "{}: witness {witness}", new.name());
            assert_ne!(named.id, new.id, "no edge is its own witness");
        }
    }
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
        Ok(construction) => sound(&construction.graph),
        Err(error) => Outcome::refused(error),
    }
}
