//! Inputs whose results are doubtful.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use posecut_contract::samples;

/// A chain of nodes one metre apart, without the odometry that starts at the nodes in `gaps`. A landmark edge is given by its
/// two nodes and its translation along x.
pub(crate) fn chain(nodes: u64, gaps: &[u64], landmarks: &[(u64, u64, f64)]) -> String {
    let mut text = header("[100,0,0,100,0,400]");
    for node in 0..nodes {
        let _ = writeln!(
            text,
            r#"{{"kind":"node","id":{node},"session":"s","frame":{node},"pose":[{node},0,0]}}"#
        );
    }
    for from in (0..nodes - 1).filter(|from| !gaps.contains(from)) {
        let to = from + 1;
        let _ = writeln!(
            text,
            r#"{{"kind":"odometry","id":{from},"from":{from},"to":{to},"measurement":[1,0,0],"noise":"n"}}"#
        );
    }
    for (id, (from, to, along)) in (1000..).zip(landmarks) {
        let _ = writeln!(
            text,
            r#"{{"kind":"landmark","id":{id},"from":{from},"to":{to},"measurement":[{along:?},0,0],"noise":"n"}}"#
        );
    }
    text
}

fn header(information: &str) -> String {
    format!(
        "{{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2,\"noise_models\":{{\"n\":{{\"information\":{information}}}}}}}\n"
    )
}

/// The same graph with zero information about rotations.
fn without_rotations(graph: &str) -> String {
    graph.replace("[100,0,0,100,0,400]", "[100,0,0,100,0,0]")
}

fn fixed(graph: &str, nodes: &[u64]) -> String {
    let mut text = graph.to_owned();
    for node in nodes {
        text =
            text.replace(&format!("\"pose\":[{node},0,0]"), &format!("\"pose\":[{node},0,0],\"fixed\":true"));
    }
    text
}

/// All pairs of 16 nodes with costs of both signs. Lower and upper bound do not meet without branching.
fn costs() -> impl Iterator<Item = (i64, i64, i64)> {
    let pairs = (0..16_i64).flat_map(|i| (i + 1..16).map(move |j| (i, j)));
    pairs.map(|(i, j)| {
        let cost = ((i * 7 + j * 11) * (i + j) % 13) - 6;
        (i, j, if cost == 0 { 1 } else { cost })
    })
}

