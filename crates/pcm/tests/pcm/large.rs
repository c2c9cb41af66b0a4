//! Cells and growth on random scenarios, and candidates that arrive one by one.

use posecut_geometry::{SE2, SE3};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_pcm::candidate::group;
use posecut_pcm::cells::solve_by_cells;
use posecut_pcm::chain::Chains;
use posecut_pcm::chance::{Acceptance, COST};
use posecut_pcm::clique::{Limits, maximum_clique};
use posecut_pcm::consistency::Pairs;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_pcm::growth::grow;
use posecut_pcm::incremental::Incremental;
use posecut_pcm::{Gate, Spatial, Test};

fn gate<const DOF: usize>(probability: f64) -> Gate {
    Gate::new(Test::Mahalanobis, probability, DOF).unwrap()
}

/// Precision and recall of what is kept.
fn judged(graph: &PoseGraph, edges: &[usize], kept: &[usize]) -> (f64, f64) {
    let correct = |&&candidate: &&usize| graph.edges[edges[candidate]].truth_correct() == Some(true);
    let all: Vec<usize> = (0..edges.len()).collect();
    let right = kept.iter().filter(correct).count() as f64;
    (right / kept.len() as f64, right / all.iter().filter(correct).count() as f64)
}

#[test]
fn cells_keep_the_correct_edges_of_every_scenario() {
    for falsehood in [Falsehood::Uniform, Falsehood::Grouped, Falsehood::NearMiss] {
        for outliers in [0.1, 0.5, 0.9] {
            let scenario = Scenario { candidates: 20_000, outliers, falsehood, seed: 7 };
            let graph = scenario.draw::<SE2, 3>();
            let chains = Chains::<SE2, 3>::of(&graph).unwrap();
            let grouped = group(&graph, &chains).unwrap();
            let pairs = Pairs::new(&chains, &grouped.groups[0]);
            let solution = solve_by_cells(
                &pairs,
                gate::<3>(0.99),
                gate::<3>(0.99),
                10.0,
                Limits::work(1000),
                Acceptance::within_group(COST),
            );
            let kept = [&solution.members[..], &solution.grown[..]].concat();
            let edges: Vec<usize> =
                grouped.groups[0].candidates.iter().map(|candidate| candidate.edge).collect();
            let (precision, recall) = judged(&graph, &edges, &kept);
            println!("{falsehood:?} {outliers}: precision {precision:.4}, recall {recall:.4}");
            // A correct edge's noise of 0.1 m cannot reveal all near misses of half a metre, and there are up to nine times
            // as many near misses as correct edges. In the other cases one run in four keeps a false edge on average; here
            // it is two in six.
            let (least, back) = if falsehood == Falsehood::NearMiss { (0.5, 0.95) } else { (0.9985, 0.998) };
            assert!(precision >= least && recall >= back, "{falsehood:?} {outliers}: {precision} {recall}");
        }
    }
}

#[test]
fn cells_do_not_depend_on_the_number_of_threads() {
    let scenario = Scenario { candidates: 3000, outliers: 0.5, falsehood: Falsehood::Grouped, seed: 2 };
    let graph = scenario.draw::<SE2, 3>();
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let pairs = Pairs::new(&chains, &grouped.groups[0]);
    let solve = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let solution = solve_by_cells(
                &pairs,
                gate::<3>(0.99),
                gate::<3>(0.99),
                10.0,
                Limits::NONE,
                Acceptance::within_group(COST),
            );
            let (matrix, _) = pairs.graph(gate::<3>(0.99));
            (solution.members, solution.grown, solution.degrees, maximum_clique(&matrix, Limits::NONE))
        })
    };
    let one = solve(1);
    assert_eq!(one, solve(2));
    assert_eq!(one, solve(7));
}

#[test]
fn growth_brings_back_what_single_pairs_cost() {
    let scenario = Scenario { candidates: 1000, outliers: 0.5, falsehood: Falsehood::Uniform, seed: 11 };
    let graph = scenario.draw::<SE3, 6>();
    let chains = Chains::<SE3, 6>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let pairs = Pairs::new(&chains, &grouped.groups[0]);
    let edges: Vec<usize> = grouped.groups[0].candidates.iter().map(|candidate| candidate.edge).collect();
    let (matrix, _) = pairs.graph(gate::<6>(0.99));
    let clique = maximum_clique(&matrix, Limits::NONE);
    assert!(clique.is_optimal());
    let (_, before) = judged(&graph, &edges, &clique.vertices);
    let grown = grow(&pairs, &clique.vertices, gate::<6>(0.9999), Acceptance::within_group(COST)).grown;
    let kept = [&clique.vertices[..], &grown[..]].concat();
    let (precision, after) = judged(&graph, &edges, &kept);
    assert!(before < 0.95 && after > 0.99 && precision > 0.999, "{before} {after} {precision}");
}

#[test]
fn too_few_members_grow_nothing() {
    let scenario = Scenario { candidates: 50, outliers: 0.0, falsehood: Falsehood::Uniform, seed: 1 };
    let graph = scenario.draw::<SE2, 3>();
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let pairs = Pairs::new(&chains, &grouped.groups[0]);
    assert!(grow(&pairs, &[0, 1], gate::<3>(0.9999), Acceptance::within_group(COST)).grown.is_empty());
}

/// Candidates that arrive one by one give a clique of the same size, a proof, and the same graph.
fn one_by_one<G: Spatial<DOF>, const DOF: usize>(outliers: f64, falsehood: Falsehood) {
    let scenario = Scenario { candidates: 250, outliers, falsehood, seed: 9 };
    let graph = scenario.draw::<G, DOF>();
    let chains = Chains::<G, DOF>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let limit = gate::<DOF>(0.99);
    let (whole, _) = Pairs::new(&chains, &grouped.groups[0]).graph(limit);
    let count = graph.nodes.len() as u64 / 2;
    let mut pcm = Incremental::new(
        chains.chains[0].clone(),
        chains.chains[1].clone(),
        limit.squared_distance,
        Limits::NONE,
    );
    for (number, edge) in graph.edges_of(EdgeKind::Landmark).enumerate() {
        let measurement = G::from_components(edge.measurement.as_ref().unwrap()).unwrap();
        let information =
            posecut_geometry::covariance::unpack_upper_triangle(graph.information(edge).unwrap()).unwrap();
        let covariance =
            posecut_geometry::covariance::covariance_from_information::<DOF>(&information).unwrap();
        let update = pcm.add(edge.from as usize, (edge.to - count) as usize, &measurement, &covariance);
        assert_eq!(update.candidate, number);
        assert!(pcm.graph().is_clique(pcm.clique()));
        assert_eq!(pcm.upper_bound(), pcm.clique().len(), "a proof survives every candidate");
    }
    for one in 0..whole.len() {
        for other in 0..whole.len() {
            assert_eq!(pcm.graph().connected(one, other), whole.connected(one, other));
        }
    }
    assert_eq!(pcm.clique().len(), maximum_clique(&whole, Limits::NONE).vertices.len());
}

#[test]
fn candidates_that_come_one_by_one_make_the_same_clique() {
    for (outliers, falsehood) in
        [(0.1, Falsehood::Uniform), (0.6, Falsehood::Grouped), (0.9, Falsehood::NearMiss)]
    {
        one_by_one::<SE2, 3>(outliers, falsehood);
        one_by_one::<SE3, 6>(outliers, falsehood);
    }
}
