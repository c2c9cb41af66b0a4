//! Joins several session graphs.

use std::collections::{HashMap, HashSet};

use posecut_graph::{Header, NoiseModel, PoseGraph};

use crate::ConstructError;

/// Puts graphs side by side. Nodes, edges and priors are numbered anew in the given order. Equal noise models are kept once,
/// and different models with the same name get a suffix. Histories and unknown records are concatenated.
pub fn join(graphs: Vec<PoseGraph>) -> Result<PoseGraph, ConstructError> {
    let Some(first) = graphs.first() else {
        return Err(refused("there is no graph to construct from", "name at least one session graph"));
    };
    let mut joined = PoseGraph::new(Header::new(first.header.dimension));
    joined.header.extra.clone_from(&first.header.extra);
    let mut sessions = HashSet::new();
    for graph in graphs {
        if graph.header.dimension != joined.header.dimension {
            return Err(refused(
                &format!(
                    "one graph has dimension {}, another {}",
                    joined.header.dimension, graph.header.dimension
                ),
                "ingest all sessions with the same --dimension",
            ));
        }
        for session in graph.sessions() {
            if !sessions.insert(session.to_owned()) {
                return Err(refused(
                    &format!("the session \"{session}\" is in two of the graphs"),
                    "name each session once, or rename one with posecut-ingest --name",
                ));
            }
        }
        append(&mut joined, graph);
    }
    Ok(joined)
}

fn append(joined: &mut PoseGraph, graph: PoseGraph) {
    let names = merge_noise_models(&mut joined.header, graph.header.noise_models);
    joined.header.provenance.extend(graph.header.provenance);
    let mut numbers = HashMap::with_capacity(graph.nodes.len());
    for mut node in graph.nodes {
        let id = joined.nodes.len() as u64;
        numbers.insert(node.id, id);
        node.id = id;
        joined.nodes.push(node);
    }
    for mut edge in graph.edges {
        edge.id = joined.edges.len() as u64;
        edge.from = numbers[&edge.from];
        edge.to = numbers[&edge.to];
        if let Some(noise) = &mut edge.noise
            && let Some(renamed) = names.get(noise)
        {
            noise.clone_from(renamed);
        }
        joined.edges.push(edge);
    }
    for mut prior in graph.priors {
        prior.id = joined.priors.len() as u64;
        prior.node = numbers[&prior.node];
        if let Some(noise) = &mut prior.noise
            && let Some(renamed) = names.get(noise)
        {
            noise.clone_from(renamed);
        }
        joined.priors.push(prior);
    }
    joined.unknown.extend(graph.unknown);
}

/// Adds models to a header, and returns the names that had to change.
fn merge_noise_models(header: &mut Header, models: Vec<(String, NoiseModel)>) -> HashMap<String, String> {
    let mut renamed = HashMap::new();
    for (name, model) in models {
        let mut free = name.clone();
        let mut suffix = 2;
        while header.noise_model(&free).is_some_and(|known| *known != model) {
            free = format!("{name}-{suffix}");
            suffix += 1;
        }
        if header.noise_model(&free).is_none() {
            header.noise_models.push((free.clone(), model));
        }
        if free != name {
            renamed.insert(name, free);
        }
    }
    renamed
}

fn refused(problem: &str, remedy: &str) -> ConstructError {
    ConstructError::Join { problem: problem.to_owned(), remedy: remedy.to_owned() }
}
