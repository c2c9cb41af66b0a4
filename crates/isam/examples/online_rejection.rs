//! Online rejection: poses and landmark edges arrive one at a time. After every k poses, PCM and the multicut decide about
//! all landmark edges so far; edges enter the map or are retracted.
//!
//! `online_rejection GRAPH.jsonl FIGURE.svg SERIES.csv [K]` follows a graph of posecut-construct. The series has a row per
//! decision: the number of edges in use, and how many of them are incorrect, added, retracted, and re-admitted (added after a
//! retraction); the share by which the online map's cost exceeds the cost of a batch solution of the same decisions; and
//! three root mean square distances of positions from the reference, after the best rigid motion of each connected component:
//! of the online map, of this batch solution, and of a batch solution with exactly the correct edges so far. The reference is
//! the whole graph without the edges that are incorrect by the ground truth. Decisions do not use the ground truth.

#![allow(clippy::print_stdout, reason = "an example prints what it found")]

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use anyhow::Context as _;
use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::plot::legend::LegendPosition;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use nalgebra::Vector3;
use posecut_evaluate::alignment::{Alignment, Freedom};
use posecut_graph::connectivity::connected_components;
use posecut_graph::{EdgeKind, PoseGraph, for_dimension};
use posecut_isam::{EdgeId, IncrementalGroup, IncrementalOptions, IncrementalSolver};
use posecut_multicut::support::support_counts;
use posecut_optimize::{Edge, Options, Problem, optimize, pose_graph};
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::clique::{Limits, maximum_clique};
use posecut_pcm::consistency::consistency_graph;
use posecut_pcm::{Gate, Spatial, Test};

/// A decision, and the state of the map after it.
#[derive(Clone, Copy, Default)]
struct Row {
    node: usize,
    used: usize,
    incorrect: usize,
    added: usize,
    taken_back: usize,
    readmitted: usize,
    gap: f64,
    online: f64,
    batch: f64,
    perfect: f64,
}

/// Maximum number of updates after a decision; they end when no pose moves any more.
const MOST_UPDATES: usize = 20;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let ([input, figure, series] | [input, figure, series, _]) = arguments.as_slice() else {
        anyhow::bail!("usage: online_rejection GRAPH.jsonl FIGURE.svg SERIES.csv [K]")
    };
    let every: usize = arguments.get(3).map_or(Ok(20), |word| word.parse())?;
    anyhow::ensure!(every > 0, "K is 0, but must be a positive number of poses");
    let file = std::fs::File::open(input).with_context(|| format!("{input}: cannot be opened"))?;
    let graph = PoseGraph::read(input, std::io::BufReader::new(file))?;
    let rows = for_dimension!(graph.header.dimension, |G, DOF| follow::<G, DOF>(&graph, every))?;
    let mut text =
        "node,used,incorrect,added,taken_back,readmitted,gap,online_m,batch_m,perfect_m\n".to_owned();
    for row in &rows {
        let Row { node, used, incorrect, added, taken_back, readmitted, .. } = row;
        let Row { gap, online, batch, perfect, .. } = row;
        write!(text, "{node},{used},{incorrect},{added},{taken_back},{readmitted},")?;
        writeln!(text, "{gap:.3e},{online:.6},{batch:.6},{perfect:.6}")?;
    }
    std::fs::write(series, text).with_context(|| format!("{series}: cannot be written"))?;
    std::fs::write(figure, draw(&rows)).with_context(|| format!("{figure}: cannot be written"))?;
    let sum = |count: fn(&Row) -> usize| rows.iter().map(count).sum::<usize>();
    let last = rows.last().copied().unwrap_or_default();
    println!(
        "{} decisions: {} edges added, {} taken back, {} of them readmitted later; {} used in the end, {} of them incorrect",
        rows.len(),
        sum(|row| row.added),
        sum(|row| row.taken_back),
        sum(|row| row.readmitted),
        last.used,
        last.incorrect
    );
    let worst = rows.iter().map(|row| (row.online - row.batch).abs()).fold(0.0, f64::max);
    println!(
        "online and batch differ by at most {worst:.1e} m; in the end the error is {:.3} m online, {:.3} m in batch, {:.3} m with perfect decisions",
        last.online, last.batch, last.perfect
    );
    Ok(())
}

