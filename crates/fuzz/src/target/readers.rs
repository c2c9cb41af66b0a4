//! Targets that read files.

use posecut_convert::{
    Repair, g2o as g2o_format, kitti as kitti_format, toro as toro_format, tum as tum_format,
};
use posecut_graph::PoseGraph;

use super::{Outcome, scratch};
use crate::seeds;

/// The largest number of nodes and edges of an instance that is also solved.
const SMALL: usize = 200;

fn written(graph: &PoseGraph) -> Vec<u8> {
    let mut bytes = Vec::new();
    graph.write(&mut bytes).expect("what was read can be written");
    bytes
}

/// Checks that the canonical form of a graph reads back as the same graph and is written with the same bytes again.
fn canonical(graph: &PoseGraph) -> Outcome {
    let bytes = written(graph);
    let again = PoseGraph::read("again", bytes.as_slice()).expect("the canonical form is sound");
    assert!(again == *graph, "writing and reading changes the graph");
    assert!(written(&again) == bytes, "the canonical form has a canonical form of its own");
    Outcome::Read(format!(
        "dimension {}, {} nodes, {} edges, {} unknown, {} noise models",
        graph.header.dimension,
        graph.nodes.len().min(3),
        graph.edges.len().min(3),
        graph.unknown.len().min(2),
        graph.header.noise_models.len().min(3)
    ))
}

/// Checks that the reader that stops at the first error and the one that reads on agree.
pub(super) fn jsonl(input: &[u8]) -> Outcome {
    let examination = posecut_graph::examine("input", input).expect("memory is read");
    match PoseGraph::read("input", input) {
        Ok(graph) => {
            assert!(
                examination.faults.is_empty(),
                "examined, a sound file has faults: {}",
                examination.faults[0]
            );
            assert!(examination.graph.as_ref() == Some(&graph), "examined, the graph is another");
            canonical(&graph)
        }
        Err(error) => {
            let first = examination.faults.first().expect("a refused file has a fault");
            assert_eq!(first.to_string(), error.to_string(), "the first fault is another");
            Outcome::refused(error)
        }
    }
}

thread_local! {
    static SCHEMA: jsonschema::Validator =
        jsonschema::validator_for(&posecut_graph::schema()).expect("the schema is one");
}

/// Checks that the published schema accepts every record that the reader accepts.
pub(super) fn schema(input: &[u8]) -> Outcome {
    let graph = match PoseGraph::read("input", input) {
        Ok(graph) => graph,
        Err(error) => return Outcome::refused(error),
    };
    for line in input.split(|&byte| byte == b'\n') {
        let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line).trim_ascii();
        if !line.is_empty() {
            let record = serde_json::from_slice(line).expect("the reader took it");
            SCHEMA.with(|schema| assert!(schema.is_valid(&record), "the schema refuses {record}"));
        }
    }
    Outcome::Read(format!("{} nodes, {} edges", graph.nodes.len().min(3), graph.edges.len().min(3)))
}

/// Reads strictly, and with all possible repairs. Checks that an accepted input gives a valid pose graph.
pub(super) fn g2o(input: &[u8]) -> Outcome {
    let lenient = g2o_format::ReadOptions { repair: Repair::Clamp, skip_unknown: true, ..Default::default() };
    if let Ok((graph, _)) = g2o_format::read("input", input, &lenient) {
        canonical(&graph);
    }
    match g2o_format::read("input", input, &g2o_format::ReadOptions::default()) {
        Ok((graph, _)) => {
            let (bytes, _) = g2o_format::write(&graph, true);
            g2o_format::read("again", bytes.as_slice(), &lenient).expect("what was written can be read");
            canonical(&graph)
        }
        Err(error) => Outcome::refused(error),
    }
}

/// Like g2o. Writing may be refused if roll and yaw cannot be distinguished.
pub(super) fn toro(input: &[u8]) -> Outcome {
    let lenient = g2o_format::ReadOptions { repair: Repair::Clamp, skip_unknown: true, ..Default::default() };
    if let Ok((graph, _)) = toro_format::read("input", input, &lenient) {
        canonical(&graph);
        drop(toro_format::write(&graph, true));
    }
    match toro_format::read("input", input, &g2o_format::ReadOptions::default()) {
        Ok((graph, _)) => canonical(&graph),
        Err(error) => Outcome::refused(error),
    }
}

