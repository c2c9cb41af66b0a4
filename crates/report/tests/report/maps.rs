//! The maps of laser logs on the page.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;

/// Three keyframes in a corridor, each with a scan; the last one is `bend` metres off. Four candidates: one accepted, two rejected, one
/// undecided, if the graph is judged.
fn graph(bend: f64, judged: bool) -> String {
    let mut lines = vec![HEADER.to_owned()];
    for node in 0..3 {
        let side = if node == 2 { bend } else { 0.0 };
        lines.push(format!(
            r#"{{"kind":"node","id":{node},"session":"a","frame":{node},"pose":[{node},{side},0]}}"#
        ));
    }
    for edge in 0..2 {
        lines.push(format!(
            r#"{{"kind":"odometry","id":{edge},"from":{edge},"to":{},"measurement":[1,0,0],"information":[1,0,0,1,0,1]}}"#,
            edge + 1
        ));
    }
    for (edge, mark) in [
        r#","verify_verdict":"accepted","verify_reason":"supported""#,
        r#","rejected_by":"verify","verify_verdict":"rejected","verify_reason":"contradicted""#,
        r#","rejected_by":"verify","verify_verdict":"undecided""#,
        r#","rejected_by":"pcm""#,
    ]
    .into_iter()
    .enumerate()
    {
        let mark = if judged { mark } else { "" };
        lines.push(format!(
            r#"{{"kind":"landmark","id":{},"from":0,"to":2,"measurement":[2,0,0],"information":[1,0,0,1,0,1]{mark}}}"#,
            10 + edge
        ));
    }
    for node in 0..3 {
        lines.push(format!(
            r#"{{"kind":"scan","node":{node},"first_angle":-1.5707963267948966,"angle_step":1.5707963267948966,"ranges":[1,4,1]}}"#
        ));
    }
    lines.join("\n") + "\n"
}

fn errors(mean: f64) -> String {
    format!(
        r#"{{"format":"posecut-result","version":1,"labels":{{}},"rmse":null,"relations":{{"compared":17,"skipped":0,"translation_m":{{"mean":{mean},"std":0.25}},"rotation_rad":{{"mean":0.01,"std":0.02}}}}}}"#
    )
}

/// A folder as `make map` leaves it, below a temporary folder.
fn folder(root: &Path, name: &str) -> PathBuf {
    let folder = root.join(name);
    fs::create_dir(&folder).unwrap();
    for (file, content) in [
        ("graph.jsonl", graph(0.5, false)),
        ("all-candidates.jsonl", graph(2.0, false)),
        ("optimized.jsonl", graph(0.0, true)),
        ("before.errors.result.json", errors(0.125)),
        ("all-candidates.errors.result.json", errors(1.5)),
        ("errors.result.json", errors(0.0625)),
    ] {
        fs::write(folder.join(file), content).unwrap();
    }
    folder
}

/// The page of some folders, or the error message.
fn page(folders: &[&Path]) -> Result<String, String> {
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("page.html");
    let mut command = Command::new(env!("CARGO_BIN_EXE_posecut-report"));
    command.args(["html", "-q", "-o"]).arg(&file);
    for folder in folders {
        command.arg("--map").arg(folder);
    }
    let output = command.output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    if output.status.success() { Ok(fs::read_to_string(file).unwrap()) } else { Err(said) }
}

fn maps(page: &str) -> Value {
    let start = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let end = start + page[start..].find("</script>").unwrap();
    let data: Value = serde_json::from_str(&page[start..end]).unwrap();
    data["maps"].clone()
}

