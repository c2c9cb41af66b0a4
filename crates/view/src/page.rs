//! Assembles the page: the template, styles, scripts and data.

use anyhow::ensure;
use posecut_geometry::SE3;
use serde::Serialize;

use crate::broken::{Broken, broken};
use crate::columns::{Column, fields, labels};
use crate::doubts::{Doubted, doubts};
use crate::encode::{Whole, differences};
use crate::frame::{Plane, first_plane};
use crate::history::{Stage, stages};
use crate::map::{Edges, Map};
use crate::markup::{escape, fill, json};
use crate::nodes::Nodes;
use crate::poses::{Positions, poses, poses_in, step};
use crate::reckoning::{Reckoning, dead_reckoning, same};
use crate::residuals::{DEGREE_STEP, METRE_STEP, Motions, measured, residuals};
use crate::verification::Verification;
use crate::{Remark, View, script};

const TEMPLATE: &str = include_str!("../assets/page.html");

/// The styles in their order.
const STYLES: [&str; 3] = [
    include_str!("../assets/style/base.css"),
    include_str!("../assets/style/map.css"),
    include_str!("../assets/style/panels.css"),
];

/// The scripts in the order in which they run.
const SCRIPTS: [&str; 24] = [
    script::SERIES,
    script::ELEMENTS,
    script::SCALE,
    include_str!("../assets/script/data.js"),
    include_str!("../assets/script/theme.js"),
    include_str!("../assets/script/words.js"),
    include_str!("../assets/script/state.js"),
    include_str!("../assets/script/maps.js"),
    include_str!("../assets/script/filter.js"),
    include_str!("../assets/script/frame.js"),
    include_str!("../assets/script/camera.js"),
    include_str!("../assets/script/paths.js"),
    include_str!("../assets/script/edges.js"),
    include_str!("../assets/script/paint.js"),
    include_str!("../assets/script/overlay.js"),
    include_str!("../assets/script/pointer.js"),
    include_str!("../assets/script/facets.js"),
    include_str!("../assets/script/probability.js"),
    include_str!("../assets/script/card.js"),
    include_str!("../assets/script/table.js"),
    include_str!("../assets/script/panels.js"),
    include_str!("../assets/script/controls.js"),
    include_str!("../assets/script/keys.js"),
    include_str!("../assets/script/start.js"),
];

/// All data of the page.
#[derive(Serialize)]
struct Data<'a> {
    /// The step of positions, metres.
    step: f64,
    /// The steps of lengths, metres, and angles, degrees.
    steps: [f64; 2],
    planes: Vec<Plane>,
    /// The plane to begin with.
    plane: usize,
    nodes: Nodes,
    edges: LandmarkEdges,
    before: Option<Before>,
    /// The main map, then the alternatives.
    maps: Vec<Map>,
    broken: Vec<Broken>,
    verification: Option<Verification>,
    remarks: &'a [Remark],
    doubts: Vec<Doubted>,
    stages: Vec<Stage>,
    version: &'static str,
}

/// What all maps share of the landmark edges.
#[derive(Serialize)]
struct LandmarkEdges {
    count: usize,
    id: Whole,
    /// Indices of nodes.
    from: String,
    to: String,
    measured: Motions,
    label: Option<Column>,
    /// Fields of edges that the page does not show.
    hidden: usize,
}

/// The poses before.
#[derive(Serialize)]
struct Before {
    /// Whether they are dead reckoning, and not of a file.
    reckoned: bool,
    /// Of dead reckoning: how many chains of odometry there are.
    chains: usize,
    positions: Positions,
    residuals: Motions,
}

