//! Nodes that the capacity left by a packing joins: in certificates, and in the solver.

use posecut_multicut::generate::{Family, generate};
use posecut_multicut::{Graph, Options, solve, verify};

/// The lower bound that a proof shows for three nodes that attract each other and a node 3 that repels 0 and attracts 1. Without a
/// conflict, the bound is -3; each pair of the three is connected by a capacity of 2; and the optimum, 0 alone, costs -1.
fn proved(proof: &str) -> Result<f64, String> {
    let edges = [(0, 1, 1.0), (1, 2, 1.0), (0, 2, 1.0), (0, 3, -3.0), (1, 3, 3.0)];
    let graph = Graph::new(4, edges).unwrap();
    let text = format!(
        "POSECUT-MULTICUT-CERTIFICATE 1\nlabels 0 1 1 1\ncomponent 0 1 2 3\nreduce 1\npiece - 0 1 2 3\n{proof}\nend\n"
    );
    verify(&graph, text.as_bytes()).map(|verified| verified.lower_bound).map_err(|error| error.to_string())
}

#[test]
fn pairs_are_fixed_by_all_paths_between_them() {
    let rest = "reduce 1\npiece - 0 1 2 3";
    // Apart, 0 and 1 pay for the edge between them and for the path over 2. Joined, nothing is left to gain.
    assert_eq!(proved(&format!("fix 0 1 99\n0 1\n{rest}\nd 0 1")).unwrap(), -1.0);
    // A conflict takes capacity away from the path, and the bound rises by as much: the same in the end.
    assert_eq!(proved(&format!("fix 1 1 99\n1 0 1 3\n0 1\n{rest}\nd 0 1")).unwrap(), -1.0);
    // Nodes that are joined before lead to each other without limit.
    assert_eq!(proved(&format!("fix 0 2 99\n0 1\n0 2\n{rest}\nd 0 1\nd 0 2")).unwrap(), -1.0);
    // What the rest of the proof does not show, no capacity replaces.
    assert_eq!(proved(&format!("fix 0 1 99\n0 1\n{rest}")).unwrap(), -3.0);
    let error = proved(&format!("fix 0 1 99\n0 3\n{rest}\nd 0 3")).unwrap_err();
    assert!(error.contains("only attractive edges can be fixed"), "{error}");
}

#[test]
fn the_verifier_confirms_what_the_solver_fixes() {
    let graph = generate(Family::Aliased, 3000, 0.1, 7).unwrap();
    let solution = solve(&graph, &Options { certificate: true, ..Options::default() });
    let mut text = Vec::new();
    solution.certificate.unwrap().write(&mut text).unwrap();
    let verified = verify(&graph, text.as_slice()).unwrap();
    assert!(verified.optimal && verified.objective == solution.objective);
    assert!(String::from_utf8(text).unwrap().contains("\nfix "));
}
