//! Factors on covariances: estimated, given, and written into the graph.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use posecut_geometry::{SE2, SE3};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_pcm::Spatial;
use posecut_pcm::calibration::{NoScales, ScaleEstimate, Scales, estimate_scales};
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::generate::{Falsehood, Scenario};

/// Estimates on graphs whose covariances are wrong by two factors, relative to these factors: 1 if the estimate is right.
fn estimated<G: Spatial<DOF>, const DOF: usize>(
    wrong: Scales,
    outliers: f64,
    falsehood: Falsehood,
) -> Scales {
    let mut graph = Scenario { candidates: 2000, outliers, falsehood, seed: 4 }.draw::<G, DOF>();
    for (name, model) in &mut graph.header.noise_models {
        let factor = if name == "odometry" { wrong.odometry } else { wrong.landmark };
        model.information.iter_mut().for_each(|term| *term *= factor);
    }
    let chains = Chains::<G, DOF>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let estimate = estimate_scales(&chains, &grouped.groups).unwrap();
    if falsehood == Falsehood::Uniform && outliers <= 0.5 {
        // Correct edges lie along one line, false edges anywhere in the square, so neighbours are of the same kind.
        let correct = 1.0 - outliers;
        assert!((estimate.correct - correct).abs() < 0.06, "{} of {correct}", estimate.correct);
    }
    let Scales { odometry, landmark } = estimate.scales;
    Scales { odometry: odometry / wrong.odometry, landmark: landmark / wrong.landmark }
}

#[allow(clippy::print_stdout, reason = "a failing test shows its estimates")]
fn both_scales_are_found_among_false_edges(factors: [(f64, f64); 2]) {
    for (odometry, landmark) in factors {
        for (outliers, falsehood) in [
            (0.0, Falsehood::Uniform),
            (0.5, Falsehood::Uniform),
            (0.9, Falsehood::Uniform),
            (0.5, Falsehood::Grouped),
            (0.9, Falsehood::Grouped),
        ] {
            let wrong = Scales { odometry, landmark };
            let plane = estimated::<SE2, 3>(wrong, outliers, falsehood);
            // One pair of factors is enough in space, where an estimate takes long.
            let space = (odometry > landmark).then(|| estimated::<SE3, 6>(wrong, outliers, falsehood));
            println!("{wrong:?} {outliers} {falsehood:?}: {plane:?} {space:?}");
            for Scales { odometry, landmark } in std::iter::once(plane).chain(space) {
                assert!(
                    (0.7..1.4).contains(&odometry),
                    "{wrong:?} {outliers} {falsehood:?}: odometry {odometry}"
                );
                assert!(
                    (0.7..1.4).contains(&landmark),
                    "{wrong:?} {outliers} {falsehood:?}: landmark {landmark}"
                );
            }
        }
    }
}

#[test]
fn both_scales_of_wrong_covariances_are_found_among_false_edges() {
    both_scales_are_found_among_false_edges([(0.02, 0.02), (5.0, 0.1)]);
}

#[test]
#[ignore = "long"]
fn other_scales_of_wrong_covariances_are_found_among_false_edges() {
    both_scales_are_found_among_false_edges([(50.0, 50.0), (0.1, 5.0)]);
}

/// A separate folder for a test, with a random graph as `graph.jsonl`.
fn folder(test: &str) -> (PathBuf, PoseGraph) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    fs::create_dir_all(&folder).unwrap();
    let graph =
        Scenario { candidates: 300, outliers: 0.3, falsehood: Falsehood::Uniform, seed: 3 }.draw::<SE2, 3>();
    write(&folder.join("graph.jsonl"), &graph);
    (folder, graph)
}

fn write(path: &Path, graph: &PoseGraph) {
    let mut bytes = Vec::new();
    graph.write(&mut bytes).unwrap();
    fs::write(path, bytes).unwrap();
}

