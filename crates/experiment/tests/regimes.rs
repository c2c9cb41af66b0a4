//! Tables of the map, their intervals, and the declarations in `pipelines/`.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};

use posecut_experiment::regimes::{Interval, Samples, Section, section};
use posecut_experiment::{Experiment, Point, splice};
use serde_json::json;

fn pipelines(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines").join(name)
}

#[test]
fn intervals_agree_with_the_t_table() {
    // 1 to 5: s = 1.5811, t(4, 0.975) = 2.7764, half width 2.7764 * 1.5811 / sqrt(5) = 1.9632.
    let found = Interval::of(&[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
    assert_eq!((found.mean, found.count), (3.0, 5));
    assert!((found.half_width.unwrap() - 1.9632).abs() < 1e-3, "{found:?}");
    assert_eq!(Interval::of(&[7.0]).unwrap().half_width, None);
    assert_eq!(Interval::of(&[]), None);
}

/// PCM errs by `alone`, PCM+GC by `both`, a little more with each seed.
fn samples(rows: &[(&str, f64, f64)]) -> Samples {
    let mut text = String::new();
    for (scale, alone, both) in rows {
        for seed in 1..=4 {
            for (method, rmse) in [("pcm", alone), ("pcm+gc", both)] {
                let labels = json!({"pipeline":"regimes","session":"one","seed":seed,"method":method,
                    "incorrect_kind":"uniform","incorrect_rate":"0.1","covariance_scale":scale});
                let edges =
                    json!({"true_positive":9,"false_positive":1,"false_negative":3,"true_negative":2});
                let line = json!({"labels":labels,"rmse":rmse + 0.1 * f64::from(seed),"edges":edges});
                text.push_str(&line.to_string());
                text.push('\n');
            }
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("results.jsonl");
    std::fs::write(&path, text).unwrap();
    Samples::read(&[path]).unwrap()
}

#[test]
fn the_verdict_is_paired_and_columns_ascend() {
    let found = samples(&[("30", 50.0, 2.0), ("3", 2.0, 2.0), ("0.3", 1.0, 6.0)]);
    let text = section(&found, Section::Verdict);
    assert!(
        text.contains("| incorrect edges | covariance × 0.3 | covariance × 3 | covariance × 30 |"),
        "{text}"
    );
    assert!(text.contains("| 10 % | costs -5.0 ± 0.0 | 0.0 ± 0.0 | **helps** 48 ± 0.0 |"), "{text}");
    let text = section(&found, Section::Uniform);
    // 50.25 and the spread of four seeds: s = 0.1291, t(3, 0.975) = 3.1824.
    assert!(text.contains("| × 30 | 10 % | – | 50 ± 0.2 | – | – | 2.2 ± 0.2 |"), "{text}");
}

#[test]
fn tables_stand_between_their_markers() {
    let document = "before\n<!-- begin: a -->\nold\n<!-- end: a -->\nafter\n";
    let once = splice(document, "a", "| new |\n").unwrap();
    assert_eq!(once, "before\n<!-- begin: a -->\n\n| new |\n\n<!-- end: a -->\nafter\n");
    assert_eq!(splice(&once, "a", "| new |\n").unwrap(), once);
    assert!(splice(document, "b", "").unwrap_err().to_string().contains("<!-- begin: b -->"));
    let document = std::fs::read_to_string(pipelines("../docs/regimes.md")).unwrap();
    for (name, _) in Section::ALL {
        splice(&document, name, "").unwrap();
    }
}

/// The point of the map with covariance times 9 and 10 % uniform mistakes is the paper's table.
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
    assert_eq!(
        (&map.sessions, filled("multicut")),
        (&paper.sessions, paper.stages["multicut"].options.clone())
    );
}
