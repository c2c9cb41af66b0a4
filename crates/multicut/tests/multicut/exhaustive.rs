//! Every solver compared with all partitions of small graphs.
use posecut_multicut::{Graph, Options, Solution, Solver, solve, verify};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Calls `visit` with every partition of `count` nodes, as labels in order of first appearance.
fn partitions(count: usize, visit: &mut impl FnMut(&[u32])) {
    fn extend(labels: &mut Vec<u32>, used: u32, count: usize, visit: &mut impl FnMut(&[u32])) {
        if labels.len() == count {
            return visit(labels);
        }
        for label in 0..=used {
            labels.push(label);
            extend(labels, used.max(label + 1), count, visit);
            labels.pop();
        }
    }
    extend(&mut Vec::new(), 0, count, visit);
}

/// The smallest objective over all these partitions.
fn minimum(graph: &Graph, all: &[Vec<u32>]) -> f64 {
    all.iter().map(|labels| graph.objective(labels).unwrap()).fold(f64::INFINITY, f64::min)
}

fn all_partitions(count: usize) -> Vec<Vec<u32>> {
    let mut all = Vec::new();
    partitions(count, &mut |labels| all.push(labels.to_vec()));
    all
}

/// Checks that labels are canonical, clusters are connected, and the objective is that of the labels.
fn check(graph: &Graph, solution: &Solution) {
    let mut next = 0;
    for &label in &solution.labels {
        assert!(label <= next, "labels are not numbered by first appearance");
        next = next.max(label + 1);
    }
    let mut reached: Vec<usize> = (0..graph.node_count()).collect();
    for _ in 0..graph.node_count() {
        for edge in graph.edges() {
            let (tail, head) = (edge.tail as usize, edge.head as usize);
            if solution.labels[tail] == solution.labels[head] {
                let least = reached[tail].min(reached[head]);
                (reached[tail], reached[head]) = (least, least);
            }
        }
    }
    for (node, &root) in reached.iter().enumerate() {
        let first = solution.labels.iter().position(|&label| label == solution.labels[node]);
        assert_eq!(first, Some(root), "cluster of node {node} is not connected");
    }
    let objective = graph.objective(&solution.labels).unwrap();
    assert!((objective - solution.objective).abs() <= 1e-9 * objective.abs().max(1.0));
}

fn compare(graph: &Graph, all: &[Vec<u32>]) {
    let optimum = minimum(graph, all);
    let tolerance = 1e-8 * optimum.abs().max(1.0);
    for solver in [Solver::Exact, Solver::Klj, Solver::Gaec] {
        let options = Options { solver, time_limit: None, certificate: true, ..Options::default() };
        let solution = solve(graph, &options);
        check(graph, &solution);
        let mut text = Vec::new();
        solution.certificate.as_ref().unwrap().write(&mut text).unwrap();
        let verified = verify(graph, text.as_slice()).unwrap();
        assert!(
            (verified.lower_bound - solution.lower_bound).abs() <= tolerance,
            "{verified:?} {solution:?}"
        );
        assert!((verified.objective - solution.objective).abs() <= tolerance, "{verified:?} {solution:?}");
        assert_eq!(verified.optimal, solution.optimal, "{verified:?} {solution:?} {graph:?}");
        assert!(solution.objective >= optimum - tolerance, "{solver:?} {solution:?} {optimum} {graph:?}");
        assert!(solution.lower_bound <= optimum + tolerance, "{solver:?} {solution:?} {optimum} {graph:?}");
        if solver == Solver::Exact || solution.optimal {
            assert!(solution.optimal);
            assert!((solution.objective - optimum).abs() <= tolerance, "{solution:?} {optimum} {graph:?}");
        }
    }
}

fn complete(count: usize) -> Vec<(u64, u64)> {
    (0..count as u64).flat_map(|u| (0..u).map(move |v| (u, v))).collect()
}

#[test]
fn all_signed_graphs_of_up_to_five_nodes() {
    for count in 0..=5 {
        let pairs = complete(count);
        let all = all_partitions(count);
        for code in 0..3u32.pow(pairs.len() as u32) {
            let sign = |index: usize| f64::from(code / 3u32.pow(index as u32) % 3) - 1.0;
            let edges = pairs.iter().enumerate().map(|(index, &(u, v))| (u, v, sign(index)));
            compare(&Graph::new(count, edges).unwrap(), &all);
        }
    }
}

#[test]
fn many_signed_graphs_of_six_to_eight_nodes() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for count in 6..=8 {
        let (pairs, all) = (complete(count), all_partitions(count));
        for _ in 0..[0, 0, 0, 0, 0, 0, 4000, 1500, 400][count] {
            let edges = pairs.iter().map(|&(u, v)| (u, v, f64::from(random.random_range(-1..=1))));
            compare(&Graph::new(count, edges).unwrap(), &all);
        }
    }
}

#[test]
fn weighted_graphs_of_up_to_nine_nodes() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for count in 3..=9 {
        let (pairs, all) = (complete(count), all_partitions(count));
        for round in 0..[0, 0, 0, 300, 300, 300, 300, 300, 150, 40][count] {
            let density = 0.3 + 0.7 * f64::from(round % 5) / 4.0;
            let mut edges = Vec::new();
            for &(u, v) in &pairs {
                if random.random::<f64>() < density {
                    edges.push((u, v, random.random_range(-1.0..1.0)));
                }
            }
            compare(&Graph::new(count, edges).unwrap(), &all);
        }
    }
}

#[test]
fn integer_weights_with_parallel_edges_and_loops() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let all = all_partitions(7);
    for _ in 0..800 {
        let edges: Vec<_> = (0..24)
            .map(|_| {
                let (u, v) = (random.random_range(0..7), random.random_range(0..7));
                (u, v, f64::from(random.random_range(-4..=5)))
            })
            .collect();
        compare(&Graph::new(7, edges).unwrap(), &all);
    }
}

#[test]
fn empty_graph_and_single_nodes() {
    let options = Options::default();
    let empty = solve(&Graph::new(0, []).unwrap(), &options);
    assert_eq!((empty.labels.len(), empty.objective, empty.optimal), (0, 0.0, true));
    let single = solve(&Graph::new(1, [(0, 0, -1.0)]).unwrap(), &options);
    assert_eq!((single.labels, single.objective, single.optimal), (vec![0], 0.0, true));
    let zero = solve(&Graph::new(2, [(0, 1, 0.0)]).unwrap(), &options);
    assert_eq!((zero.labels, zero.objective), (vec![0, 1], 0.0));
}
