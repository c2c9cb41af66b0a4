//! The distance from the ground truth beside that from a reference.

use posecut_evaluate::{Options, Scope, evaluate};
use posecut_graph::PoseGraph;

/// Four nodes on a line with true poses one metre apart, in two components, and estimated at these x.
fn line(estimated: [f64; 4]) -> PoseGraph {
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for (id, x) in estimated.into_iter().enumerate() {
        text += &format!(
            "{{\"kind\":\"node\",\"id\":{id},\"pose\":[{x},0,0],\"truth\":{{\"pose\":[{id},0,0]}}}}\n"
        );
    }
    for (id, from) in [(0, 0), (1, 2)] {
        text += &format!(
            "{{\"kind\":\"odometry\",\"id\":{id},\"from\":{from},\"to\":{},\"measurement\":[1,0,0],\"information\":[1,0,0,1,0,1]}}\n",
            from + 1
        );
    }
    PoseGraph::read("line", text.as_bytes()).unwrap()
}

/// An estimate that equals the truth differs from a stretched reference, and is closer to the truth.
#[test]
fn the_reference_may_be_farther_from_the_truth_than_the_estimate() {
    let (estimate, reference) = (line([0.0, 1.0, 2.0, 3.0]), line([0.0, 2.0, 4.0, 6.0]));
    let result = evaluate(&estimate, Some(&reference), &Options::DEFAULT).unwrap();
    let truth = result.ground_truth.unwrap();
    assert_eq!(truth.poses, 4);
    assert!(truth.rmse < 1e-9 && (truth.reference_rmse - result.rmse.unwrap()).abs() < 1e-9, "{truth:?}");
    // By hand: both centred, errors are -1.5, -0.5, 0.5 and 1.5 m.
    let rmse = result.rmse.unwrap();
    assert!((rmse - 1.25_f64.sqrt()).abs() < 1e-9, "{rmse}");
}

#[test]
fn the_truth_is_compared_over_the_same_groups_as_the_reference() {
    // The second component is where it should not be, but each by itself is right.
    let (estimate, reference) = (line([0.0, 1.0, 7.0, 8.0]), line([0.0, 1.0, 2.0, 3.0]));
    let of = |scope| {
        let options = Options { scope, ..Options::DEFAULT };
        evaluate(&estimate, Some(&reference), &options).unwrap().ground_truth.unwrap()
    };
    assert!(of(Scope::PerComponent).rmse < 1e-9 && of(Scope::Joint).rmse > 1.0);
    assert!(of(Scope::Joint).reference_rmse < 1e-9);
}

/// Two parts that nothing joins in the reference, one of which is where it should not be. That counts only if the estimate joins them.
#[test]
fn what_an_estimate_joins_is_measured_by_its_own_edges() {
    let (apart, reference) = (line([0.0, 1.0, 7.0, 8.0]), line([0.0, 1.0, 2.0, 3.0]));
    let mut joined = apart.clone();
    let mut edge = joined.edges[0].clone();
    (edge.id, edge.from, edge.to) = (2, 1, 2);
    edge.measurement = Some(vec![6.0, 0.0, 0.0]);
    joined.edges.push(edge);
    let of = |estimate: &PoseGraph, scope| {
        let options = Options { scope, ..Options::DEFAULT };
        evaluate(estimate, Some(&reference), &options).unwrap().ground_truth.unwrap()
    };
    for scope in [Scope::Joint, Scope::PerComponent] {
        assert!(of(&apart, scope).joined_rmse < 1e-9, "a join that is missing does not count");
        // By hand: the mean of the errors 0, 0, 5 and 5 m is aligned away.
        assert!((of(&joined, scope).joined_rmse - 2.5).abs() < 1e-9, "a false join counts");
    }
    assert!(of(&joined, Scope::PerComponent).rmse < 1e-9, "the parts of the reference do not see it");
}

#[test]
fn without_a_reference_or_a_truth_there_is_no_comparison() {
    let estimate = line([0.0, 1.0, 2.0, 3.0]);
    assert!(evaluate(&estimate, None, &Options::DEFAULT).unwrap().ground_truth.is_none());
    let mut unknown = estimate.clone();
    unknown.nodes.iter_mut().for_each(|node| node.truth = None);
    let result = evaluate(&unknown, Some(&estimate), &Options::DEFAULT).unwrap();
    assert!(result.ground_truth.is_none());
    assert!(!serde_json::to_string(&result).unwrap().contains("ground_truth"));
}
