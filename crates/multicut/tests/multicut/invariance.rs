//! Numbering, order, seeds and limits: which changes of them may affect an answer, and which may not.
use posecut_multicut::generate::{Family, generate};
use posecut_multicut::{Graph, Options, Solver, solve, verify};
use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

type Edges = Vec<(u64, u64, f64)>;

/// A sparse random graph; costs of +1 and -1 leave many ties.
fn sparse(nodes: u64, edges: usize, attractive: f64, random: &mut ChaCha8Rng) -> Edges {
    (0..edges)
        .map(|_| {
            let cost = if random.random::<f64>() < attractive { 1.0 } else { -1.0 };
            (random.random_range(0..nodes), random.random_range(0..nodes), cost)
        })
        .collect()
}

/// Renumbers the nodes, and changes the order and the directions of the edges.
fn renumber(edges: &Edges, nodes: u64, random: &mut ChaCha8Rng) -> (Vec<u64>, Edges) {
    let mut numbers: Vec<u64> = (0..nodes).collect();
    numbers.shuffle(random);
    let mut renumbered: Edges = edges
        .iter()
        .map(|&(u, v, cost)| {
            let (u, v) = (numbers[u as usize], numbers[v as usize]);
            if random.random() { (u, v, cost) } else { (v, u, cost) }
        })
        .collect();
    renumbered.shuffle(random);
    (numbers, renumbered)
}

/// The sizes of the clusters, which symmetries of the graph do not change.
fn sizes(labels: &[u32]) -> Vec<usize> {
    let mut sizes = vec![0; labels.len()];
    for &label in labels {
        sizes[label as usize] += 1;
    }
    sizes.sort_unstable();
    sizes
}

#[test]
fn answers_do_not_depend_on_numbering() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    for round in 0..25 {
        let edges = sparse(60, 130, 0.7, &mut random);
        let (_, renumbered) = renumber(&edges, 60, &mut random);
        for solver in [Solver::Exact, Solver::Klj, Solver::Gaec] {
            let options = Options { solver, time_limit: None, ..Options::default() };
            let first = solve(&Graph::new(60, edges.clone()).unwrap(), &options);
            let second = solve(&Graph::new(60, renumbered.clone()).unwrap(), &options);
            assert_eq!(first.objective, second.objective, "{round} {solver:?}");
            assert_eq!(sizes(&first.labels), sizes(&second.labels), "{round} {solver:?}");
        }
    }
}

#[test]
fn answers_for_large_components_do_not_depend_on_numbering() {
    let mut random = ChaCha8Rng::seed_from_u64(15);
    let graph = generate(Family::Aliased, 2_000, 0.5, 1).unwrap();
    let edges: Edges =
        graph.edges().iter().map(|edge| (edge.tail.into(), edge.head.into(), edge.cost)).collect();
    let (_, renumbered) = renumber(&edges, 4_000, &mut random);
    for (solver, work_limit) in
        [(Solver::Exact, 30_000_000), (Solver::Klj, u64::MAX), (Solver::Gaec, u64::MAX)]
    {
        let options =
            Options { solver, time_limit: None, work_limit: Some(work_limit), ..Options::default() };
        let first = solve(&graph, &options);
        let second = solve(&Graph::new(4_000, renumbered.clone()).unwrap(), &options);
        assert!(first.largest_kernel.1 > 3_000);
        assert_eq!(first.objective, second.objective, "{solver:?}");
        assert_eq!(sizes(&first.labels), sizes(&second.labels), "{solver:?}");
    }
}

#[test]
fn unique_optima_are_the_same_partition_after_renumbering() {
    let mut random = ChaCha8Rng::seed_from_u64(12);
    for _ in 0..15 {
        let mut edges = sparse(40, 110, 0.6, &mut random);
        for edge in &mut edges {
            edge.2 *= random.random_range(0.5..1.5);
        }
        let (numbers, renumbered) = renumber(&edges, 40, &mut random);
        let options = Options { time_limit: None, ..Options::default() };
        let first = solve(&Graph::new(40, edges).unwrap(), &options);
        let second = solve(&Graph::new(40, renumbered).unwrap(), &options);
        for u in 0..40 {
            for v in 0..u {
                let apart = second.labels[numbers[u] as usize] != second.labels[numbers[v] as usize];
                assert_eq!(first.labels[u] != first.labels[v], apart);
            }
        }
    }
}