fn frustrated() -> String {
    let mut text = header("[100,0,0,100,0,400]");
    for node in 0..16 {
        let _ = writeln!(text, r#"{{"kind":"node","id":{node}}}"#);
    }
    for (id, (i, j, cost)) in costs().enumerate() {
        let _ = writeln!(text, r#"{{"kind":"landmark","id":{id},"from":{i},"to":{j},"cost":{cost}}}"#);
    }
    text
}

fn frustrated_instance() -> String {
    let lines: Vec<String> = costs().map(|(i, j, cost)| format!("{i} {j} {cost}\n")).collect();
    format!("MULTICUT\n{}", lines.concat())
}

/// Two chains in space and many candidates between them that disagree by up to this many metres, so that the largest clique and the multicut of
/// the candidates need branching.
fn cliques(candidates: u64, apart: f64) -> String {
    let information = "[100,0,0,0,0,0,100,0,0,0,0,100,0,0,0,400,0,0,400,0,400]";
    let mut text = header(information).replace("\"dimension\":2", "\"dimension\":3");
    for node in 0..40 {
        let _ = writeln!(text, r#"{{"kind":"node","id":{node},"session":"s","frame":{node}}}"#);
    }
    for from in (0..39).filter(|&from| from != 19) {
        let to = from + 1;
        let _ = writeln!(
            text,
            r#"{{"kind":"odometry","id":{from},"from":{from},"to":{to},"measurement":[1,0,0,0,0,0,1],"noise":"n"}}"#
        );
    }
    let mut draw = draws(5);
    for id in 100..100 + candidates {
        let (from, to) = ((20.0 * draw()) as u64, (20.0 * draw()) as u64);
        let [x, y, z] = std::array::from_fn(|_| apart * (draw() - 0.5));
        let [qx, qy, qz]: [f64; 3] = std::array::from_fn(|_| 0.1 * apart * (draw() - 0.5));
        let qw = (1.0 - qx * qx - qy * qy - qz * qz).sqrt();
        let x = x + to as f64 - from as f64;
        let to = to + 20;
        let _ = writeln!(
            text,
            r#"{{"kind":"landmark","id":{id},"from":{from},"to":{to},"measurement":[{x},{y},{z},{qx},{qy},{qz},{qw}],"noise":"n"}}"#
        );
    }
    text
}

/// Two chains with a candidate between each pair of their nodes: 4225 candidates in as many cells.
fn crowd() -> String {
    let pairs =
        (0..65_u64).flat_map(|from| (65..130_u64).map(move |to| (from, to, (to - 65) as f64 - from as f64)));
    chain(130, &[64], &pairs.collect::<Vec<_>>())
}

/// A walk whose odometry measures little more than distances. Its landmark edges contradict it in some directions and have
/// hardly any information in others.
fn tangle() -> String {
    let mut draw = draws(1);
    let mut text = header("[1,0,0,1,0,0.001]");
    for node in 0..20 {
        let _ = writeln!(text, r#"{{"kind":"node","id":{node},"session":"s","frame":{node}}}"#);
    }
    for to in 1..20 {
        let (from, turn) = (to - 1, 4.0 * draw() - 2.0);
        let _ = writeln!(
            text,
            r#"{{"kind":"odometry","id":{to},"from":{from},"to":{to},"measurement":[1,0,{turn}],"noise":"n"}}"#
        );
    }
    for id in 100..115 {
        let (from, to) = ((10.0 * draw()) as u64, 10 + (10.0 * draw()) as u64);
        let [x, y, turn]: [f64; 3] = std::array::from_fn(|_| 6.0 * draw() - 3.0);
        let _ = writeln!(
            text,
            r#"{{"kind":"landmark","id":{id},"from":{from},"to":{to},"measurement":[{x},{y},{turn}],"information":[1e6,0,0,1e-6,0,1e6]}}"#
        );
    }
    text
}

/// Numbers between 0 and 1, determined by a seed.
fn draws(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31)
    }
}

/// The path of a file of this list, or of a sample.
pub(crate) fn path(name: &str) -> String {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap().keep();
        let wrong = chain(12, &[], &[(0, 9, 0.0)]);
        let right = chain(12, &[], &[(0, 9, 9.0)]);
        let apart = chain(4, &[1], &[]);
        let files = [
            ("wrong.jsonl", wrong.clone()),
            ("apart.jsonl", apart),
            ("wrong-apart.jsonl", chain(24, &[11], &[(2, 14, 0.0), (6, 15, 0.5)])),
            ("huge.jsonl", right.replace("[9.0,0,0]", "[1e160,0,0]")),
            ("fixed.jsonl", fixed(&right, &[0, 9])),
            ("weak.jsonl", without_rotations(&chain(4, &[], &[(0, 3, 4.0), (0, 2, 3.0)]))),
            ("costs.jsonl", wrong.replace("\"noise\":\"n\"}\n", "\"noise\":\"n\",\"cost\":-1}\n")),
            ("frustrated.jsonl", frustrated()),
            ("frustrated.mc", frustrated_instance()),
            ("cliques.jsonl", cliques(300, 2.4)),
            ("fewer.jsonl", cliques(100, 2.4)),
            ("crowd.jsonl", crowd()),
            ("tangle.jsonl", tangle()),
            (
                "predicted.jsonl",
                wrong.replace(
                    "[0.0,0,0],",
                    "[0.0,0,0],\"rejected_by\":\"pcm\",\"predicted_covariance\":[0.09,0,0,0.6,0.09,0.0225],",
                ),
            ),
            ("right.jsonl", right),
            ("empty.jsonl", header("[100,0,0,100,0,400]")),
            ("odometry.jsonl", chain(4, &[], &[])),
            ("bad.g2o", "EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n".to_owned()),
            ("matches.csv", "frame_i,frame_j,score\n3,50,0.5\n".to_owned()),
        ];
        for (name, text) in files {
            std::fs::write(folder.join(name), text).unwrap();
        }
        folder
    });
    let own = folder.join(name);
    if Path::new(&own).exists() { own.to_str().unwrap().to_owned() } else { samples().path(name) }
}
