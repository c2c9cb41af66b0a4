//! Tests the declarations of the trust benchmark.

use std::path::{Path, PathBuf};

use posecut_experiment::{Experiment, Source, members};

fn declarations() -> Vec<Experiment> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines/trust");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let files = files.iter().filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    let all: Vec<Experiment> = files.map(|path| Experiment::read(path).unwrap()).collect();
    // Skip base declarations: they have no family.
    all.into_iter().filter(|experiment| experiment.family.is_some()).collect()
}

/// Every session belongs to one half; graphs need the data.
#[test]
fn no_family_mixes_tuning_and_test() {
    let data = std::env::var_os("POSECUT_SHARED_DATA").map(PathBuf::from).filter(|data| data.is_dir());
    if data.is_none() {
        println!("skipped: no data: g2o, false_closures (sessions are checked)");
    }
    let experiments = declarations();
    assert!(experiments.len() >= 12);
    for experiment in experiments {
        let name = &experiment.name;
        let halves = experiment.halves.as_ref().unwrap_or_else(|| panic!("{name} has no [halves]"));
        for session in &experiment.sessions {
            halves.of(session).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
        if experiment.graphs.is_empty() || data.is_some() {
            let source = Source {
                nclt: None,
                data: data.clone(),
                half: None,
                simulated: PathBuf::from("simulated"),
                results: PathBuf::from("results"),
            };
            let halves = members(&experiment, &source).unwrap_or_else(|error| panic!("{name}: {error:#}"));
            if data.is_some() {
                for half in ["tuning", "test"] {
                    assert!(halves.iter().any(|(_, found)| *found == half), "{name} has no {half} half");
                }
            }
        }
    }
}

/// Every family runs every method; a missing one could not be compared.
#[test]
fn every_family_runs_every_method_with_a_limit() {
    let experiments = declarations();
    for experiment in &experiments {
        assert_eq!(experiment.methods, experiments[0].methods, "{}", experiment.name);
        assert_eq!(experiment.cpu_limit, Some(60), "{}", experiment.name);
        assert!(experiment.grids.iter().all(|grid| grid.methods.is_none()), "{}", experiment.name);
    }
}
