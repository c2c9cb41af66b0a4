//! Priors pass through every stage, and the optimiser uses them.

use posecut_contract::{run, succeed, workspace};
use posecut_graph::{PoseGraph, Prior};

/// The stages that write the graph that they read, with their arguments.
const STAGES: &[(&str, &[&str])] = &[
    ("densest", &[]),
    ("islands", &[]),
    ("multicut", &[]),
    ("oracle", &[]),
    ("pcm", &[]),
    ("ransac", &[]),
    ("readmit", &[]),
    ("verify", &[]),
    ("voting", &[]),
    ("optimize", &[]),
    ("inspect", &["filter"]),
    ("convert", &["--to", "jsonl"]),
    ("clean", &["-o", "-"]),
];

/// Programs that only look at a graph.
const READERS: &[(&str, &[&str])] =
    &[("evaluate", &[]), ("inspect", &["info"]), ("inspect", &["validate"]), ("doctor", &[]), ("view", &[])];

fn bytes(graph: &PoseGraph) -> Vec<u8> {
    let mut bytes = Vec::new();
    graph.write(&mut bytes).unwrap();
    bytes
}

fn read(bytes: &[u8]) -> PoseGraph {
    PoseGraph::read("test", bytes).unwrap()
}

/// The sample of the golden test with priors: positions that are true, one pose, one rejected before, and unknown fields.
fn sample() -> PoseGraph {
    let mut graph = read(&std::fs::read(workspace().join("testdata/graph.jsonl")).unwrap());
    let step = graph.nodes.len() / 12;
    for (id, node) in graph.nodes.iter().step_by(step).enumerate() {
        let pose = node.truth.as_ref().unwrap().pose.clone().unwrap();
        let whole = id == 3;
        let mut prior = Prior {
            id: 2 * id as u64,
            node: node.id,
            measurement: if whole { pose } else { pose[..2].to_vec() },
            information: Some(if whole { vec![4.0, 0.0, 0.0, 4.0, 0.0, 100.0] } else { vec![4.0, 0.1, 4.0] }),
            source: Some("gps".to_owned()),
            rejected_by: (id == 5).then(|| "earlier".to_owned()),
            score: Some(0.5),
            ..Prior::default()
        };
        prior.extra.insert("satellites".to_owned(), id.into());
        graph.priors.push(prior);
    }
    graph
}

/// Whether a program is to be tested: `POSECUT_CONTRACT_ONLY` limits the tests.
fn is_asked(name: &str) -> bool {
    posecut_contract::registry::programs().iter().any(|known| known == name)
}

#[test]
fn every_stage_passes_priors_through() {
    let graph = sample();
    let input = bytes(&graph);
    for (name, arguments) in STAGES.iter().filter(|(name, _)| is_asked(name)) {
        // Re-admission reads the covariances that the optimiser predicts.
        let marginals = || succeed("optimize", &["--marginals", "landmark"], &input);
        let output = succeed(name, arguments, &if *name == "readmit" { marginals() } else { input.clone() });
        assert_eq!(read(&output).priors, graph.priors, "posecut-{name}");
    }
    for (name, arguments) in READERS.iter().filter(|(name, _)| is_asked(name)) {
        let output = run(name, arguments, &input);
        // Status 1 is a finding: that of the sample without priors.
        let before = run(name, arguments, &bytes(&PoseGraph { priors: Vec::new(), ..graph.clone() }));
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), before.status.code(), "posecut-{name} {arguments:?}: {said}");
    }
}

/// The edges that a stage rejects do not depend on priors.
#[test]
fn priors_do_not_change_verdicts() {
    let graph = sample();
    let without = bytes(&PoseGraph { priors: Vec::new(), ..graph.clone() });
    for name in ["pcm", "multicut", "verify"].into_iter().filter(|name| is_asked(name)) {
        let [with, without] = [&bytes(&graph), &without].map(|input| read(&succeed(name, &[], input)).edges);
        assert_eq!(with, without, "posecut-{name}");
    }
}

#[test]
fn the_incremental_solver_refuses_priors_by_name() {
    if !is_asked("isam") {
        return;
    }
    let output = run("isam", &[], &bytes(&sample()));
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("prior 0") && said.contains("posecut-optimize") && output.stdout.is_empty(),
        "{said}"
    );
}

/// The certificate never calls a component with priors global.
#[test]
fn the_certificate_says_that_it_does_not_cover_priors() {
    if !is_asked("optimize") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let stats = folder.path().join("stats.json");
    let output = run("optimize", &["--certify", "--stats", stats.to_str().unwrap()], &bytes(&sample()));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("1 component with priors") && said.contains("not certified"), "{said}");
    let stats: serde_json::Value = serde_json::from_slice(&std::fs::read(stats).unwrap()).unwrap();
    assert_eq!(stats["certificate"], "not certified");
    assert!(stats["chordal_cost"].is_null(), "{stats}");
}

/// A simulated session with GPS, one prior in ten moved by 100 m or more. Graduation and the Cauchy kernel come within a decimetre of
/// the result without outliers, plain least squares does not come within a metre, and all outliers are rejected.
#[test]
fn outliers_of_gps_lose_their_weight() {
    if !["simulate", "ingest", "optimize", "evaluate"].into_iter().all(is_asked) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("2012-01-22");
    let session = session.to_str().unwrap();
    succeed("simulate", &["--length", "1200", "-o", session], b"");
    let options = ["--sigma-translation", "0.1", "--sigma-rotation", "0.02", "--gps", "gps", session];
    let clean = read(&succeed("ingest", &options, b""));
    let mut spoiled = clean.clone();
    let outliers: Vec<u64> = clean.priors.iter().map(|prior| prior.id).filter(|id| id % 10 == 3).collect();
    for (number, &id) in outliers.iter().enumerate() {
        let measurement = &mut spoiled.priors[id as usize].measurement;
        let angle = 2.4 * number as f64;
        let far = 100.0 + 7.0 * (number % 20) as f64;
        measurement[0] += far * angle.cos();
        measurement[1] += far * angle.sin();
    }
    let clean = bytes(&clean);
    let spoiled = bytes(&spoiled);
    let reference = folder.path().join("reference.jsonl");
    std::fs::write(&reference, succeed("optimize", &[], &clean)).unwrap();
    let apart = |arguments: &[&str]| {
        let optimized = succeed("optimize", arguments, &spoiled);
        let result =
            succeed("evaluate", &["--align", "none", "--reference", reference.to_str().unwrap()], &optimized);
        let result: serde_json::Value = serde_json::from_slice(&result).unwrap();
        (result["rmse"].as_f64().unwrap(), read(&optimized))
    };
    let (plain, _) = apart(&[]);
    let (cauchy, _) = apart(&["--kernel-prior", "cauchy"]);
    let (graduated, graph) = apart(&["--gnc", "--reject-below", "0.5"]);
    assert!(plain > 1.0 && cauchy < 0.3 && graduated < 0.1, "{plain} {cauchy} {graduated}");
    let rejected: Vec<u64> =
        graph.priors.iter().filter(|prior| !prior.in_use()).map(|prior| prior.id).collect();
    assert_eq!(rejected, outliers);
    assert!(graph.priors.iter().all(|prior| prior.extra.contains_key("weight")));
}
