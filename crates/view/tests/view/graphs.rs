//! A small graph with everything that a page shows: two laps of a rectangle, one session each.

use std::f64::consts::PI;

use posecut_graph::PoseGraph;
use serde_json::{Value, json};

/// Viewpoints of a lap, and metres between them.
const LAP: usize = 40;
const STEP: f64 = 5.0;

/// What a graph contains.
#[derive(Clone, Copy)]
pub(crate) struct Content<'a> {
    pub(crate) dimension: usize,
    pub(crate) sessions: [&'a str; 2],
    /// Whether edges have labels.
    pub(crate) labels: bool,
    /// Whether nodes have poses.
    pub(crate) poses: bool,
    /// Which edges join the laps: 0 for the map, 1 for the other hypothesis, 2 for none.
    pub(crate) hypothesis: usize,
}

impl Default for Content<'_> {
    fn default() -> Self {
        Self { dimension: 2, sessions: ["north/a", "north/b"], labels: false, poses: true, hypothesis: 0 }
    }
}

/// The true pose at a viewpoint: x, y, heading.
fn truth(node: usize) -> [f64; 3] {
    let along = (node % LAP) as f64 * STEP;
    match along {
        along if along < 60.0 => [along, 0.0, 0.0],
        along if along < 100.0 => [60.0, along - 60.0, PI / 2.0],
        along if along < 160.0 => [160.0 - along, 40.0, PI],
        along => [0.0, 200.0 - along, -PI / 2.0],
    }
}

/// The motion from one pose to another, with the second heading turned by `bias` radians.
fn between(one: [f64; 3], other: [f64; 3], bias: f64) -> [f64; 3] {
    let (dx, dy, (sin, cos)) = (other[0] - one[0], other[1] - one[1], one[2].sin_cos());
    [cos * dx + sin * dy, cos * dy - sin * dx, other[2] - one[2] + bias]
}

/// A pose as a file has it.
fn written(pose: [f64; 3], height: f64, dimension: usize) -> Value {
    let (sin, cos) = (pose[2] / 2.0).sin_cos();
    match dimension {
        2 => json!(pose),
        _ => json!([pose[0], pose[1], height, 0.0, 0.0, sin, cos]),
    }
}

/// The graph, as posecut-verify and posecut-optimize would leave it.
pub(crate) fn graph(content: Content) -> PoseGraph {
    let Content { dimension, sessions, hypothesis, .. } = content;
    let terms: &[f64] = if dimension == 2 {
        &[100.0, 0.0, 0.0, 100.0, 0.0, 400.0]
    } else {
        &[
            9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 9.0,
            0.0, 9.0,
        ]
    };
    let doubts = if hypothesis == 2 { json!(["parts-not-connected"]) } else { json!([]) };
    let mut records = vec![
        json!({"kind": "header", "format": "posecut", "version": 1, "dimension": dimension,
        "noise_models": {"any": {"information": terms}}, "provenance": [
            {"stage": "verify", "version": "0.1.0", "arguments": {"undecided": "reject", "hypothesis": hypothesis}, "seed": null,
             "inputs": [{"name": "graph", "sha256": "0".repeat(64)}], "doubts": doubts},
            {"stage": "optimize", "version": "0.1.0", "arguments": {"max_iterations": 100}, "seed": null, "inputs": []}]}),
    ];
    for node in 0..2 * LAP {
        // Under the other hypothesis the second lap began a quarter of a lap later.
        let place = if node >= LAP && hypothesis == 1 { node + LAP / 4 } else { node };
        let mut record = json!({"kind": "node", "id": node, "session": sessions[node / LAP], "frame": node});
        if content.poses {
            record["pose"] = written(truth(place), (node / LAP) as f64 * 3.0, dimension);
        }
        records.push(record);
    }
    for node in (1..2 * LAP).filter(|node| *node != LAP) {
        let motion = between(truth(node - 1), truth(node), 0.004);
        records.push(json!({"kind": "odometry", "id": node, "from": node - 1, "to": node,
            "measurement": written(motion, 0.0, dimension), "noise": "any"}));
    }
    records.extend(landmarks(content));
    let text: Vec<String> = records.iter().map(Value::to_string).collect();
    PoseGraph::read("a test", text.join("\n").as_bytes()).unwrap()
}

/// Ten edges that agree with the map, twelve that contradict it, one undecided, and four of another hypothesis.
fn landmarks(content: Content) -> Vec<Value> {
    let Content { dimension, hypothesis, labels, .. } = content;
    let mut records = Vec::new();
    let mut add = |id: usize, from: usize, to: usize, motion: [f64; 3], group: usize, fields: Value| {
        let mut record = json!({"kind": "landmark", "id": id, "from": from, "to": to,
            "measurement": written(motion, 0.0, dimension), "noise": "any", "score": 0.5 + id as f64 / 2000.0});
        record.as_object_mut().unwrap().extend(fields.as_object().unwrap().clone());
        if group != hypothesis {
            record["rejected_by"] = json!("verify");
        }
        if labels {
            record["truth"] = json!({"correct": group == 0});
        }
        records.push(record);
    };
    let fields = |verdict: &str, reason: &str, probability: f64, witness: &[usize], hypothesis: Value| {
        json!({"verify_verdict": verdict, "verify_reason": reason, "verify_probability": probability,
            "verify_witness": witness, "verify_hypothesis": hypothesis})
    };
    for (count, node) in (0..LAP).step_by(4).enumerate() {
        let motion = between(truth(node), truth(node + 1), 0.01);
        let own = match hypothesis {
            0 => fields("accepted", "supported", 0.99, &[100 + (count + 1) % 10], json!(0)),
            _ => fields("rejected", "other-hypothesis", 0.02, &[400], json!(1)),
        };
        add(100 + count, node, LAP + (node + 1) % LAP, motion, 0, own);
    }
    for count in 0..12 {
        let (from, to) = (3 * count, LAP + (7 * count + 17) % LAP);
        let own = fields("rejected", "contradicted", 0.001 * count as f64, &[100, 101], Value::Null);
        add(200 + count, from, to, [0.0; 3], 3, own);
    }
    add(300, 2, LAP + 5, [9.0, 1.0, 0.1], 3, fields("undecided", "chance", 0.41, &[], Value::Null));
    for (count, node) in (0..LAP).step_by(10).enumerate() {
        let own = match hypothesis {
            1 => fields("accepted", "supported", 0.97, &[400 + (count + 1) % 4], json!(0)),
            _ => fields("rejected", "other-hypothesis", 0.03, &[100], json!(1)),
        };
        add(400 + count, node, LAP + (node + 30) % LAP, [0.0; 3], 1, own);
    }
    records
}

/// What `--stats` of posecut-verify says about it.
pub(crate) fn statistics() -> serde_json::Map<String, Value> {
    let value = json!({"stage": "verify", "candidates": 27, "accepted": 10, "contradicted": 16, "undecided": 1,
        "joins_proposed": 1, "joins_established": 1,
        "rivals": [{"hypothesis": 1, "edges": 4, "evidence": 21.5, "accepted": 30.25}],
        "calibration": {"odometry": [1.4, 1.4, 0.8], "coherent": [0.0001, 0.0001, 0.0], "landmark": 2.5, "correct": 0.37, "local": 0.0,
            "evidence": 87.9, "on_prior": false},
        "broken_odometry": [30]});
    value.as_object().unwrap().clone()
}
