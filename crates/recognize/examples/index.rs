//! Times the index of places on a session that is driven several times, and prints a line of JSON: seconds to describe all keyframes,
//! to build the index, to ask it for each keyframe, and to answer the same by a search of all keys; and the share of the search's answers that
//! the index found.
//!
//! Usage: index GRAPH KEYFRAMES (a graph with scans; it is repeated until it has this many keyframes)

use std::fs::File;
use std::io::{BufReader, Write as _};
use std::time::Instant;

use nalgebra::Vector2;
use posecut_graph::PoseGraph;
use posecut_random::rand::Rng;
use posecut_random::{ChaCha8Rng, random};
use posecut_recognize::places::{Context as _, Places};
use posecut_recognize::polar_context::{KEY, PolarContext};
use posecut_recognize::recognition::SHORTLIST;
use posecut_recognize::{Routes, Settings, Submaps};
use posecut_scan::Scans;

/// Points of every pass are moved by up to this along each axis, metres.
const NOISE: f64 = 0.1;
/// Measurements of which the fastest counts.
const ROUNDS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, keyframes] = &arguments[..] else { return Err("usage: index GRAPH KEYFRAMES".into()) };
    let once = PoseGraph::read(path, BufReader::new(File::open(path)?))?;
    let passes = keyframes.parse::<usize>()?.div_ceil(once.nodes.len());
    let scans = Scans::of_graph(&once)?;
    let (graph, settings) = (repeated(&once, passes)?, Settings::DEFAULT);
    let routes = Routes::of_graph(&graph)?;
    let count = once.nodes.len();
    let at = |node: usize| scans.at(once.nodes[node % count].id);
    let submaps = Submaps::new(&routes, (0..graph.nodes.len()).map(at).collect());
    let nodes: Vec<usize> = (0..graph.nodes.len()).filter(|&node| submaps.has_scan(node)).collect();

    let began = Instant::now();
    let mut generator = random(1, "index");
    let contexts: Vec<PolarContext> =
        nodes.iter().map(|&node| context(&submaps, node, &settings, &mut generator)).collect();
    let describe = began.elapsed().as_secs_f64();
    let keys: Vec<[f64; KEY]> = contexts.iter().map(PolarContext::key).collect();

    let (build, places) = timed(|| Places::of_contexts(nodes.clone(), contexts.clone()));
    let by_index = || -> Vec<Vec<usize>> {
        let nearest = |position| places.nearest(position, SHORTLIST, &routes, settings.exclusion_length);
        (0..nodes.len()).map(nearest).collect()
    };
    let by_search = || -> Vec<Vec<usize>> {
        let nearest = |position| search(&keys, &nodes, position, &routes, settings.exclusion_length);
        (0..nodes.len()).map(nearest).collect()
    };
    // Both take turns, so that other load on the machine affects both.
    let (mut query, mut linear, mut share) = (f64::INFINITY, f64::INFINITY, 1.0);
    for _ in 0..ROUNDS {
        let ((index, found), (all, expected)) = (timed(by_index), timed(by_search));
        (query, linear, share) = (query.min(index), linear.min(all), share_of(&expected, &found));
    }
    writeln!(
        std::io::stdout(),
        "{{\"keyframes\":{},\"describe\":{describe},\"build\":{build},\"query\":{query},\"linear\":{linear},\"found\":{share}}}",
        nodes.len()
    )?;
    Ok(())
}

/// Wall seconds and result.
fn timed<T>(work: impl Fn() -> T) -> (f64, T) {
    let began = Instant::now();
    let result = work();
    (began.elapsed().as_secs_f64(), result)
}

/// The share of the expected answers that were found.
fn share_of(expected: &[Vec<usize>], found: &[Vec<usize>]) -> f64 {
    let all: usize = expected.iter().map(Vec::len).sum();
    let right = |(expected, found): (&Vec<usize>, &Vec<usize>)| {
        found.iter().filter(|other| expected.contains(other)).count()
    };
    expected.iter().zip(found).map(right).sum::<usize>() as f64 / all as f64
}

/// The same session several times, with numbers of nodes and edges of their own.
fn repeated(once: &PoseGraph, passes: usize) -> Result<PoseGraph, Box<dyn std::error::Error>> {
    let nodes = once.nodes.iter().map(|node| node.id + 1).max().ok_or("the graph has no nodes")?;
    let edges = once.edges.iter().map(|edge| edge.id + 1).max().unwrap_or(0);
    let mut graph = PoseGraph { nodes: Vec::new(), edges: Vec::new(), ..once.clone() };
    for pass in 0..passes as u64 {
        for node in &once.nodes {
            let mut node = node.clone();
            node.id += pass * nodes;
            graph.nodes.push(node);
        }
        for edge in &once.edges {
            let mut edge = edge.clone();
            edge.id += pass * edges;
            edge.from += pass * nodes;
            edge.to += pass * nodes;
            graph.edges.push(edge);
        }
    }
    Ok(graph)
}

/// The context of a keyframe, with noise on every point.
fn context(submaps: &Submaps, node: usize, settings: &Settings, random: &mut ChaCha8Rng) -> PolarContext {
    let mut cloud = submaps.around(node, settings.submap_length, settings.radius / 100.0);
    let mut moved = || NOISE * (2.0 * f64::from(random.next_u32()) / f64::from(u32::MAX) - 1.0);
    cloud.points.iter_mut().for_each(|point| *point += Vector2::new(moved(), moved()));
    PolarContext::new(&cloud, settings.radius)
}

/// The answer of the index without an index.
fn search(keys: &[[f64; KEY]], nodes: &[usize], position: usize, routes: &Routes, apart: f64) -> Vec<usize> {
    let mut found: Vec<(f64, usize)> = keys
        .iter()
        .enumerate()
        .filter(|(other, _)| routes.path_length(nodes[position], nodes[*other]) > apart)
        .map(|(other, key)| (key.iter().zip(&keys[position]).map(|(a, b)| (a - b) * (a - b)).sum(), other))
        .collect();
    let order =
        |one: &(f64, usize), other: &(f64, usize)| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1));
    if found.len() > SHORTLIST {
        found.select_nth_unstable_by(SHORTLIST - 1, order);
        found.truncate(SHORTLIST);
    }
    found.sort_by(order);
    // Not in place: that would keep the memory of all of them.
    found.iter().map(|(_, other)| *other).collect()
}
