//! Odd wheels in certificates: those that the solver writes, and those that the verifier rejects.
use posecut_multicut::{Graph, Options, Verified, VerifyError, solve, verify};

/// Node 0 attracts the nodes of a ring, which repel each other.
fn wheel_graph(ring: u64) -> Graph {
    let edges = (0..ring).flat_map(|i| [(0, i + 1, 2.0), (i + 1, (i + 1) % ring + 1, -3.0)]);
    Graph::new(ring as usize + 1, edges).unwrap()
}

fn check(conflict: &str) -> Result<Verified, VerifyError> {
    let text = format!(
        "POSECUT-MULTICUT-CERTIFICATE 1\nlabels 0 0 1 2\ncomponent 0 1 2 3\nreduce 1\npiece - 0 1 2 3\npack 1\n{conflict}\nend\n"
    );
    verify(&wheel_graph(3), text.as_bytes())
}

#[test]
fn proofs_hold_wheels_where_cycles_are_not_enough() {
    // Cycles give half a spoke for each node of the ring, and an odd ring costs half a spoke more.
    for (ring, optimum) in [(3, -5.0), (5, -9.0), (7, -13.0)] {
        let graph = wheel_graph(ring);
        let solution = solve(&graph, &Options { certificate: true, ..Options::default() });
        assert!(solution.optimal && solution.objective == optimum, "{solution:?}");
        let mut text = Vec::new();
        solution.certificate.unwrap().write(&mut text).unwrap();
        assert!(verify(&graph, text.as_slice()).unwrap().optimal);
        let text = String::from_utf8(text).unwrap();
        assert!(text.contains("\nwheel "), "{text}");
    }
}

#[test]
fn a_sound_wheel_is_accepted() {
    let verified = check("wheel 2 1 2 3 / 0 1 / 0 2 / 0 3").unwrap();
    assert_eq!((verified.lower_bound, verified.optimal), (-5.0, true));
    // Spokes end at the nodes where the walk enters repulsive edges, and may pass through attractive edges of the ring.
    assert!(check("wheel 1 3 2 1 / 0 3 / 0 2 / 0 1").is_ok());
}

#[test]
fn a_spoiled_wheel_is_refuted() {
    for (wheel, reason) in [
        ("wheel 2.5 1 2 3 / 0 1 / 0 2 / 0 3", "more than its cost"),
        ("wheel -1 1 2 3 / 0 1 / 0 2 / 0 3", "positive"),
        ("wheel NaN 1 2 3 / 0 1 / 0 2 / 0 3", "positive"),
        ("wheel 2 1 2 3 / 0 1 / 0 2", "missing"),
        ("wheel 2 1 2 3 / 0 1 / 0 2 / 0 3 / 0 1", "odd number"),
        ("wheel 2 1 2 3 / 0 1 / 0 3 / 0 2", "does not join"),
        ("wheel 2 1 2 3 / 0 1 / 0 2 / 3", "does not join"),
        ("wheel 2 1 2 3 / 0 1 / 0 2 / ", "does not join"),
        ("wheel 2 1 2 3 / 0 1 / 0 2 / 0 1 3", "wrong sign"),
        ("wheel 2 1 2 3 1 2 3 / 0 1 / 0 2 / 0 3 / 0 1 / 0 2 / 0 3", "odd number"),
        (
            "wheel 1 1 2 3 1 2 3 1 2 3 / 0 1 / 0 2 / 0 3 / 0 1 / 0 2 / 0 3 / 0 1 / 0 2 / 0 3",
            "more than its cost",
        ),
        ("wheel 2 1 2 / 0 1 / 0 2", "odd number"),
        ("wheel 2 1 2 2 3 / 0 1 / 0 2 / 0 3", "no edge"),
        ("wheel 2 1 2 9 / 0 1 / 0 2 / 0 9", "no edge"),
        ("wheel 2", "odd number"),
        ("wheel 2 1 2 x / 0 1 / 0 2 / 0 3", "is not a number"),
        ("wheel", "is not a number"),
    ] {
        let error = check(wheel).unwrap_err().to_string();
        assert!(error.contains(reason) && error.contains("line 7"), "{wheel}: {error}");
    }
}
