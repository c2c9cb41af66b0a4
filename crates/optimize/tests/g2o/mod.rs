//! A reader of g2o pose graphs, as far as the benchmark graphs need it.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "support of tests and benches")]

use std::collections::BTreeMap;
use std::path::PathBuf;

use posecut_geometry::covariance::unpack_upper_triangle;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_optimize::{Edge, EdgeKind};

/// Path of the benchmark data, if it is there.
pub(crate) fn shared_data() -> Option<PathBuf> {
    let path = match std::env::var_os("POSECUT_SHARED_DATA") {
        Some(path) => PathBuf::from(path),
        None => PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
    };
    path.is_dir().then_some(path)
}

/// The text of a graph, or a note that it is missing.
#[allow(dead_code, reason = "not every test reads the benchmark graphs")]
pub(crate) fn text(name: &str) -> Option<String> {
    let found = shared_data()
        .and_then(|path| std::fs::read_to_string(path.join("g2o").join(format!("{name}.g2o"))).ok());
    if found.is_none() {
        println!("skipped: no data: {name}");
    }
    found
}

/// Whether the graph is planar.
#[allow(dead_code, reason = "not every test reads the benchmark graphs")]
pub(crate) fn is_planar(text: &str) -> bool {
    text.contains("EDGE_SE2")
}

/// Poses (identity where the file has no vertex) and edges; consecutive ids are odometry.
pub(crate) fn read<G: LieGroup<DOF>, const DOF: usize>(text: &str) -> (Vec<G>, Vec<Edge<G, DOF>>) {
    let mut vertices = BTreeMap::new();
    let mut edges = Vec::new();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        let tag = words.next().unwrap_or("");
        let is_edge = tag.starts_with("EDGE_SE");
        if !is_edge && !tag.starts_with("VERTEX_SE") {
            continue;
        }
        let ids: Vec<usize> =
            words.by_ref().take(if is_edge { 2 } else { 1 }).map(|word| word.parse().unwrap()).collect();
        let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
        let mut components = numbers[..G::COMPONENTS].to_vec();
        if DOF == 6 {
            let norm = components[3..].iter().map(|q| q * q).sum::<f64>().sqrt();
            components[3..].iter_mut().for_each(|q| *q /= norm);
        }
        let pose = G::from_components(&components).unwrap();
        if is_edge {
            let information = unpack_upper_triangle(&numbers[G::COMPONENTS..]).unwrap();
            let kind = if ids[0].abs_diff(ids[1]) == 1 { EdgeKind::Odometry } else { EdgeKind::Landmark };
            for &id in &ids {
                vertices.entry(id).or_insert(None);
            }
            edges.push(Edge::new(ids[0], ids[1], pose, information, kind));
        } else {
            vertices.insert(ids[0], Some(pose));
        }
    }
    let index: BTreeMap<usize, usize> = vertices.keys().enumerate().map(|(index, &id)| (id, index)).collect();
    for edge in &mut edges {
        edge.from = index[&edge.from];
        edge.to = index[&edge.to];
    }
    (vertices.into_values().map(|pose| pose.unwrap_or_else(G::identity)).collect(), edges)
}

/// The planar graph of this text.
#[allow(dead_code, reason = "not every test reads both kinds")]
pub(crate) fn planar(text: &str) -> (Vec<SE2>, Vec<Edge<SE2, 3>>) {
    read(text)
}

/// The spatial graph of this text.
#[allow(dead_code, reason = "not every test reads both kinds")]
pub(crate) fn spatial(text: &str) -> (Vec<SE3>, Vec<Edge<SE3, 6>>) {
    read(text)
}
