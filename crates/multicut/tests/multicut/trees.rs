//! Trees of cases in certificates: sound ones, and those that the verifier rejects.
use posecut_multicut::{Graph, Verified, VerifyError, verify};

/// A triangle of two attractive edges, which cost 2 and 3, and a repulsive one; joining all costs 0, the optimum is -2.
fn triangle() -> Graph {
    Graph::new(3, [(0, 1, 2.0), (1, 2, 3.0), (0, 2, -4.0)]).unwrap()
}

fn check(graph: &Graph, tree: &str) -> Result<Verified, VerifyError> {
    let list = |numbers: Vec<usize>| {
        let words: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        words.join(" ")
    };
    let nodes = list((0..graph.node_count()).collect());
    let labels = list((0..graph.node_count()).map(|node| node.min(1)).collect());
    let text = format!(
        "POSECUT-MULTICUT-CERTIFICATE 1\nlabels {labels}\ncomponent {nodes}\nreduce 1\npiece - {nodes}\n{tree}\nend\n"
    );
    verify(graph, text.as_bytes())
}

#[test]
fn sound_trees_are_accepted() {
    for (tree, bound) in [
        // Without weights, only the negative costs count.
        ("tree 0 1\nleaf", -4.0),
        ("tree 1 1\n1 0 1 2\nleaf 0 2", -2.0),
        // Too large a weight makes a reduced cost negative, which counts against the bound.
        ("tree 1 1\n1 0 1 2\nleaf 0 2.5", -2.0),
        ("tree 1 1\n1 0 1 2\nleaf 0 9", -13.0),
        // Where edge 0 1 is not paid, its capacity is no limit; where it is paid, it is paid in full.
        ("tree 1 3\n1 0 1 2\nsplit 0 1\nleaf 0 3\nleaf", -2.0),
        // Joining both ends of the repulsive edge costs 4 more than the trivial bound, so it may be taken for cut.
        ("tree 1 2\n1 0 1 2\nfixed 1\n0 2 0\nleaf 0 2", -2.0),
        // The same with the statement that 0 2 is cut only if 0 1 or 1 2 is: -4 + 2 y01 + 3 y12, y01 + y12 >= 1 - p.
        ("tree 1 1\nany 1 0 1 2\nleaf 0 2", -2.0),
    ] {
        let verified = check(&triangle(), tree).unwrap();
        assert_eq!(verified.lower_bound, bound, "{tree}");
        assert_eq!(verified.optimal, bound == -2.0);
    }
}

#[test]
fn two_sets_of_nodes_keep_one_edge_for_each_of_the_fewer() {
    // Node 0 attracts three nodes that repel each other: at most one of them stays.
    let attract = (1..4).map(|tip| (0, tip, 1.0));
    let graph = Graph::new(4, attract.chain([(1, 2, -5.0), (2, 3, -5.0), (1, 3, -5.0)])).unwrap();
    let verified = check(&graph, "tree 1 1\nparts 1 0 / 1 2 3\nleaf 0 1").unwrap();
    assert_eq!(verified.lower_bound, -13.0);
    let text = "pack 1\nparts 1 0 / 1 2 3";
    assert_eq!(check(&graph, text).unwrap().lower_bound, -13.0);
    for (parts, reason) in [
        ("parts 1 0 1 / 2 3", "wrong sign"),
        ("parts 1 1 2 3 / 0", "smaller one first"),
        ("parts 1 / 1 2 3", "smaller one first"),
        ("parts 1 0 / 1 1 2", "wrong sign"),
        ("parts 1 0 1 2 3", "smaller one first"),
        ("parts 2 0 / 1 2 3", "more than its cost"),
    ] {
        let error = check(&graph, &format!("pack 1\n{parts}")).unwrap_err().to_string();
        assert!(error.contains(reason), "{parts}: {error}");
    }
}