#[test]
fn the_page_shows_a_log_before_with_all_candidates_and_after() {
    let root = tempfile::tempdir().unwrap();
    let text = page(&[&folder(root.path(), "aces")]).unwrap();
    assert!(text.contains("; img-src data:\""), "pictures in the page itself are allowed");
    assert!(text.contains("<tr><th scope=\"row\">aces</th><td>4</td><td>1</td><td>2</td><td>1</td></tr>"));
    assert!(text.contains(
        "<th scope=\"row\">aces</th><td>17</td><td>0.125 ± 0.250 m, 0.57 ± 1.15°</td><td>1.500 ± 0.250 m, 0.57 ± 1.15°</td><td>0.062 ± 0.250 m, 0.57 ± 1.15°</td>"
    ));
    let log = &maps(&text)[0];
    assert_eq!(
        (&log["candidates"]["verdict"], &log["candidates"]["truth"]),
        (&"arur".into(), &"????".into())
    );
    assert_eq!(
        log["candidates"]["reasons"],
        serde_json::json!(["contradicted", "pcm", "supported", "verify"])
    );
    assert_eq!(log["resolution"], 0.05);
    for map in ["before", "all_candidates", "after"] {
        assert!(log[map]["picture"].as_str().unwrap().starts_with("iVBORw0KGgo"), "{map} is a PNG");
        // From the wall 1 m to the right of the first keyframe to that 4 m before the last, and half a metre more on all sides.
        let width = log[map]["size"][0].as_f64().unwrap();
        assert!((width - 7.0).abs() < 0.11, "{map}: {width} m");
    }
    let height = |map: &str| log[map]["size"][1].as_f64().unwrap();
    let differences = [height("before") - height("after"), height("all_candidates") - height("after")];
    assert!((differences[0] - 0.5).abs() < 0.06 && (differences[1] - 2.0).abs() < 0.06, "{differences:?}");
    assert!(!text.contains(root.path().to_str().unwrap()), "no path is shown");
}

#[test]
fn labels_of_candidates_are_counted_where_they_are_known() {
    let root = tempfile::tempdir().unwrap();
    let own = folder(root.path(), "robot");
    let labelled = graph(0.0, true).replace(
        r#","verify_verdict":"accepted""#,
        r#","truth":{"correct":false},"verify_verdict":"accepted""#,
    );
    fs::write(own.join("optimized.jsonl"), labelled).unwrap();
    let text = page(&[&own, &folder(root.path(), "aces")]).unwrap();
    assert!(text.contains("accepted, but incorrect</th>"));
    assert!(text.contains("<td>1</td><td><span class=\"bad\">1</span></td></tr>"));
    assert!(text.contains("<td>1</td><td><span class=\"absent\">unknown</span></td></tr>"));
}

#[test]
fn what_a_log_lacks_is_said_with_the_command_that_makes_it() {
    let root = tempfile::tempdir().unwrap();
    let own = folder(root.path(), "aces");
    for file in ["all-candidates.jsonl", "errors.result.json", "before.errors.result.json"] {
        fs::remove_file(own.join(file)).unwrap();
    }
    let text = page(&[&own]).unwrap();
    assert!(
        text.contains("There is no map of aces with all candidates in use (all-candidates.jsonl): make map")
    );
    assert!(text.contains("The errors of aces are unknown: make map LOG=FILE RELATIONS=FILE"));
    assert!(maps(&text)[0]["all_candidates"].is_null());
    // Without place recognition there are no candidates.
    for file in ["graph.jsonl", "optimized.jsonl"] {
        let all = graph(0.0, false);
        let lines = all.split_inclusive('\n').filter(|line| !line.contains("landmark"));
        fs::write(own.join(file), lines.collect::<String>()).unwrap();
    }
    let text = page(&[&own]).unwrap();
    assert!(
        text.contains("There are no candidates in aces: make map")
            && !text.contains("There is no map of aces")
    );
    // Without --map there are no maps, and errors of relations alone are no result of an experiment.
    let place = root.path().join("page.html");
    let output = Command::new(env!("CARGO_BIN_EXE_posecut-report"))
        .args(["html", "-q"])
        .arg(root.path().join("aces"))
        .arg("-o")
        .arg(&place)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = fs::read_to_string(place).unwrap();
    assert!(text.contains("There are no maps of laser logs; make map LOG=FILE makes them"));
    assert!(!text.contains("img-src"), "a page without pictures allows none");
}