/// The graph that the program writes.
fn run(folder: &Path, input: &str, options: &[&str]) -> PoseGraph {
    let output = Command::new(env!("CARGO_BIN_EXE_posecut-pcm"))
        .args(options)
        .arg(folder.join(input))
        .arg("--stats")
        .arg(folder.join("stats.json"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    PoseGraph::read("output", &output.stdout[..]).unwrap()
}

/// The program's message when it rejects its input or options.
fn refused(folder: &Path, options: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_posecut-pcm"))
        .args(options)
        .arg(folder.join("graph.jsonl"))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    String::from_utf8(output.stderr).unwrap()
}

fn rejected(graph: &PoseGraph) -> Vec<u64> {
    graph.edges.iter().filter(|edge| edge.rejected_by.is_some()).map(|edge| edge.id).collect()
}

#[test]
fn two_factors_do_what_other_information_would() {
    let (folder, mut graph) = folder("two_factors");
    let scaled = run(&folder, "graph.jsonl", &["--scale", "0.01,0.5"]);
    for (name, model) in &mut graph.header.noise_models {
        let factor = if name == "odometry" { 0.01 } else { 0.5 };
        model.information.iter_mut().for_each(|term| *term /= factor);
    }
    write(&folder.join("other.jsonl"), &graph);
    let other = run(&folder, "other.jsonl", &[]);
    assert_eq!(rejected(&scaled), rejected(&other));
    let plain = run(&folder, "graph.jsonl", &[]);
    assert_ne!(rejected(&scaled), rejected(&plain), "the factors matter");
    let exchanged = run(&folder, "graph.jsonl", &["--scale", "0.5,0.01"]);
    assert_ne!(rejected(&scaled), rejected(&exchanged), "their order matters");
}

#[test]
fn calibrating_changes_the_information_and_no_verdict() {
    let (folder, graph) = folder("calibrate");
    let plain = run(&folder, "graph.jsonl", &[]);
    let calibrated = run(&folder, "graph.jsonl", &["--calibrate"]);
    assert_eq!(rejected(&plain), rejected(&calibrated));
    let stats: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.join("stats.json")).unwrap()).unwrap();
    for (edge, before) in calibrated.edges.iter().zip(&graph.edges) {
        assert_eq!(edge.id, before.id);
        let key = if edge.kind == EdgeKind::Odometry { "scale_odometry" } else { "scale_landmark" };
        let scale = stats[key].as_f64().unwrap();
        assert!((0.5..2.0).contains(&scale), "drawn noise is what the covariances say: {scale}");
        let (after, before) = (calibrated.information(edge).unwrap(), graph.information(before).unwrap());
        for (after, before) in after.iter().zip(before) {
            assert!((after * scale - before).abs() <= 1e-9 * before.abs(), "{after} {before} {scale}");
        }
    }
}

#[test]
fn options_of_readmission_name_the_program_that_has_them() {
    let (folder, _) = folder("moved");
    let options: [&[&str]; 4] =
        [&["--readmit"], &["--admit", "0.9"], &["--drop", "0.9"], &["--scale", "auto", "--apply-scale"]];
    for given in options {
        let message = refused(&folder, given);
        assert!(message.contains("run posecut-readmit GRAPH") && message.lines().count() == 1, "{message}");
    }
}

#[test]
fn factors_that_mean_nothing_are_refused() {
    let (folder, _) = folder("refused");
    for value in ["0", "0,1", "1,-1", "1,2,3", "inf", "1,nan", "automatic", ""] {
        let message = refused(&folder, &["--scale", value]);
        assert!(
            message.contains("ODOMETRY,LANDMARK") || message.contains("a value is required"),
            "{message}"
        );
    }
    for scale in [["--scale", "auto"], ["--scale", "2"]] {
        let message = refused(&folder, &[&scale[..], &["--test", "threshold"]].concat());
        assert!(message.contains("reads no covariances"), "{message}");
    }
    let message = refused(&folder, &["--calibrate", "--test", "threshold"]);
    assert!(message.contains("reads no covariances"), "{message}");
}

/// The estimate of the scales on a random graph.
fn estimate_of(scenario: Scenario) -> Result<ScaleEstimate, NoScales> {
    let graph = scenario.draw::<SE2, 3>();
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    estimate_scales(&chains, &grouped.groups)
}

