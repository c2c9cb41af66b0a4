//! Tests, for every program that rejects landmark edges, that verdicts do not depend on units, scales, numbering, directions,
//! names, copies and unconnected components.

mod changes;

use std::collections::BTreeSet;

use nalgebra::SVector;
use posecut_contract::{long_tests, succeed};
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{Edge, PoseGraph};
use posecut_pcm::generate::{Falsehood, Scenario};

use self::changes::{FAR, OTHER_IDS, OTHER_INFORMATION, changes, is_landmark};

/// A program that rejects landmark edges, and how the changes may affect its verdicts.
struct Row {
    name: &'static str,
    options: &'static [&'static str],
    /// Options that compensate for covariances a thousand times larger; `None` if the program uses the covariances as claimed.
    information: Option<&'static [&'static str]>,
    /// Whether a copy of an edge gets the verdict of that edge and changes hardly any other verdict.
    copies: bool,
    /// Changes by which a few verdicts may differ, each with its reason.
    nearly: &'static [(&'static str, &'static str)],
}

const ROW: Row = Row { name: "", options: &[], information: Some(&[]), copies: true, nearly: &[] };

const OF_SEVERAL: (&str, &str) = (
    OTHER_IDS,
    "of several largest sets the first in the order of ids is taken; a pair is that of the lower id with the higher, whose order \
     matters in second order",
);

const PCM: Row = Row { name: "pcm", information: Some(&["--scale", "1e-3"]), nearly: &[OF_SEVERAL], ..ROW };

const TABLE: &[Row] = &[
    PCM,
    Row {
        options: &["--scale", "auto"],
        information: Some(&[]),
        // The scale is estimated, and copies are additional data for the estimate.
        copies: false,
        nearly: &[
            OF_SEVERAL,
            (
                OTHER_INFORMATION,
                "the estimate starts from fixed factors and ends once steps are below a thousandth",
            ),
        ],
        ..PCM
    },
    Row { options: &["--chance", "3"], ..PCM },
    Row { options: &["--grow", "0.99"], ..PCM },
    Row { options: &["--correction", "group"], ..PCM },
    Row { name: "verify", ..ROW },
    Row { name: "multicut", ..ROW },
    Row { name: "islands", ..ROW },
    Row { name: "voting", information: None, ..ROW },
    // The number of kept edges is the rounded density, so the last edge of the order may be rejected without its copy.
    Row { name: "densest", information: None, copies: false, nearly: &[OF_SEVERAL], ..ROW },
    Row { name: "ransac", information: None, ..ROW },
];

/// A random graph in which every edge has its own information matrix and every node has a pose.
fn drawn<G: LieGroup<DOF>, const DOF: usize>(falsehood: Falsehood) -> PoseGraph {
    let mut graph = Scenario { candidates: 120, outliers: 0.4, falsehood, seed: 6 }.draw::<G, DOF>();
    for place in 0..graph.edges.len() {
        let information = graph.information(&graph.edges[place]).map(<[f64]>::to_vec);
        graph.edges[place].information = information;
        graph.edges[place].noise = None;
    }
    graph.header.noise_models.clear();
    for (place, node) in graph.nodes.iter_mut().enumerate() {
        node.frame = Some(place as i64);
        node.pose =
            Some(G::exp(&SVector::from_fn(|axis, _| 0.01 * (place * (axis + 1)) as f64)).components());
    }
    graph
}

impl Row {
    /// The ids of the landmark edges that the program rejects.
    fn rejected(&self, graph: &PoseGraph, more: &[&str]) -> BTreeSet<u64> {
        let mut bytes = Vec::new();
        graph.write(&mut bytes).unwrap();
        let arguments: Vec<&str> = ["-q"].iter().chain(self.options).chain(more).copied().collect();
        let output = succeed(self.name, &arguments, &bytes);
        let graph = PoseGraph::read("output", &output[..]).unwrap();
        graph.edges.iter().filter(|edge| edge.rejected_by.is_some()).map(|edge| edge.id).collect()
    }

    fn check<G: LieGroup<DOF>, const DOF: usize>(&self, graph: &PoseGraph, case: &str) {
        let plain = self.rejected(graph, &[]);
        let landmarks = graph.edges.iter().filter(|edge| is_landmark(edge)).count();
        let case = format!("posecut-{} {:?}, {case}", self.name, self.options);
        assert!(plain.len() > 5 && plain.len() < landmarks, "{case}: {} of {landmarks}", plain.len());
        for (name, change, id) in changes::<G, DOF>() {
            let mut changed = graph.clone();
            change(&mut changed);
            let Some(more) = (if name == OTHER_INFORMATION { self.information } else { Some(&[][..]) })
            else {
                continue;
            };
            let found = self.rejected(&changed, more);
            let expected: BTreeSet<u64> = plain.iter().map(|&edge| id(edge)).collect();
            let differing: Vec<_> = expected.symmetric_difference(&found).collect();
            let most = if self.nearly.iter().any(|(nearly, _)| *nearly == name) { landmarks / 10 } else { 0 };
            assert!(differing.len() <= most, "{case}, {name}: {differing:?}");
        }
        if self.copies {
            self.a_copy_has_the_verdict_of_its_edge(graph, &plain, &case);
        }
    }

    /// A copy of an edge agrees with the same edges as the original and gets the same verdict. The number of other kept edges
    /// does not change, but the edges may if there are several largest sets: the copy counts for the sets with the edge, and it
    /// changes the order of the search.
    fn a_copy_has_the_verdict_of_its_edge(&self, graph: &PoseGraph, plain: &BTreeSet<u64>, case: &str) {
        for edge in graph.edges.iter().filter(|edge| is_landmark(edge)).step_by(25) {
            let mut copied = graph.clone();
            copied.edges.push(Edge { id: FAR + 1, ..edge.clone() });
            let mut found = self.rejected(&copied, &[]);
            let case = format!("{case}, copy of {}", edge.id);
            assert_eq!(found.remove(&(FAR + 1)), plain.contains(&edge.id), "{case}");
            assert!(found.len().abs_diff(plain.len()) <= 2, "{case}: {} and {}", found.len(), plain.len());
            assert!(found.symmetric_difference(plain).count() <= 10, "{case}");
        }
    }
}

fn check<G: LieGroup<DOF>, const DOF: usize>() {
    for (kind, falsehood) in [Falsehood::Uniform, Falsehood::Grouped].into_iter().enumerate() {
        let graph = drawn::<G, DOF>(falsehood);
        // In the short form, a program meets one kind of false edges in the plane and the other in space.
        let has_turn = |number: usize| long_tests() || (number + kind + DOF / 3).is_multiple_of(2);
        for (_, row) in TABLE.iter().enumerate().filter(|&(number, _)| has_turn(number)) {
            row.check::<G, DOF>(&graph, &format!("{falsehood:?}"));
        }
    }
}

#[test]
fn what_changes_no_verdict_in_the_plane() {
    check::<SE2, 3>();
}

#[test]
fn what_changes_no_verdict_in_space() {
    check::<SE3, 6>();
}
