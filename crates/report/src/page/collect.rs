//! Collects the page's data from results and from the graphs in the same folders.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use posecut_evaluate::alignment::{Alignment, Freedom};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_stage::{Context, Source, info, warn};
use posecut_view::encode;

use super::view::{
    Consistency, ERROR_STEP, Edges, Experience, Experiment, Method, POSITION_STEP, Seed, Session, Spread,
    Track,
};
use crate::consistency;
use crate::figure::graphs::{self, Estimate};
use crate::figure::{Frame, components, error};
use crate::published::Published;
use crate::results::Located;
use crate::table::Table;

/// A consistency matrix of more candidates than this is left out of the page: its size grows with the square.
pub const LARGEST_MATRIX: usize = 1500;

/// The name of the reference among the results, unless the user names another.
pub const REFERENCE: &str = "oracle";

/// What the page draws.
#[derive(Clone, Copy, Debug)]
pub struct Selection {
    /// Seeds of each session whose graphs are drawn.
    pub seeds: usize,
    /// How coordinates map to paper.
    pub frame: Frame,
}

/// One experiment: the RMSE of every run, and the graphs of some runs.
pub fn experiment(
    table: &Table,
    results: &[Located],
    published: &Published,
    selection: Selection,
    context: &mut Context,
) -> anyhow::Result<Experiment> {
    let own: Vec<&Located> =
        results.iter().filter(|located| located.result.label("pipeline") == table.pipeline).collect();
    let methods: Vec<String> = table.methods.iter().map(|row| row.method.clone()).collect();
    let mut spread = Vec::new();
    let mut sessions = Vec::new();
    for name in &table.sessions {
        for method in &methods {
            let mut rmse: Vec<(String, f64)> = own
                .iter()
                .filter(|located| {
                    located.result.label("session") == *name && located.result.label("method") == *method
                })
                .map(|located| (located.result.label("seed"), located.result.rmse))
                .collect();
            rmse.sort_by_key(|(seed, _)| seed_order(seed));
            let published = published.value(method, name);
            if !rmse.is_empty() || published.is_some() {
                spread.push(Spread { session: name.clone(), method: method.clone(), rmse, published });
            }
        }
        let runs: Vec<&&Located> =
            own.iter().filter(|located| located.result.label("session") == *name).collect();
        if let Some(session) = session(&table.pipeline, name, &methods, &runs, selection, context)? {
            sessions.push(session);
        }
    }
    Ok(Experiment { name: table.pipeline.clone(), methods, spread, sessions })
}

/// Sort key of seeds: numbers in ascending order, then other seeds by name.
fn seed_order(seed: &str) -> (bool, u64, String) {
    let number = seed.parse::<u64>();
    (number.is_err(), number.unwrap_or(0), seed.to_owned())
}

fn session(
    pipeline: &str,
    name: &str,
    methods: &[String],
    runs: &[&&Located],
    selection: Selection,
    context: &mut Context,
) -> anyhow::Result<Option<Session>> {
    let mut by_seed: BTreeMap<(bool, u64, String), BTreeMap<String, &Located>> = BTreeMap::new();
    for run in runs {
        let seed = seed_order(&run.result.label("seed"));
        by_seed.entry(seed).or_default().insert(run.result.label("method"), run);
    }
    let mut session = Session { name: name.to_owned(), truth: None, minutes: None, seeds: Vec::new() };
    for ((_, _, seed), runs) in by_seed.iter().take(selection.seeds) {
        let role = |method: &str| format!("{pipeline}/{name}/{seed}/{method}");
        let mut loader = Loader { context, frame: selection.frame };
        let Some(first) = runs.values().next() else { continue };
        let reference = loader.graph(&first.path, REFERENCE, &role(REFERENCE))?;
        let mut view: Option<Seed> = None;
        for method in methods {
            let Some(run) = runs.get(method) else { continue };
            let Some(graph) = loader.graph(&run.path, method, &role(method))? else {
                info!("{}: there is no graph beside the result of {method}", role(method));
                continue;
            };
            if session.seeds.is_empty() && session.truth.is_none() {
                session.truth = Loader::track(&bridged(truth(&graph, selection.frame)));
                session.minutes = minutes(&graph);
            }
            let motion = graphs::onto_truth(reference.as_ref().unwrap_or(&graph));
            let view = view.get_or_insert_with(|| Seed {
                name: seed.clone(),
                experiences: experiences(&graph),
                reference: reference.as_ref().and_then(|graph| {
                    let own = Estimate::new(graph, None, Freedom::None).moved(&motion);
                    Loader::track(&own.places(selection.frame))
                }),
                edges: edges(&graph),
                consistency: None,
                methods: Vec::new(),
            });
            view.methods.push(loader.method(run, &graph, reference.as_ref(), &motion, &view.edges));
            if view.consistency.is_none() && consistency::went_through_pcm(&graph) {
                view.consistency = matrix(&graph, &view.edges, method);
            }
        }
        session.seeds.extend(view);
    }
    Ok((!session.seeds.is_empty()).then_some(session))
}

