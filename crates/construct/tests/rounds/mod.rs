//! A session that all tests use: rounds on a ring.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(dead_code, unreachable_pub, missing_docs, reason = "each test program uses its part")]

use posecut_construct::{ConstructError, Landmarks, Options};
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{EdgeKind, PoseGraph};

pub fn options() -> Options {
    Options::DEFAULT
}

pub fn construct(graphs: Vec<PoseGraph>, options: &Options) -> Result<PoseGraph, ConstructError> {
    posecut_construct::construct(graphs, &Landmarks::Truth, options).map(|construction| construction.graph)
}

/// A session of two rounds on a ring of 50 m with steps of 2 m: every place is seen once in each half.
pub fn rounds(name: &str, steps: usize) -> PoseGraph {
    let pose = |step: usize| on_the_ring(step as f64 * 0.04, 50.0, 0.0);
    session(name, steps, pose)
}

/// The same session with each viewpoint off the ring by up to 1.5 m and 10 degrees, so that all relative poses differ.
pub fn unsteady_rounds(name: &str, steps: usize) -> PoseGraph {
    // Weyl sequences: evenly distributed and without a period.
    let even = |step: usize, irrational: f64| (step as f64 * irrational).fract() * 2.0 - 1.0;
    session(name, steps, |step| {
        let along = step as f64 * 0.04 + 0.01 * even(step, 2_f64.sqrt());
        on_the_ring(along, 50.0 + 1.5 * even(step, 3_f64.sqrt()), 0.17 * even(step, 5_f64.sqrt()))
    })
}

/// A session that follows a line in steps of 2 m, and returns along it with the opposite heading.
pub fn there_and_back(name: &str, steps: usize) -> PoseGraph {
    session(name, steps, |step| {
        let half = steps / 2;
        let x = 2.0 * step.min(2 * half - 1 - step.min(2 * half - 1)) as f64;
        [x, if step < half { 0.0 } else { 0.5 }, if step < half { 0.0 } else { std::f64::consts::PI }]
    })
}

fn on_the_ring(angle: f64, radius: f64, turned: f64) -> [f64; 3] {
    [radius * angle.sin(), 50.0 - radius * angle.cos(), posecut_geometry::wrap_angle(angle + turned)]
}

fn session(name: &str, steps: usize, pose: impl Fn(usize) -> [f64; 3]) -> PoseGraph {
    let mut text = String::from(
        "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2,\"noise_models\":{\"odometry\":{\"information\":[100,0,0,100,0,2500]}}}\n",
    );
    let pose = |step: usize| {
        let [x, y, theta] = pose(step);
        format!("[{x},{y},{theta}]")
    };
    for step in 0..steps {
        let pose = pose(step);
        text.push_str(&format!(
            "{{\"kind\":\"node\",\"id\":{step},\"session\":\"{name}\",\"frame\":{step},\"utime\":{},\"pose\":{pose},\"truth\":{{\"pose\":{pose}}}}}\n",
            step * 2_000_000
        ));
    }
    for step in 1..steps {
        text.push_str(&format!(
            "{{\"kind\":\"odometry\",\"id\":{},\"from\":{},\"to\":{step},\"measurement\":[2,0.04,0.04],\"noise\":\"odometry\"}}\n",
            step - 1,
            step - 1
        ));
    }
    PoseGraph::read("rounds", text.as_bytes()).unwrap()
}

pub fn truth(graph: &PoseGraph, id: u64) -> SE2 {
    let node = &graph.nodes[graph.node_index(id).unwrap()];
    SE2::from_components(node.truth.as_ref().unwrap().pose.as_ref().unwrap()).unwrap()
}

pub fn landmarks(graph: &PoseGraph, correct: bool) -> Vec<(u64, u64)> {
    graph
        .edges_of(EdgeKind::Landmark)
        .filter(|edge| edge.truth_correct() == Some(correct))
        .map(|edge| (edge.from, edge.to))
        .collect()
}
