//! Changes that must not change a verdict: threads, names of nodes, order of lines, frame of the initial poses.

use std::collections::{BTreeMap, HashMap};

use clap::Parser as _;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_stage::{CommonArguments, Context, GraphStage, Identity};
use posecut_verify::verdict::Verdict;
use posecut_verify::{Motion, Options, verify};
use proptest::prelude::*;

#[derive(clap::Parser)]
struct Line {
    #[command(flatten)]
    options: Options,
    #[command(flatten)]
    common: CommonArguments,
}

/// The graph as the stage writes it after judging with this number of threads.
fn written(graph: &PoseGraph, threads: usize) -> Vec<u8> {
    let line = Line::parse_from(["verify"]);
    let identity = Identity {
        name: Options::NAME,
        version: "0",
        about: Options::ABOUT,
        place: Options::PLACE,
        examples: Options::EXAMPLES,
    };
    let mut context = Context::new(identity, line.common);
    let mut graph = graph.clone();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| line.options.run(&mut graph, &mut context)).unwrap();
    let mut bytes = Vec::new();
    graph.write(&mut bytes).unwrap();
    bytes
}

/// The verdict on every landmark edge, by id.
fn verdicts<G: Motion<DOF>, const DOF: usize>(graph: &PoseGraph) -> BTreeMap<u64, Verdict> {
    let findings = verify::<G, DOF>(graph).unwrap().findings;
    findings.iter().map(|finding| (graph.edges[finding.edge].id, finding.verdict)).collect()
}

/// Exchanges the ids of nodes; `order` gives the permutation as sort keys.
fn relabelled(graph: &PoseGraph, order: &[u64]) -> PoseGraph {
    let mut ids: Vec<u64> = graph.nodes.iter().map(|node| node.id).collect();
    let mut keys: Vec<(u64, u64)> =
        ids.iter().map(|&id| (order[id as usize % order.len()].rotate_left(id as u32 % 64), id)).collect();
    keys.sort_unstable();
    ids.sort_unstable();
    // The new ids are far apart, and not in the order of the chain.
    let new: HashMap<u64, u64> =
        keys.into_iter().zip(ids).map(|((_, old), place)| (old, 1000 + 7 * place)).collect();
    rebuilt(graph, |graph| {
        for node in &mut graph.nodes {
            node.id = new[&node.id];
        }
        for edge in &mut graph.edges {
            (edge.from, edge.to) = (new[&edge.from], new[&edge.to]);
        }
    })
}

/// A changed copy, read back from its file, so that no state of the old graph remains.
fn rebuilt(graph: &PoseGraph, change: impl FnOnce(&mut PoseGraph)) -> PoseGraph {
    let mut changed = graph.clone();
    change(&mut changed);
    let mut bytes = Vec::new();
    changed.write(&mut bytes).unwrap();
    PoseGraph::read("changed", bytes.as_slice()).unwrap()
}

fn shuffled(graph: &PoseGraph, order: &[u64]) -> PoseGraph {
    rebuilt(graph, |graph| {
        graph.edges.sort_by_key(|edge| {
            (order[edge.id as usize % order.len()].rotate_left(edge.id as u32 % 64), edge.id)
        });
    })
}

/// The same nodes as sessions of forty nodes each, named by `name`.
fn in_pieces(graph: &PoseGraph, name: impl Fn(u64) -> String) -> PoseGraph {
    const LENGTH: u64 = 40;
    rebuilt(graph, |graph| {
        graph.edges.retain(|edge| edge.kind != EdgeKind::Odometry || edge.from / LENGTH == edge.to / LENGTH);
        for node in &mut graph.nodes {
            node.session = Some(name(node.id / LENGTH));
            node.frame = Some((node.id % LENGTH) as i64);
        }
    })
}

/// Sets initial poses from the odometry, with the second session elsewhere, and then moves all of them.
fn placed<G: LieGroup<DOF>, const DOF: usize>(graph: &PoseGraph, motion: &G) -> PoseGraph {
    let mut graph = graph.clone();
    let mut pose = G::identity();
    let steps: HashMap<u64, G> = graph
        .edges
        .iter()
        .filter(|edge| edge.kind == EdgeKind::Odometry)
        .map(|edge| (edge.to, G::from_components(edge.measurement.as_ref().unwrap()).unwrap()))
        .collect();
    for node in &mut graph.nodes {
        pose = steps.get(&node.id).map_or_else(G::identity, |step| pose.compose(step));
        node.pose = Some(motion.compose(&pose).components());
    }
    graph
}