#[test]
fn spoiled_trees_are_refuted() {
    for (tree, reason) in [
        ("tree 1 1\n1 0 2 1\nleaf 0 2", "wrong sign"),
        ("tree 1 1\nany 1 0 1\nleaf 0 2", "three different nodes"),
        ("tree 1 1\nany 1 0 1 0\nleaf 0 2", "three different nodes"),
        ("tree 1 1\nany 1 0 1 9\nleaf 0 2", "no edge"),
        ("tree 1 1\n1 0 1 2\nleaf 1 2", "no inequality"),
        ("tree 1 1\n1 0 1 2\nleaf 0 -2", "positive"),
        ("tree 1 1\n1 0 1 2\nleaf 0", "not a number"),
        ("tree 1 2\n1 0 1 2\nsplit 0 1\nleaf 0 3", "more cases than it states"),
        ("tree 1 2\n1 0 1 2\nleaf 0 3\nleaf", "more cases than the tree has"),
        ("tree 1 3\n1 0 1 2\nsplit 0 0\nleaf 0 3\nleaf", "no edge"),
        ("tree 1 2\n1 0 1 2\nfixed 1\n0 2 2\nleaf 0 2", "0 or 1"),
        ("tree 1 3\n1 0 1 2\nfixed 1\n0 2 0\nfixed 1\n0 2 1\nleaf 0 2", "fixed already"),
        ("tree 1 1\n1 0 1 2\nbranch 0 1 9", "expected"),
    ] {
        let error = check(&triangle(), tree).unwrap_err().to_string();
        assert!(error.contains(reason), "{tree}: {error}");
    }
    // Fixing an edge at the payment that costs less proves no more than the payment left out.
    let verified = check(&triangle(), "tree 1 2\n1 0 1 2\nfixed 1\n0 1 1\nleaf").unwrap();
    assert_eq!(verified.lower_bound, -4.0);
}

/// A packing of nothing, and these windows.
fn windows(list: &[&str]) -> String {
    format!("windows 0 {}\n{}", list.len(), list.join("\n"))
}

#[test]
fn windows_share_capacity() {
    let window = |a: f64, b: f64, c: f64, weight: f64| {
        format!(
            "window 0 1 2\nedges 0 1 {a} 1 2 {b} 0 2 {c}\nreduce 1\npiece - 0 1 2\npack 1\n{weight} 0 1 2"
        )
    };
    // Each window takes half of edge 0 1, and gains that.
    let half = window(1.0, 1.5, -2.0, 1.0);
    let verified = check(&triangle(), &windows(&[&half, &half])).unwrap();
    assert_eq!((verified.lower_bound, verified.optimal), (-2.0, true));
    assert_eq!(check(&triangle(), &windows(&[&half])).unwrap().lower_bound, -3.0);
    // Conflicts take capacity first.
    let text = |weight: f64| format!("windows 1 1\n{weight} 0 1 2\n{half}");
    assert_eq!(check(&triangle(), &text(1.0)).unwrap().lower_bound, -2.0);
    for (proof, reason) in [
        (text(1.5), "takes 1 of edge 0 1"),
        (windows(&[&half, &half, &half]), "takes 1 of edge 0 1"),
        (windows(&[&window(2.5, 1.0, -1.0, 1.0)]), "takes 2.5 of edge 0 1"),
        (windows(&[&window(-1.0, 1.0, -1.0, 1.0)]), "takes -1 of edge 0 1"),
        (windows(&[&window(1.0, 1.0, f64::NAN, 1.0)]), "takes NaN of edge 0 2"),
        (windows(&["window 0 9\nedges"]), "no node 9"),
        (windows(&["window 0 1\nedges 0 2 1"]), "the window has no edge 0 2"),
        (windows(&["window 0 1\nedges 0 1 1 1 0 1"]), "appears twice"),
        (windows(&["window 0 1\nreduce 0"]), "expected `edges`"),
    ] {
        let error = check(&triangle(), &proof).unwrap_err().to_string();
        assert!(error.contains(reason), "{proof}: {error}");
    }
}