#[test]
fn folders_that_are_none_are_refused_in_a_sentence() {
    let root = tempfile::tempdir().unwrap();
    let own = folder(root.path(), "aces");
    let refused = |file: &str, content: &str, sentence: &str| {
        let before = fs::read(own.join(file)).unwrap();
        fs::write(own.join(file), content).unwrap();
        let said = page(&[&own]).unwrap_err();
        assert!(said.contains(file) && said.contains(sentence), "{file}: {said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        fs::write(own.join(file), before).unwrap();
    };
    let whole = graph(0.0, true);
    let without =
        |what: &str| whole.split_inclusive('\n').filter(|line| !line.contains(what)).collect::<String>();
    refused("optimized.jsonl", &without("\"scan\""), "has no laser scans; name a folder that make map");
    refused(
        "optimized.jsonl",
        &whole.replace(r#","pose":[1,0,0]"#, ""),
        "node 1 has a scan but no pose; optimise",
    );
    let (poseless, scan) = (whole.replace(r#","pose":[1,0,0]"#, ""), "{\"kind\":\"scan\",\"node\":1");
    let poseless: String = poseless.split_inclusive('\n').filter(|line| !line.starts_with(scan)).collect();
    refused("optimized.jsonl", &poseless, "node 1 has no pose; optimise");
    refused(
        "all-candidates.jsonl",
        &whole.replace("\"pose\":[2,0,0]", "\"pose\":[1e9,0,0]"),
        "too large to draw",
    );
    refused(
        "graph.jsonl",
        &(without("\"scan\"")
            + &whole[whole.find("{\"kind\":\"scan\"").unwrap()..].replace("\"node\":2", "\"node\":7")),
        "has no such node",
    );
    refused(
        "all-candidates.jsonl",
        &format!("{HEADER}\n{{\"kind\":\"node\",\"id\":5,\"pose\":[0,0,0]}}\n"),
        "has other nodes than",
    );
    refused("errors.result.json", "{}", "is not a result; write it with posecut-evaluate --relations");
    refused("errors.result.json", &errors(1.0).replace("\"version\":1", "\"version\":2"), "evaluate again");
    for file in ["graph.jsonl", "optimized.jsonl"] {
        fs::rename(own.join(file), own.join("elsewhere")).unwrap();
        let said = page(&[&own]).unwrap_err();
        assert!(
            said.contains(&format!("aces: has no {file}, so it is no folder of maps; run make map LOG=FILE")),
            "{said}"
        );
        fs::rename(own.join("elsewhere"), own.join(file)).unwrap();
    }
    let said = page(&[&own.join("graph.jsonl")]).unwrap_err();
    assert!(said.contains("graph.jsonl: has no graph.jsonl"), "{said}");
    page(&[&own]).unwrap();
}

/// Names of folders are as foreign as names of sessions.
#[test]
fn a_hostile_name_of_a_folder_stays_text() {
    let root = tempfile::tempdir().unwrap();
    let text = page(&[&folder(root.path(), "<img src=x onerror=alert(1)> {{data}}")]).unwrap();
    assert!(!text.contains("<img") && text.contains("&lt;img src=x onerror=alert(1)&gt; {{data}}"));
}

#[test]
fn larger_sites_have_larger_cells() {
    let root = tempfile::tempdir().unwrap();
    let own = folder(root.path(), "yard");
    fs::write(own.join("all-candidates.jsonl"), graph(200.0, false)).unwrap();
    let log = maps(&page(&[&own]).unwrap())[0].clone();
    assert_eq!(log["resolution"], 0.1, "all three have the cells of the largest");
    assert!((log["after"]["size"][0].as_f64().unwrap() - 7.0).abs() < 0.21);
}
