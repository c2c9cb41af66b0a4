//! What a new user tries first: real graphs of other tools. Each of these gave an empty map, or no page, with exit status 0.

use std::path::PathBuf;

use serde_json::Value;

use crate::{clean, laps, only, stderr};

/// A file of the shared data.
fn shared(file: &str) -> Option<PathBuf> {
    let path = std::env::var_os("POSECUT_SHARED_DATA").map(|folder| PathBuf::from(folder).join(file));
    let found = path.filter(|path| path.exists());
    if found.is_none() {
        println!("skipped: no data: {file}");
    }
    found
}

#[test]
fn real_graphs_give_a_map_an_answer_and_a_page() {
    for (file, poses, edges, in_use) in [
        ("g2o/kitti_00.g2o", 4541, 137, 137..=137),
        ("false_closures/kitti/05/kitti_05_alpha_0.00.g2o", 2761, 317, 62..=62),
        ("false_closures/bicocca25b/B25b_0.000.g2o", 8358, 446, 200..=230),
    ] {
        let Some(path) = shared(file) else { continue };
        let folder = tempfile::tempdir().unwrap();
        let arguments = ["-o", "out.g2o", "--page", "page.html", "--stats", "stats.json"];
        let output = clean(folder.path(), &[&[path.to_str().unwrap()][..], &arguments].concat());
        assert_eq!(output.status.code(), Some(0), "{file}: {}", stderr(&output));
        let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
        assert_eq!(read("out.g2o").matches("VERTEX_SE").count(), poses, "{file}");
        let stats: Value = serde_json::from_str(&read("stats.json")).unwrap();
        assert_eq!(stats["landmark_edges"], edges, "{file}");
        assert!(in_use.contains(&stats["in_use"].as_u64().unwrap()), "{file}: {stats}");
        assert!(stats["cost"].as_f64().unwrap() > 0.0 && stats["converged"] == true, "{file}: {stats}");
        assert!(read("page.html").contains("</html>"), "{file}");
    }
}

#[test]
fn a_graph_without_vertices_gets_the_poses_of_all_its_edges() {
    let folder = tempfile::tempdir().unwrap();
    let edges = only(&laps(&[]), |line| line.starts_with("EDGE"));
    std::fs::write(folder.path().join("map.g2o"), edges).unwrap();
    let output = clean(folder.path(), &["map.g2o", "-o", "out.g2o"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("poses      computed"), "{said}");
    let text = std::fs::read_to_string(folder.path().join("out.g2o")).unwrap();
    assert_eq!(text.matches("VERTEX_SE2").count(), 120);
}

/// A graph of which nothing remains is no success.
#[test]
fn an_empty_map_is_never_a_success() {
    let folder = tempfile::tempdir().unwrap();
    let vertices = "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\n";
    let header = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n";
    for (name, text) in [
        ("nothing.g2o", ""),
        ("comment.g2o", "# nothing\n"),
        ("vertices.g2o", vertices),
        ("header.jsonl", header),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
        let output = clean(folder.path(), &[name, "-o", "out", "--page", "page.html"]);
        let said = stderr(&output);
        assert!(matches!(output.status.code(), Some(2 | 3)), "{name}: {said}");
        assert!(said.contains("error: ") || said.contains("warning: "), "{name}: {said}");
    }
}
