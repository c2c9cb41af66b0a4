//! Tests the declarations in `pipelines/`.

use std::path::{Path, PathBuf};

use posecut_experiment::{Experiment, Point};

fn pipelines(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines").join(name)
}

/// The map contains the paper's table as the point with covariance times 9 and 10 % uniform mistakes.
#[test]
fn the_published_table_is_a_point_of_the_map() {
    let map = Experiment::read(&pipelines("regimes.toml")).unwrap();
    let paper = Experiment::read(&pipelines("paper.toml")).unwrap();
    let points: Vec<Point> = map.grids.iter().flat_map(|grid| Point::all(&map, grid)).collect();
    let point = points.iter().find(|point| {
        let value = |name: &str| point.0[name].as_str();
        (value("covariance_scale"), value("incorrect_rate"), value("incorrect_kind"))
            == ("9", "0.1", "uniform")
    });
    let point = point.unwrap();
    let filled = |step: &str| point.fill(&map, &map.stages[step].options).unwrap();
    assert_eq!(filled("ingest"), paper.stages["ingest"].options);
    let construct: Vec<String> = filled("construct");
    let without: Vec<&String> =
        construct.iter().filter(|word| !["--incorrect-kind", "uniform"].contains(&word.as_str())).collect();
    assert_eq!(without, paper.stages["construct"].options.iter().collect::<Vec<_>>());
    assert!(filled("pcm").starts_with(&paper.stages["pcm"].options));
    assert_eq!(filled("multicut"), paper.stages["multicut"].options);
    assert!(paper.sessions.iter().all(|session| map.sessions.contains(session)), "{:?}", map.sessions);
}