pub(super) fn tum(input: &[u8]) -> Outcome {
    match tum_format::read("input", input, "0") {
        Ok(graph) => {
            drop(tum_format::write(&graph, tum_format::Poses::Estimate, None));
            canonical(&graph)
        }
        Err(error) => Outcome::refused(error),
    }
}

pub(super) fn kitti(input: &[u8]) -> Outcome {
    match kitti_format::read("input", input, "0") {
        Ok(graph) => {
            drop(kitti_format::write(&graph, tum_format::Poses::Estimate, None));
            canonical(&graph)
        }
        Err(error) => Outcome::refused(error),
    }
}

/// Solves small instances and checks that their certificates hold.
pub(super) fn mc(input: &[u8]) -> Outcome {
    let graph = match posecut_multicut::read_mc(input) {
        Ok(graph) => graph,
        Err(error) => return Outcome::refused(error),
    };
    if graph.node_count() > SMALL || graph.edges().len() > SMALL {
        return Outcome::Read("large".to_owned());
    }
    let options = posecut_multicut::Options {
        certificate: true,
        time_limit: None,
        work_limit: Some(1_000_000),
        ..Default::default()
    };
    let solution = posecut_multicut::solve(&graph, &options);
    let objective = graph.objective(&solution.labels).expect("one label a node");
    let magnitude: f64 = graph.edges().iter().map(|edge| edge.cost.abs()).sum();
    assert!(
        (objective - solution.objective).abs() <= 1e-9 * magnitude,
        "the objective is that of the labels"
    );
    assert!(
        solution.lower_bound <= solution.objective + 1e-9 * magnitude,
        "a bound of {} above {}",
        solution.lower_bound,
        solution.objective
    );
    let mut certificate = Vec::new();
    solution.certificate.expect("was asked for").write(&mut certificate).expect("memory takes it");
    posecut_multicut::verify(&graph, certificate.as_slice()).expect("the solver's own certificate holds");
    Outcome::Read(format!("solved, {} self-loops", graph.self_loops().min(2)))
}

/// Checks that no certificate proves more than the optimum of the instance.
pub(super) fn certificate(input: &[u8]) -> Outcome {
    let graph = seeds::instance();
    match posecut_multicut::verify(graph, input) {
        Ok(verified) => {
            let optimum = posecut_multicut::solve(graph, &posecut_multicut::Options::default()).objective;
            assert!(
                verified.lower_bound <= optimum + 1e-6,
                "a certificate proves {} where the optimum is {optimum}",
                verified.lower_bound
            );
            Outcome::Read(format!("holds, optimal: {}", verified.optimal))
        }
        Err(error) => Outcome::refused(error),
    }
}

pub(super) fn matches(input: &[u8]) -> Outcome {
    match posecut_construct::read_matches("input", input) {
        Ok(matches) => Outcome::Read(format!("{} matches", matches.len().min(3))),
        Err(error) => Outcome::refused(error),
    }
}

pub(super) fn result(input: &[u8]) -> Outcome {
    let path = scratch("x.result.json");
    std::fs::write(&path, input).expect("the scratch folder takes it");
    match posecut_report::results::read_all(&[path]) {
        Ok(results) => {
            let tables = posecut_report::table::tables(&results, &[], &[]);
            let text =
                posecut_report::table::markdown(&tables, &posecut_report::published::Published::default());
            drop(posecut_report::table::write_csv(&results));
            Outcome::Read(format!("a table of {} lines", text.lines().count()))
        }
        Err(error) => Outcome::refused(error),
    }
}

pub(super) fn published(input: &[u8]) -> Outcome {
    let path = scratch("published.toml");
    std::fs::write(&path, input).expect("the scratch folder takes it");
    match posecut_report::published::Published::read(&path) {
        Ok(published) => Outcome::Read(format!("{} methods", published.rmse.len().min(3))),
        Err(error) => Outcome::refused(error),
    }
}

/// Opens the input as a stage does: decompresses and hashes it to its end.
pub(super) fn gzip(input: &[u8]) -> Outcome {
    let path = scratch("input.gz");
    std::fs::write(&path, input).expect("the scratch folder takes it");
    let mut opened = match posecut_stage::open_file(&path) {
        Ok(opened) => opened,
        Err(error) => return Outcome::refused(error),
    };
    match PoseGraph::read("input", &mut opened) {
        Ok(graph) => match opened.finish() {
            Ok(_) => canonical(&graph),
            Err(error) => Outcome::refused(error),
        },
        Err(error) => Outcome::refused(error),
    }
}
