//! One limit of work for all groups of a run.

use std::fmt::Write as _;

use clap::Parser as _;
use posecut_graph::PoseGraph;
use posecut_pcm::stage::StageOptions;
use posecut_stage::{CommonArguments, Context, GraphStage, Identity};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Nodes of a chain, and candidates between two of them.
const NODES: usize = 20;
const CANDIDATES: usize = 300;
const CHAINS: usize = 4;

#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    options: StageOptions,
    #[command(flatten)]
    common: CommonArguments,
}

/// Chains in space, with many candidates between each two of them that disagree somewhat, so that each maximum clique needs
/// branching.
fn cliques() -> PoseGraph {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":3,\"noise_models\":{\"n\":{\"information\":[100,0,0,0,0,0,100,0,0,0,0,100,0,0,0,400,0,0,400,0,400]}}}\n".to_owned();
    for node in 0..CHAINS * NODES {
        let (session, frame) = (node / NODES, node % NODES);
        let _ = writeln!(text, r#"{{"kind":"node","id":{node},"session":"{session}","frame":{frame}}}"#);
    }
    for from in (0..CHAINS * NODES).filter(|from| from % NODES != NODES - 1) {
        let to = from + 1;
        let _ = writeln!(
            text,
            r#"{{"kind":"odometry","id":{from},"from":{from},"to":{to},"measurement":[1,0,0,0,0,0,1],"noise":"n"}}"#
        );
    }
    let mut id = CHAINS * NODES;
    for (one, other) in (0..CHAINS).flat_map(|other| (0..other).map(move |one| (one, other))) {
        for _ in 0..CANDIDATES {
            let [from, to] = std::array::from_fn(|_| random.random_range(0..NODES));
            let [x, y, z]: [f64; 3] = std::array::from_fn(|_| random.random_range(-1.2..1.2));
            let [qx, qy, qz]: [f64; 3] = std::array::from_fn(|_| random.random_range(-0.12..0.12));
            let qw = (1.0 - qx * qx - qy * qy - qz * qz).sqrt();
            let x = x + to as f64 - from as f64;
            let (from, to) = (one * NODES + from, other * NODES + to);
            let _ = writeln!(
                text,
                r#"{{"kind":"landmark","id":{id},"from":{from},"to":{to},"measurement":[{x},{y},{z},{qx},{qy},{qz},{qw}],"noise":"n"}}"#
            );
            id += 1;
        }
    }
    PoseGraph::read("cliques", text.as_bytes()).unwrap()
}

/// The number of nodes of all searches together.
fn work(graph: &PoseGraph, limit: u64) -> u64 {
    let line = Line::parse_from(["pcm", "--quiet", "--work-limit", &limit.to_string()]);
    let identity = Identity {
        name: StageOptions::NAME,
        version: "0",
        about: StageOptions::ABOUT,
        place: StageOptions::PLACE,
        examples: StageOptions::EXAMPLES,
    };
    let mut context = Context::new(identity, line.common);
    line.options.run(&mut graph.clone(), &mut context).unwrap();
    context.statistics.as_map()["branch_and_bound_nodes"].as_u64().unwrap()
}

/// Every group had the whole limit for itself.
#[test]
fn all_groups_together_keep_to_the_limit() {
    let graph = cliques();
    let groups = CHAINS * (CHAINS - 1) / 2;
    for limit in [60, 600] {
        let work = work(&graph, limit);
        // A search ends soon after its share, in each group.
        assert!(work > limit / 2 && work <= limit + 2 * groups as u64, "{work} of {limit}");
    }
}