#[test]
fn ten_edges_are_no_calibration_although_they_close_fifty_loops() {
    let scenario =
        |candidates| Scenario { candidates, outliers: 0.0, falsehood: Falsehood::Uniform, seed: 2 };
    assert_eq!(estimate_of(scenario(10)), Err(NoScales::FewEdges(10)));
    let estimate = estimate_of(scenario(30)).unwrap();
    assert_eq!(estimate.edges, 30);
    assert!(estimate.loops > 150, "{}", estimate.loops);
}

#[test]
fn sessions_without_overlap_are_no_calibration() {
    for seed in 1..=8 {
        for candidates in [40, 300] {
            let scenario = |outliers| Scenario { candidates, outliers, falsehood: Falsehood::Uniform, seed };
            let nothing = estimate_of(scenario(1.0));
            assert!(matches!(nothing, Err(NoScales::NoEvidence(_))), "{seed} {candidates}: {nothing:?}");
            let half = estimate_of(scenario(0.5)).unwrap();
            assert!(half.evidence > 20.0, "{seed} {candidates}: {half:?}");
        }
    }
}

#[test]
fn an_estimate_that_rests_on_nothing_is_declined_with_a_warning() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("declined");
    fs::create_dir_all(&folder).unwrap();
    let graph =
        Scenario { candidates: 100, outliers: 1.0, falsehood: Falsehood::Uniform, seed: 3 }.draw::<SE2, 3>();
    write(&folder.join("graph.jsonl"), &graph);
    let plain = run(&folder, "graph.jsonl", &[]);
    let scaled = run(&folder, "graph.jsonl", &["--scale", "auto"]);
    assert_eq!(rejected(&scaled), rejected(&plain), "the covariances are used unchanged");
    let output = Command::new(env!("CARGO_BIN_EXE_posecut-pcm"))
        .args(["--scale", "auto", "-o"])
        .args([folder.join("out.jsonl"), folder.join("graph.jsonl")])
        .output()
        .unwrap();
    let warning = String::from_utf8(output.stderr).unwrap();
    assert!(warning.contains("fit each other no better than edges with shuffled ends"), "{warning}");
}

/// Covariances a million million times too large: they need a factor below the smallest one that is tried.
#[test]
fn an_estimate_that_ended_at_its_floor_said_nothing() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("floor");
    fs::create_dir_all(&folder).unwrap();
    let graph =
        Scenario { candidates: 300, outliers: 0.3, falsehood: Falsehood::Uniform, seed: 3 }.draw::<SE2, 3>();
    let warned = |graph: &PoseGraph| {
        write(&folder.join("graph.jsonl"), graph);
        let output = Command::new(env!("CARGO_BIN_EXE_posecut-pcm"))
            .args(["--scale", "auto", "-o"])
            .args([folder.join("out.jsonl"), folder.join("graph.jsonl")])
            .arg("--stats")
            .arg(folder.join("stats.json"))
            .output()
            .unwrap();
        let stats = fs::read_to_string(folder.join("stats.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_str(&stats).unwrap();
        (String::from_utf8(output.stderr).unwrap(), stats["scale_ended"].as_str().unwrap().to_owned())
    };
    let (message, ended) = warned(&graph);
    assert!(!message.contains("stopped") && ended == "converged", "{ended}: {message}");
    for (factor, words, name) in [
        (3e-6, "the fit of the covariance scales stopped at the smallest factor it tries", "smallest-factor"),
        (
            1e-12,
            "no covariance scale is estimated: the fit stopped at the smallest factor it tries",
            "smallest-factor",
        ),
        (1e12, "stopped at the largest factor it tries", "largest-factor"),
    ] {
        let mut wrong = graph.clone();
        let terms = wrong.header.noise_models.iter_mut().flat_map(|(_, model)| &mut model.information);
        terms.for_each(|term| *term *= factor);
        let (message, ended) = warned(&wrong);
        assert!(message.contains(words) && ended == name, "{factor:e}: {ended}: {message}");
    }
}