struct Loader<'a> {
    context: &'a mut Context,
    frame: Frame,
}

impl Loader<'_> {
    /// The optimised graph of a method, in the folder of a result: `METHOD.optimized.jsonl`, or the same with `.gz`.
    fn graph(&mut self, result: &Path, method: &str, role: &str) -> anyhow::Result<Option<PoseGraph>> {
        let candidates: [PathBuf; 2] =
            ["jsonl", "jsonl.gz"].map(|ending| result.with_file_name(format!("{method}.optimized.{ending}")));
        let Some(path) = candidates.into_iter().find(|path| path.is_file()) else { return Ok(None) };
        self.context.read_graph(&Source::File(path), role).map(Some)
    }

    /// The positions as a track; `None` if a node has no position.
    fn track(places: &[Option<(f64, f64)>]) -> Option<Track> {
        let places: Vec<(f64, f64)> = places.iter().copied().collect::<Option<_>>()?;
        (!places.is_empty()).then(|| Track {
            right: encode::series(places.iter().map(|place| place.0), POSITION_STEP),
            up: encode::series(places.iter().map(|place| place.1), POSITION_STEP),
        })
    }

    fn method(
        &self,
        run: &Located,
        graph: &PoseGraph,
        reference: Option<&PoseGraph>,
        motion: &Alignment,
        edges: &Edges,
    ) -> Method {
        let name = run.result.label("method");
        let estimate = Estimate::new(graph, reference, freedom(run, graph)).moved(motion);
        let error = estimate.errors();
        if let Some(errors) = &error {
            let sum: f64 = errors.iter().map(|error| error * error).sum();
            let drawn = (sum / errors.len().max(1) as f64).sqrt();
            if (drawn - run.result.rmse).abs() > 1e-6 * run.result.rmse.max(1.0) {
                warn!(
                    "{}/{}/{}/{name}: the RMSE of the graph is {drawn} m, but that of the result is {} m; the result has another alignment or scope, or the graph is newer",
                    run.result.label("pipeline"),
                    run.result.label("session"),
                    run.result.label("seed"),
                    run.result.rmse
                );
            }
        }
        let (state, stages) = states(graph, edges);
        Method {
            name,
            rmse: run.result.rmse,
            components: run.result.components,
            track: Self::track(&estimate.places(self.frame)),
            error: error.map(|errors| encode::series(errors, ERROR_STEP)),
            state,
            stages,
            landmarks: components::landmarks(graph),
        }
    }
}

/// The motions that the evaluation's alignment could use.
fn freedom(run: &Located, graph: &PoseGraph) -> Freedom {
    match run.result.alignment.as_ref().map(|used| used.freedom.as_str()) {
        Some("none") => Freedom::None,
        Some("SE(2)") => Freedom::Se2,
        Some("SE(3)") => Freedom::Se3,
        Some("Sim(3)") => Freedom::Sim3,
        _ => graphs::usual_freedom(graph),
    }
}

fn truth(graph: &PoseGraph, frame: Frame) -> Vec<Option<(f64, f64)>> {
    graph
        .nodes
        .iter()
        .map(|node| {
            let pose = node.truth.as_ref()?.pose.as_ref()?;
            Some(frame.place(pose[0], pose[1]))
        })
        .collect()
}

