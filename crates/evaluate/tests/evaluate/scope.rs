//! Tests which poses share one alignment.

use posecut_evaluate::result::Scope;
use posecut_evaluate::{Options, evaluate};
use posecut_graph::PoseGraph;

/// Two chains of three poses. The second one starts at (x, y), turned by an angle. An edge joins the chains if
/// `joined`.
fn chains(start: (f64, f64, f64), bend: f64, joined: bool) -> PoseGraph {
    let (x, y, angle) = start;
    let mut text =
        String::from("{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n");
    for (id, (along, across)) in [(0.0, 0.0), (1.0, 0.0), (2.0, bend)].into_iter().enumerate() {
        text += &format!("{{\"kind\":\"node\",\"id\":{id},\"pose\":[{along},{across},0]}}\n");
    }
    for (id, along) in [(3, 0.0), (4, 1.0), (5, 2.0)] {
        let (a, b) = (x + along * f64::cos(angle), y + along * f64::sin(angle));
        text += &format!("{{\"kind\":\"node\",\"id\":{id},\"pose\":[{a},{b},{angle}]}}\n");
    }
    for (id, from) in [(0, 0), (1, 1), (2, 3), (3, 4)] {
        text += &format!(
            "{{\"kind\":\"odometry\",\"id\":{id},\"from\":{from},\"to\":{},\"measurement\":[1,0,0],\"information\":[1,0,0,1,0,1]}}\n",
            from + 1
        );
    }
    if joined {
        text += "{\"kind\":\"landmark\",\"id\":4,\"from\":0,\"to\":3,\"measurement\":[0,0,0],\"information\":[1,0,0,1,0,1]}\n";
    }
    PoseGraph::read("test", text.as_bytes()).unwrap()
}

fn rmse(estimate: &PoseGraph, reference: &PoseGraph, scope: Scope) -> f64 {
    let options = Options { scope, ..Options::DEFAULT };
    evaluate(estimate, Some(reference), &options).unwrap().rmse.unwrap()
}

#[test]
fn components_of_the_reference_are_aligned_by_themselves() {
    let reference = chains((5.0, 5.0, 0.0), 0.0, false);
    let elsewhere = chains((-30.0, 7.0, 2.0), 0.0, false);
    assert!(rmse(&elsewhere, &reference, Scope::Joint) > 5.0);
    assert!(rmse(&elsewhere, &reference, Scope::PerComponent) < 1e-9);
    // An edge of the estimate does not make the reference connected.
    let joined = chains((-30.0, 7.0, 2.0), 0.0, true);
    assert!(rmse(&joined, &reference, Scope::PerComponent) < 1e-9);
    // A bent chain has an error.
    assert!(rmse(&chains((5.0, 5.0, 0.0), 0.6, false), &reference, Scope::PerComponent) > 0.1);
}

#[test]
fn a_connected_reference_is_aligned_as_one() {
    let reference = chains((5.0, 5.0, 0.0), 0.0, true);
    for estimate in [chains((-3.0, 7.0, 1.0), 0.3, true), chains((4.0, 5.0, 0.1), 0.0, false)] {
        let joint = rmse(&estimate, &reference, Scope::Joint);
        assert!(joint > 0.01);
        assert_eq!(joint, rmse(&estimate, &reference, Scope::PerComponent));
    }
}