fn follow<G: IncrementalGroup<DOF> + Spatial<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    every: usize,
) -> anyhow::Result<Vec<Row>> {
    let mut all = graph.clone();
    for edge in &mut all.edges {
        edge.readmit();
    }
    let measured = pose_graph::edges::<G, DOF>(&all)?;
    let edges: BTreeMap<usize, Edge<G, DOF>> = measured.places.into_iter().zip(measured.edges).collect();
    let given = all
        .nodes
        .iter()
        .map(|node| {
            G::from_components(&node.pose_or_identity(all.header.dimension))
                .with_context(|| format!("node {}: its pose cannot be used", node.id))
        })
        .collect::<anyhow::Result<Vec<G>>>()?;
    let is_correct = |place: usize| all.edges[place].truth_correct() != Some(false);
    // A batch solution with the correct edges up to a pose.
    let correct_to = |last: usize| -> anyhow::Result<Solved<G, DOF>> {
        let there =
            edges.iter().filter(|&(&place, edge)| is_correct(place) && edge.from.max(edge.to) <= last);
        Solved::of(&given[..=last], there.map(|(_, edge)| *edge).collect())
    };
    let Some(last) = given.len().checked_sub(1) else { return Ok(Vec::new()) };
    let reference = correct_to(last)?.poses;

    let mut solver = IncrementalSolver::<G, DOF>::new(IncrementalOptions::default())?;
    let mut used: BTreeMap<usize, EdgeId> = BTreeMap::new();
    let mut returned: BTreeSet<usize> = BTreeSet::new();
    let mut rows = Vec::new();
    for node in 0..given.len() {
        solver.add_pose(given[node])?;
        for (&place, edge) in &edges {
            if edge.from.max(edge.to) == node && all.edges[place].kind == EdgeKind::Odometry {
                solver.add_edge(*edge)?;
            }
        }
        if !(node + 1).is_multiple_of(every) && node + 1 != given.len() {
            solver.update();
            continue;
        }
        let kept = decide::<G, DOF>(&prefix(&all, node))?;
        let incorrect = kept.iter().filter(|&&place| !is_correct(place)).count();
        let mut row = Row { node, used: kept.len(), incorrect, ..Row::default() };
        let gone: Vec<usize> = used.keys().copied().filter(|place| !kept.contains(place)).collect();
        for place in gone {
            if let Some(id) = used.remove(&place) {
                solver.remove_edge(id)?;
                returned.insert(place);
                row.taken_back += 1;
            }
        }
        for place in kept {
            if let (false, Some(edge)) = (used.contains_key(&place), edges.get(&place)) {
                used.insert(place, solver.add_edge(*edge)?);
                row.added += 1;
                row.readmitted += usize::from(returned.remove(&place));
            }
        }
        // A step takes few linear solutions; if a decision swings the map, it needs several steps.
        for _ in 0..MOST_UPDATES {
            if solver.update().relinearised == 0 {
                break;
            }
        }
        let remaining: Vec<_> = solver.edges().into_iter().map(|(_, edge)| edge).collect();
        row.online = error(&solver.estimates(), ends(&remaining), &reference);
        let batch = Solved::of(&given[..=node], remaining)?;
        row.gap = (solver.cost() - batch.cost) / batch.cost.max(1e-6);
        row.batch = error(&batch.poses, ends(&batch.edges), &reference);
        let perfect = correct_to(node)?;
        row.perfect = error(&perfect.poses, ends(&perfect.edges), &reference);
        rows.push(row);
    }
    Ok(rows)
}

/// A batch solution of these edges.
struct Solved<G, const DOF: usize> {
    poses: Vec<G>,
    edges: Vec<Edge<G, DOF>>,
    cost: f64,
}

impl<G: IncrementalGroup<DOF>, const DOF: usize> Solved<G, DOF> {
    fn of(given: &[G], edges: Vec<Edge<G, DOF>>) -> anyhow::Result<Self> {
        let solution = optimize(&Problem::new(given.to_vec(), edges.clone())?, &Options::default());
        Ok(Self { poses: solution.poses, edges, cost: solution.cost })
    }
}

fn ends<G, const DOF: usize>(edges: &[Edge<G, DOF>]) -> impl Iterator<Item = (usize, usize)> + Clone + '_ {
    edges.iter().map(|edge| (edge.from, edge.to))
}

