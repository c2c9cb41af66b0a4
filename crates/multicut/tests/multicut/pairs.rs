//! The rule of pairs in certificates.
use posecut_multicut::{Graph, Options, Verified, VerifyError, solve, verify};

/// Two clusters of three nodes each with equal costs to all others, joined by weak edges, and a node that likes both clusters.
fn twins() -> Graph {
    let inside = [0u64, 3].into_iter().flat_map(|at| [(at, at + 1), (at, at + 2), (at + 1, at + 2)]);
    let across = (0..3u64).flat_map(|u| (3..6).map(move |v| (u, v, -2.0)));
    let both = (0..6u64).map(|u| (u, 6, 3.0));
    Graph::new(7, inside.map(|(u, v)| (u, v, 0.1)).chain(across).chain(both)).unwrap()
}

fn certificate(graph: &Graph) -> (String, f64) {
    let solution = solve(graph, &Options { certificate: true, ..Options::default() });
    let mut text = Vec::new();
    solution.certificate.as_ref().unwrap().write(&mut text).unwrap();
    (String::from_utf8(text).unwrap(), solution.objective)
}

#[test]
fn nodes_with_equal_costs_are_joined_and_the_certificate_says_so() {
    let graph = twins();
    let solution = solve(&graph, &Options::default());
    assert_eq!(solution.kernel_nodes, 0);
    assert_eq!(solution.labels[..6], [0, 0, 0, 1, 1, 1]);
    let (text, objective) = certificate(&graph);
    assert!(text.contains("\np "), "{text}");
    let verified = verify(&graph, text.as_bytes()).unwrap();
    assert!(verified.optimal && verified.lower_bound == objective);
}

/// An edge of cost 2 between nodes 0 and 1, which attract node 2 and node 3, and repel the other one.
fn check(step: &str) -> Result<Verified, VerifyError> {
    let graph = Graph::new(4, [(0, 1, 2.0), (0, 2, 2.0), (1, 2, -9.0), (1, 3, 2.0), (0, 3, -9.0)]).unwrap();
    let text = format!(
        "POSECUT-MULTICUT-CERTIFICATE 1\nlabels 0 1 2 3\ncomponent 0 1 2 3\nreduce 1\npiece - 0 1 2 3\n{step}\nend\n"
    );
    verify(&graph, text.as_bytes())
}

#[test]
fn a_pair_that_some_placement_of_the_others_holds_apart_is_refuted() {
    for (step, reason) in [
        // Both attracted nodes together hold the pair apart: moving out loses 4.
        ("p 0 1 0 0 1", "but may lose 4"),
        ("p 0 1 1 0 0", "but may lose 11"),
        ("p 0 1 0.5 0.5 0", "but may lose 11"),
        ("p 0 2 0 0 0", "shares"),
        ("p 0 1 -1 1 1", "shares"),
        ("p 0 1 NaN 1 1", "shares"),
        ("p 0 1 1e308 1e308 1e308", "shares"),
        ("p 1 2 0 0 1", "gains -9"),
        ("p 0 0 0 0 1", "gains 0"),
        ("p 0 4 0 0 1", "no node 4"),
        ("p 0 1 1 0", "word 6"),
    ] {
        let error = check(step).unwrap_err().to_string();
        assert!(error.contains(reason), "{step}: {error}");
    }
}
