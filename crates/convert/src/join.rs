//! Joins the graphs of several files into one, each as a session of its own.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use posecut_graph::PoseGraph;
use posecut_stage::{Source, counted};

use crate::ConvertError;

/// Joins graphs. Nodes, edges and priors get new ids, in the order of the graphs; frames stay. A graph of one session is renamed to the name beside
/// it, and the sessions of another graph are put below that name, as in `name/a`.
pub(crate) fn join(graphs: Vec<(String, PoseGraph)>) -> Result<PoseGraph, ConvertError> {
    let mut joined: Option<PoseGraph> = None;
    for (name, mut graph) in graphs {
        rename(&mut graph, &name);
        state_information(&mut graph);
        let Some(whole) = &mut joined else {
            joined = Some(renumbered(graph, [0; 3]));
            continue;
        };
        if graph.header.dimension != whole.header.dimension {
            return Err(ConvertError::graph(
                format!(
                    "{name} has dimension {}, but the files before it have dimension {}",
                    graph.header.dimension, whole.header.dimension
                ),
                "a pose graph has one dimension; convert these files one by one",
            ));
        }
        let counts = [whole.nodes.len(), whole.edges.len(), whole.priors.len()];
        let graph = renumbered(graph, counts.map(|count| count as u64));
        whole.nodes.extend(graph.nodes);
        whole.edges.extend(graph.edges);
        whole.priors.extend(graph.priors);
        whole.unknown.extend(graph.unknown);
        whole.header.provenance.extend(graph.header.provenance);
    }
    joined.ok_or_else(|| ConvertError::graph("there is no graph to join", "name one or several files"))
}

fn rename(graph: &mut PoseGraph, name: &str) {
    let several = graph.sessions().len() > 1;
    for node in &mut graph.nodes {
        node.session = Some(match node.session.take() {
            Some(session) if several => format!("{name}/{session}"),
            _ => name.to_owned(),
        });
    }
}

/// Gives each edge and prior its own information matrix, because graphs may call different noise models by one name.
fn state_information(graph: &mut PoseGraph) {
    let matrices: Vec<Option<Vec<f64>>> =
        graph.edges.iter().map(|edge| graph.information(edge).map(<[f64]>::to_vec)).collect();
    for (edge, information) in graph.edges.iter_mut().zip(matrices) {
        edge.information = information;
        edge.noise = None;
    }
    let matrices: Vec<Option<Vec<f64>>> =
        graph.priors.iter().map(|prior| graph.information_of_prior(prior).map(<[f64]>::to_vec)).collect();
    for (prior, information) in graph.priors.iter_mut().zip(matrices) {
        prior.information = information;
        prior.noise = None;
    }
    graph.header.noise_models.clear();
}

/// The graph with ids of nodes, edges and priors that count from these.
fn renumbered(mut graph: PoseGraph, [first_node, first_edge, first_prior]: [u64; 3]) -> PoseGraph {
    let ids: HashMap<u64, u64> = (first_node..).zip(&graph.nodes).map(|(id, node)| (node.id, id)).collect();
    for (id, node) in (first_node..).zip(&mut graph.nodes) {
        node.id = id;
    }
    for (id, edge) in (first_edge..).zip(&mut graph.edges) {
        edge.id = id;
        // The readers add a node for every end.
        edge.from = ids.get(&edge.from).copied().unwrap_or(edge.from);
        edge.to = ids.get(&edge.to).copied().unwrap_or(edge.to);
    }
    for (id, prior) in (first_prior..).zip(&mut graph.priors) {
        prior.id = id;
        prior.node = ids.get(&prior.node).copied().unwrap_or(prior.node);
    }
    graph
}

/// A session name for each of several files: those given, else the names of the files without folder and extension, or with their
/// folder where these repeat.
pub(crate) fn names(files: &[Source], given: &[String]) -> Result<Vec<String>, ConvertError> {
    let names = if given.is_empty() { of_files(files) } else { given.to_vec() };
    if names.len() != files.len() {
        return Err(ConvertError::graph(
            format!(
                "--session names {}, but there are {}",
                counted(names.len(), "session"),
                counted(files.len(), "file")
            ),
            "give --session once for each file, in their order, or leave it out to use the names of the files",
        ));
    }
    let mut seen = BTreeMap::new();
    for (name, file) in names.iter().zip(files) {
        if let Some(first) = seen.insert(name, file) {
            return Err(ConvertError::graph(
                format!("{first} and {file} would both be session \"{name}\""),
                "give --session once for each file, in their order, with different names",
            ));
        }
    }
    Ok(names)
}

fn of_files(files: &[Source]) -> Vec<String> {
    let stems: Vec<String> = files.iter().map(stem).collect();
    let with_folder = |file: &Source, stem: &String| match file {
        Source::File(path) if stems.iter().filter(|other| *other == stem).count() > 1 => {
            let folder = path.parent().and_then(Path::file_name);
            folder.map_or_else(|| stem.clone(), |folder| format!("{}/{stem}", folder.to_string_lossy()))
        }
        _ => stem.clone(),
    };
    files.iter().zip(&stems).map(|(file, stem)| with_folder(file, stem)).collect()
}

/// The name of a file without folder and extension; `.gz` is no extension of its own.
fn stem(file: &Source) -> String {
    let Source::File(path) = file else { return "input".to_owned() };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    match name.rsplit_once('.') {
        Some((stem, _)) if !stem.is_empty() => stem.to_owned(),
        _ => name.to_owned(),
    }
}