/// The graph up to a node, with nothing rejected. Edges keep their indices: later ones are marked.
fn prefix(all: &PoseGraph, last: usize) -> PoseGraph {
    let mut graph = all.clone();
    for edge in &mut graph.edges {
        let place = |id| all.node_index(id).unwrap_or(usize::MAX);
        if place(edge.from).max(place(edge.to)) > last {
            edge.reject("time");
        }
    }
    graph
}

/// The indices of the landmark edges that PCM and then the multicut keep, with the paper's costs.
fn decide<G: Spatial<DOF>, const DOF: usize>(graph: &PoseGraph) -> anyhow::Result<Vec<usize>> {
    let mut graph = graph.clone();
    let gate = Gate::new(Test::Mahalanobis, 0.99, DOF)?;
    let chains = Chains::<G, DOF>::of(&graph)?;
    for group in &group(&graph, &chains)?.groups {
        let consistency = consistency_graph(&chains, group, gate);
        let clique = maximum_clique(&consistency.graph, Limits::work(20_000_000));
        for (vertex, candidate) in group.candidates.iter().enumerate() {
            if clique.vertices.binary_search(&vertex).is_err() {
                graph.edges[candidate.edge].reject("pcm");
            }
        }
    }
    let support = support_counts(&graph, 1)?;
    let place = |id: u64| graph.node_index(id).map_or(u64::MAX, |index| index as u64);
    let cut_edges = support.iter().map(|&(edge, count)| {
        let edge = &graph.edges[edge];
        (place(edge.from), place(edge.to), if count > 0 { 1.0 } else { -1.0 })
    });
    let cut_graph = posecut_multicut::Graph::new(graph.nodes.len(), cut_edges)?;
    let labels = posecut_multicut::solve(&cut_graph, &posecut_multicut::Options::default()).labels;
    let label = |id: u64| graph.node_index(id).map(|index| labels[index]);
    let joined = |edge: usize| label(graph.edges[edge].from) == label(graph.edges[edge].to);
    Ok(support.into_iter().map(|(edge, _)| edge).filter(|&edge| joined(edge)).collect())
}

/// Root mean square distance of positions, after the best rigid motion of each connected component: the map does not
/// determine the relative pose of components. The reference may have more poses.
fn error<G: Spatial<DOF>, const DOF: usize>(
    poses: &[G],
    edges: impl Iterator<Item = (usize, usize)> + Clone,
    reference: &[G],
) -> f64 {
    let freedom = if DOF == 3 { Freedom::Se2 } else { Freedom::Se3 };
    let position = |poses: &[G], node: usize| Vector3::from(poses[node].translation());
    let mut squares = 0.0;
    for part in connected_components(poses.len(), edges) {
        let points = |poses| part.nodes.iter().map(|&node| position(poses, node)).collect::<Vec<_>>();
        let (from, to) = (points(poses), points(reference));
        let alignment = Alignment::best(&from, &to, freedom);
        squares += from.iter().zip(&to).map(|(p, q)| (alignment.apply(p) - q).norm_squared()).sum::<f64>();
    }
    (squares / poses.len().max(1) as f64).sqrt()
}

fn draw(rows: &[Row]) -> String {
    let line = |legend: &str, colour: &str, width: f64, value: fn(&Row) -> f64| {
        LinePlot::new()
            .with_data(rows.iter().map(|row| (row.node as f64, value(row))))
            .with_color(colour)
            .with_stroke_width(width)
            .with_legend(legend)
    };
    // The wider line is drawn first, so that both are visible where they agree.
    let plots: Vec<Plot> = vec![
        line("batch, perfect decisions", "#e69f00", 2.5, |row| row.perfect).into(),
        line("batch, the same decisions", "#bbbbbb", 5.0, |row| row.batch).into(),
        line("online", "#0055aa", 1.5, |row| row.online).into(),
    ];
    let layout = Layout::auto_from_plots(&plots)
        .with_title("Error of the map over time")
        .with_x_label("pose")
        .with_y_label("RMSE to the reference (m)")
        .with_legend_position(LegendPosition::InsideTopLeft);
    let scene = Figure::new(1, 1)
        .with_plots(vec![plots])
        .with_layouts(vec![layout])
        .with_cell_size(800.0, 420.0)
        .render();
    SvgBackend::default().render_scene(&scene)
}