/// Makes the page. Its content security policy forbids every connection, and every script but its own.
///
/// Nodes and edges of all graphs must be in ascending order of id, as [`posecut_graph::PoseGraph::read`] and
/// [`sort`](posecut_graph::PoseGraph::sort) leave them.
///
/// # Errors
///
/// Nodes or edges are in another order, or another graph has another dimension.
pub fn page(view: &View) -> anyhow::Result<String> {
    let others = view.before.into_iter().chain(view.alternatives.iter().map(|other| other.graph));
    for graph in others.chain([view.graph]) {
        ensure!(
            graph.header.dimension == view.graph.header.dimension,
            "the graphs of a page have dimension {} and {}; give graphs of one dimension",
            view.graph.header.dimension,
            graph.header.dimension
        );
        ensure!(
            graph.nodes.is_sorted_by_key(|node| node.id) && graph.edges.is_sorted_by_key(|edge| edge.id),
            "the nodes or edges of a graph are not in the order of their ids; sort the graph first"
        );
    }
    if let Some(before) = view.before {
        ensure!(
            poses_in(view.graph, before).iter().any(Option::is_some),
            "the graph of the poses before has no pose for any node of the graph; give a graph with the same node ids, or none"
        );
    }
    let style = STYLES.concat();
    let script = script::wrapped(&SCRIPTS);
    let data = json(&serde_json::to_string(&data(view))?);
    Ok(fill(TEMPLATE, |name| match name {
        "policy" => Some(script::policy(&style, &script)),
        "title" => Some(escape(view.title)),
        "style" => Some(style.clone()),
        "script" => Some(script.clone()),
        "data" => Some(data.clone()),
        _ => None,
    }))
}

fn data<'a>(view: &View<'a>) -> Data<'a> {
    let graph = view.graph;
    let dimension = graph.header.dimension;
    let edges = Edges::of(graph);
    let main = poses(graph);
    let verification = view.statistics.map(|statistics| Verification::of(graph, statistics));
    let before = match view.before {
        Some(other) => Some(Reckoning { poses: poses_in(graph, other), chains: 0 }),
        None => dead_reckoning(graph, &main),
    };
    let mut all = vec![main];
    all.extend(view.alternatives.iter().map(|other| poses_in(graph, other.graph)));
    let drawn: Vec<&[Option<SE3>]> =
        all.iter().chain(before.as_ref().map(|before| &before.poses)).map(Vec::as_slice).collect();
    let step = step(&drawn);
    // Poses that are dead reckoning themselves have nothing before them.
    let before = before.filter(|before| !same(&before.poses, &all[0], step)).and_then(|before| {
        Some(Before {
            reckoned: view.before.is_none(),
            chains: before.chains,
            positions: Positions::of(&before.poses, dimension, step)?,
            residuals: residuals(dimension, &edges.all, &edges.ends, &before.poses),
        })
    });
    let (names, hidden) = fields(&edges.all);
    let graphs = [("main map", graph)].into_iter();
    let graphs = graphs.chain(view.alternatives.iter().map(|other| (other.name, other.graph)));
    let maps: Vec<Map> = graphs
        .zip(&all)
        .map(|((name, other), poses)| Map::of(name, graph, &edges, &names, (other, poses, step)))
        .collect();
    let planes = view.frame.of(&graph.header).planes(dimension);
    let ids: Vec<u64> = edges.all.iter().map(|edge| edge.id).collect();
    Data {
        step,
        steps: [METRE_STEP, DEGREE_STEP],
        plane: first_plane(&planes, &all[0]),
        planes,
        nodes: Nodes::of(graph),
        edges: LandmarkEdges {
            count: edges.all.len(),
            id: Whole::of(&ids),
            from: differences(edges.ends.iter().map(|(from, _)| *from as i64)),
            to: differences(edges.ends.iter().map(|(_, to)| *to as i64)),
            measured: measured(dimension, &edges.all),
            label: labels(&edges.all),
            hidden,
        },
        before,
        maps,
        broken: broken(graph, verification.as_ref()),
        verification,
        remarks: view.remarks,
        doubts: doubts(&graph.header),
        stages: stages(&graph.header),
        version: env!("CARGO_PKG_VERSION"),
    }
}