/// Gives each node without a position that of the last node with one, or of the first such node at the start. So a
/// session is drawn although its ground truth has gaps, and nodes keep their indices.
fn bridged(mut places: Vec<Option<(f64, f64)>>) -> Vec<Option<(f64, f64)>> {
    let mut last = places.iter().copied().flatten().next();
    for place in &mut places {
        *place = place.or(last);
        last = *place;
    }
    places
}

fn minutes(graph: &PoseGraph) -> Option<String> {
    error::minutes(graph).map(|minutes| encode::series(minutes, 0.01))
}

/// Runs of consecutive nodes with the same session name.
fn experiences(graph: &PoseGraph) -> Vec<Experience> {
    let mut experiences: Vec<Experience> = Vec::new();
    for (index, node) in graph.nodes.iter().enumerate() {
        let name = node.session.as_deref().unwrap_or_default();
        match experiences.last_mut() {
            Some(last) if last.name == name => last.end = index + 1,
            _ => experiences.push(Experience { name: name.to_owned(), start: index, end: index + 1 }),
        }
    }
    experiences
}

fn edges(graph: &PoseGraph) -> Edges {
    let mut edges = Edges::default();
    let frame = |node: usize| graph.nodes[node].frame.unwrap_or(node as i64);
    for edge in graph.edges_of(EdgeKind::Landmark) {
        let Some((from, to)) = graph.ends(edge) else { continue };
        edges.id.push(edge.id);
        edges.from.push(from);
        edges.to.push(to);
        edges.frames.push((frame(from), frame(to)));
        edges.truth.push(match edge.truth_correct() {
            Some(true) => 't',
            Some(false) => 'f',
            None => '?',
        });
    }
    edges
}

/// The state of each edge, and the stages that rejected edges.
fn states(graph: &PoseGraph, edges: &Edges) -> (String, Vec<String>) {
    let mut stages: Vec<String> = Vec::new();
    let found: BTreeMap<u64, Option<&str>> =
        graph.edges_of(EdgeKind::Landmark).map(|edge| (edge.id, edge.rejected_by.as_deref())).collect();
    let state = edges
        .id
        .iter()
        .map(|id| match found.get(id) {
            None => '-',
            Some(None) => '+',
            Some(Some(stage)) => {
                let place = stages.iter().position(|known| known == stage).unwrap_or_else(|| {
                    stages.push((*stage).to_owned());
                    stages.len() - 1
                });
                char::from(b'a' + place.min(25) as u8)
            }
        })
        .collect();
    (state, stages)
}

fn matrix(graph: &PoseGraph, edges: &Edges, method: &str) -> Option<Consistency> {
    let matrix = match consistency::matrix(graph) {
        Ok(matrix) => matrix?,
        Err(error) => {
            warn!("{method}: the page omits the consistency matrix: {error:#}");
            return None;
        }
    };
    let count = matrix.edges.len();
    if count > LARGEST_MATRIX {
        warn!(
            "{method}: the page omits the consistency matrix of {count} candidates; at most {LARGEST_MATRIX} are shown"
        );
        return None;
    }
    let place: BTreeMap<u64, usize> = edges.id.iter().enumerate().map(|(place, id)| (*id, place)).collect();
    Some(Consistency {
        edges: matrix
            .edges
            .iter()
            .map(|&edge| place.get(&graph.edges[edge].id).copied())
            .collect::<Option<_>>()?,
        group: matrix.group.clone(),
        clique: encode::bits(matrix.clique.iter().copied()),
        pairs: encode::bits(
            (0..count)
                .flat_map(|row| (row + 1..count).map(move |column| (row, column)))
                .map(|(row, column)| matrix.consistent(row, column)),
        ),
        gate: matrix.gate.clone(),
        method: method.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::bridged;

    #[test]
    fn a_node_without_truth_does_not_hide_its_session() {
        let places = vec![None, Some((1.0, 2.0)), None, None, Some((3.0, 4.0)), None];
        let expected = [(1.0, 2.0), (1.0, 2.0), (1.0, 2.0), (1.0, 2.0), (3.0, 4.0), (3.0, 4.0)];
        assert_eq!(bridged(places), expected.map(Some));
        assert_eq!(bridged(vec![None, None]), [None, None], "a session without any truth stays out");
    }
}