fn scenario() -> impl Strategy<Value = Scenario> {
    let kind = prop_oneof![Just(Falsehood::Uniform), Just(Falsehood::Grouped), Just(Falsehood::NearMiss)];
    (40..200_usize, 0.0..0.7_f64, kind, 0..1000_u64).prop_map(|(candidates, outliers, falsehood, seed)| {
        Scenario { candidates, outliers, falsehood, seed }
    })
}

fn order() -> impl Strategy<Value = Vec<u64>> {
    prop::collection::vec(any::<u64>(), 31)
}

fn moved<const DOF: usize>() -> impl Strategy<Value = nalgebra::SVector<f64, DOF>> {
    prop::collection::vec(-1.5..1.5_f64, DOF).prop_map(|values| {
        nalgebra::SVector::from_fn(|axis, _| {
            // Translations of hundreds of metres, and any heading.
            if axis < if DOF == 3 { 2 } else { 3 } { 300.0 * values[axis] } else { values[axis] }
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_same_bytes_at_one_two_and_four_threads(scenario in scenario(), spatial in any::<bool>()) {
        let graph = if spatial { scenario.draw::<SE3, 6>() } else { scenario.draw::<SE2, 3>() };
        let one = written(&graph, 1);
        prop_assert!(one == written(&graph, 2), "two threads");
        prop_assert!(one == written(&graph, 4), "four threads");
    }

    #[test]
    fn other_names_of_nodes_in_the_same_order_change_no_verdict(scenario in scenario(), factor in 2..1000_u64) {
        let plane = scenario.draw::<SE2, 3>();
        let renamed = rebuilt(&plane, |graph| {
            for node in &mut graph.nodes {
                node.id = factor * node.id + 7;
            }
            for edge in &mut graph.edges {
                (edge.from, edge.to) = (factor * edge.from + 7, factor * edge.to + 7);
            }
        });
        prop_assert_eq!(verdicts::<SE2, 3>(&plane), verdicts::<SE2, 3>(&renamed));
    }

    // The order of ids decided which chain was A, and the calibration then ended in another optimum.
    #[test]
    fn names_of_nodes_change_no_verdict(scenario in scenario(), order in order()) {
        let plane = scenario.draw::<SE2, 3>();
        prop_assert_eq!(verdicts::<SE2, 3>(&plane), verdicts::<SE2, 3>(&relabelled(&plane, &order)));
    }

    // Sessions were sorted by name, and with a dozen of them the calibration ended in another optimum.
    #[test]
    fn names_of_sessions_change_no_verdict(scenario in scenario()) {
        let plane = scenario.draw::<SE2, 3>();
        let (one, other) = (in_pieces(&plane, |piece| format!("{piece:04}")), in_pieces(&plane, |piece| format!("{:04}", 9999 - piece)));
        prop_assert_eq!(verdicts::<SE2, 3>(&one), verdicts::<SE2, 3>(&other));
    }

    #[test]
    fn the_order_of_edge_lines_changes_no_verdict(scenario in scenario(), order in order()) {
        let plane = scenario.draw::<SE2, 3>();
        prop_assert_eq!(verdicts::<SE2, 3>(&plane), verdicts::<SE2, 3>(&shuffled(&plane, &order)));
    }

    #[test]
    fn a_motion_of_all_initial_poses_changes_no_verdict(
        scenario in scenario(), plane in moved::<3>(), space in moved::<6>()
    ) {
        let graph = scenario.draw::<SE2, 3>();
        let still = verdicts::<SE2, 3>(&placed(&graph, &SE2::identity()));
        prop_assert_eq!(&still, &verdicts::<SE2, 3>(&placed(&graph, &SE2::exp(&plane))));
        prop_assert_eq!(&still, &verdicts::<SE2, 3>(&graph), "with and without initial poses");
        let graph = Scenario { candidates: 60, ..scenario }.draw::<SE3, 6>();
        let still = verdicts::<SE3, 6>(&placed(&graph, &SE3::identity()));
        prop_assert_eq!(still, verdicts::<SE3, 6>(&placed(&graph, &SE3::exp(&space))));
    }
}