#[test]
fn a_work_limit_stops_at_the_same_place_with_valid_bounds() {
    let mut random = ChaCha8Rng::seed_from_u64(13);
    let graph = Graph::new(400, sparse(400, 3000, 0.5, &mut random)).unwrap();
    let mut last = (f64::INFINITY, f64::NEG_INFINITY);
    for work_limit in [0, 1_000, 100_000, 10_000_000] {
        let options = Options {
            time_limit: None,
            work_limit: Some(work_limit),
            certificate: true,
            ..Options::default()
        };
        let (first, second) = (solve(&graph, &options), solve(&graph, &options));
        assert_eq!((&first.labels, first.lower_bound), (&second.labels, second.lower_bound));
        assert_eq!(graph.objective(&first.labels).unwrap(), first.objective);
        assert!(first.lower_bound <= first.objective);
        assert!(last.1 <= first.objective && first.lower_bound <= last.0, "bounds contradict each other");
        let mut text = Vec::new();
        first.certificate.unwrap().write(&mut text).unwrap();
        let verified = verify(&graph, text.as_slice()).unwrap();
        assert_eq!((verified.objective, verified.lower_bound), (first.objective, first.lower_bound));
        last = (last.0.min(first.objective), last.1.max(first.lower_bound));
    }
}

#[test]
fn a_limit_is_overshot_by_little() {
    let graph = generate(Family::Follow, 10_000, 0.1, 4).unwrap();
    let passes = 20 * (graph.node_count() + graph.edges().len()) as u64;
    let run = |solver, work_limit| {
        let options =
            Options { solver, time_limit: None, work_limit: Some(work_limit), ..Options::default() };
        solve(&graph, &options)
    };
    let attractive = graph.edges().iter().filter(|edge| edge.cost > 0.0).count();
    // Once the budget is over, nothing is decomposed, contracted or packed any more.
    let over = run(Solver::Exact, 0);
    assert!(over.kernel_edges >= attractive && over.work <= passes, "{} {}", over.kernel_edges, over.work);
    for solver in [Solver::Gaec, Solver::Klj, Solver::Exact] {
        for work_limit in [200_000, 1_000_000, 5_000_000, 25_000_000] {
            let work = run(solver, work_limit).work;
            assert!(work <= work_limit + work_limit / 10 + passes, "{solver:?} {work_limit} {work}");
        }
    }
}

#[test]
fn a_spoiled_certificate_is_refuted() {
    let mut random = ChaCha8Rng::seed_from_u64(14);
    let graph = Graph::new(12, sparse(12, 60, 0.6, &mut random)).unwrap();
    let optimum = solve(&graph, &Options::default()).objective;
    // The exact solver needs cases; the heuristics end with a packing.
    for (solver, kind) in [(Solver::Exact, "\ntree "), (Solver::Klj, "\npack ")] {
        let solution = solve(&graph, &Options { solver, certificate: true, ..Options::default() });
        let mut text = Vec::new();
        solution.certificate.as_ref().unwrap().write(&mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(verify(&graph, text.as_bytes()).unwrap().lower_bound, solution.lower_bound);
        assert!(text.contains(kind), "{text}");
        refute_changes(&graph, &text, optimum);
    }
}

/// No change of a single number may prove a bound above the optimum.
fn refute_changes(graph: &Graph, text: &str, optimum: f64) {
    let lines: Vec<&str> = text.lines().collect();
    let mut refuted = 0;
    for (index, line) in lines.iter().enumerate().skip(2) {
        let words: Vec<&str> = line.split(' ').collect();
        for place in 0..words.len() {
            for spoiled in ["0", "1", "3", "7", "1000", "-1", "x"] {
                let mut words = words.clone();
                words[place] = spoiled;
                let line = words.join(" ");
                let mut lines = lines.clone();
                lines[index] = &line;
                match verify(graph, lines.join("\n").as_bytes()) {
                    Ok(verified) => assert!(verified.lower_bound <= optimum, "line {index}: {line}"),
                    Err(_) => refuted += 1,
                }
            }
        }
        let cut = lines[..index].join("\n");
        assert!(verify(graph, cut.as_bytes()).is_err(), "a truncated certificate");
    }
    assert!(refuted > 100);
}
