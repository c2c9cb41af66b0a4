//! PCM on whole graphs through its library.

use posecut_geometry::SE2;
use posecut_graph::PoseGraph;
use posecut_pcm::PcmError;
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;

fn graph(lines: &str) -> PoseGraph {
    let header = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;
    PoseGraph::read("test", format!("{header}\n{lines}").as_bytes()).unwrap()
}

const NODES: &str = r#"{"kind":"node","id":10}
{"kind":"node","id":20}
{"kind":"node","id":30}
{"kind":"node","id":40}
"#;

fn odometry(id: u64, from: u64, to: u64) -> String {
    format!(
        "{{\"kind\":\"odometry\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[1,0,0],\"information\":[1,0,0,1,0,1]}}\n"
    )
}

#[test]
fn a_gap_in_the_odometry_makes_two_chains() {
    let graph = graph(&format!("{NODES}{}{}", odometry(0, 10, 20), odometry(1, 30, 40)));
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    assert_eq!(chains.places, [(0, 0), (0, 1), (1, 0), (1, 1)]);
}

#[test]
fn a_node_without_odometry_is_a_chain_of_its_own() {
    let chains = Chains::<SE2, 3>::of(&graph(NODES)).unwrap();
    assert_eq!(chains.places, [(0, 0), (1, 0), (2, 0), (3, 0)]);
}

#[test]
fn branches_and_rings_are_cut_by_the_order_of_ids() {
    let ring =
        graph(&format!("{NODES}{}{}{}", odometry(0, 10, 20), odometry(1, 20, 30), odometry(2, 30, 10)));
    let chains = Chains::<SE2, 3>::of(&ring).unwrap();
    assert_eq!(chains.places, [(0, 0), (0, 1), (0, 2), (1, 0)]);
    let branch =
        graph(&format!("{NODES}{}{}{}", odometry(0, 10, 20), odometry(1, 20, 30), odometry(2, 20, 40)));
    assert_eq!(Chains::<SE2, 3>::of(&branch).unwrap().places, [(0, 0), (0, 1), (0, 2), (1, 0)]);
}

#[test]
fn singular_information_is_refused_with_the_edge() {
    let singular = odometry(3, 10, 20).replace("[1,0,0,1,0,1]", "[1,0,0,1,0,0]");
    let error = Chains::<SE2, 3>::of(&graph(&format!("{NODES}{singular}"))).unwrap_err();
    assert!(matches!(&error, PcmError::Covariance { edge, .. } if edge == "odometry 3"), "{error}");
}

#[test]
fn candidates_without_measurement_are_counted_and_left_alone() {
    let lines = format!(
        "{NODES}{}{}",
        "{\"kind\":\"landmark\",\"id\":7,\"from\":10,\"to\":30}\n",
        "{\"kind\":\"landmark\",\"id\":8,\"from\":10,\"to\":30,\"rejected_by\":\"me\"}\n"
    );
    let graph = graph(&lines);
    let grouped = group(&graph, &Chains::<SE2, 3>::of(&graph).unwrap()).unwrap();
    assert_eq!((grouped.groups.len(), grouped.unmeasured, grouped.rejected_before), (0, 1, 1));
}
