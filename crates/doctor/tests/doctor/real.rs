//! Public benchmarks: what is known to be wrong with them is found.

use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

/// The errors and warnings of a file of the shared data, by name.
fn problems(file: &str, arguments: &[&str]) -> Option<Vec<String>> {
    let path = std::env::var_os("POSECUT_SHARED_DATA").map(|folder| PathBuf::from(folder).join(file));
    let Some(path) = path.filter(|path| path.exists()) else {
        println!("skipped: no data: {file}");
        return None;
    };
    let folder = tempfile::tempdir().unwrap();
    let stats = folder.path().join("stats.json");
    let output = Command::new(env!("CARGO_BIN_EXE_posecut-doctor"))
        .arg(path)
        .args(arguments)
        .arg("--stats")
        .arg(&stats)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let stats: Value = serde_json::from_slice(&std::fs::read(stats).unwrap()).unwrap();
    let findings = stats["findings"].as_array().unwrap();
    let bad = findings.iter().filter(|finding| finding["severity"] != "note");
    Some(bad.map(|finding| finding["name"].as_str().unwrap().to_owned()).collect())
}

#[test]
fn benchmarks_have_their_known_faults() {
    for (file, expected) in [
        (
            "g2o/kitti_00.g2o",
            &["shared-information", "repeated-landmark-edges", "spacing", "calibration"][..],
        ),
        ("false_closures/bicocca25b/B25b_0.300.g2o", &["spacing", "coherent-odometry"]),
        ("g2o/city10000.g2o", &["calibration"]),
        ("g2o/sphere2500.g2o", &["calibration"]),
        ("g2o/MIT.g2o", &[]),
        ("g2o/smallGrid3D.g2o", &[]),
        ("g2o/manhattanOlson3500.g2o", &["placeholder", "repeated-landmark-edges", "calibration"]),
        (
            "false_closures/kitti/05/kitti_05_alpha_0.00.g2o",
            &["partly-without-geometry", "shared-information", "spacing", "calibration"],
        ),
        ("false_closures/kitti/05/kitti_05_GT.g2o", &["no-landmark-edges", "odometry-placeholder"]),
    ] {
        if let Some(found) = problems(file, &[]) {
            assert_eq!(found, expected, "{file}");
        }
    }
}

#[test]
fn a_graph_with_repaired_matrices_is_examined() {
    if let Some(found) = problems("g2o/cubicle.g2o", &["--repair-information"]) {
        for name in ["doubt", "odometry-gaps", "singular-information"] {
            assert!(found.iter().any(|found| found == name), "{found:?}");
        }
    }
}
