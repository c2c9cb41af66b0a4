//! Compares the page with the results and graphs that it was made of.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use posecut_evaluate::{Options, evaluate};
use posecut_graph::PoseGraph;
use posecut_view::encode::decoded;
use serde_json::Value;

/// Runs the program, and returns its success and its standard error.
fn run(arguments: &[&str]) -> (bool, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_posecut-report")).args(arguments).output().unwrap();
    (output.status.success(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn page(arguments: &[&str], folder: &Path) -> String {
    let file = folder.join("page.html");
    let (done, said) = run(&[&["html"], arguments, &["-q", "-o", file.to_str().unwrap()]].concat());
    assert!(done, "{said}");
    fs::read_to_string(file).unwrap()
}

/// The data in a page, as the page's script reads it.
fn data(page: &str) -> Value {
    let start = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let end = start + page[start..].find("</script>").unwrap();
    serde_json::from_str(&page[start..end]).unwrap()
}

/// Two passes along a line, nodes 0 to 9 and 10 to 19, with three correct edges and one incorrect one. At its end the
/// second pass is `bend` metres off.
fn graph(bend: f64, kept: bool, history: &str) -> PoseGraph {
    let mut text = format!(
        r#"{{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{{"odometry":{{"information":[100,0,0,100,0,400]}}}},"provenance":[{history}]}}"#
    );
    for id in 0..20_i32 {
        let (along, pass) = (id % 10, id / 10);
        let off = if pass == 1 { bend * f64::from(along) / 9.0 } else { 0.0 };
        let session = if pass == 0 { "s/a" } else { "s/b" };
        let _ = write!(
            text,
            "\n{{\"kind\":\"node\",\"id\":{id},\"session\":\"{session}\",\"frame\":{id},\"utime\":{},\"pose\":[{},{off},0],\"truth\":{{\"pose\":[{},3,0]}},\"landmark\":{}}}",
            i64::from(id) * 2_000_000,
            2 * along,
            2 * along,
            if along < 3 { along } else { id }
        );
    }
    for (edge, from) in (0..19_u32).filter(|from| *from != 9).enumerate() {
        let _ = write!(
            text,
            "\n{{\"kind\":\"odometry\",\"id\":{edge},\"from\":{from},\"to\":{},\"measurement\":[2,0,0],\"noise\":\"odometry\"}}",
            from + 1
        );
    }
    for (edge, (from, to)) in [(0, 10), (1, 11), (2, 12), (1, 18)].into_iter().enumerate() {
        let (correct, mark) =
            if edge < 3 { (true, "") } else { (false, if kept { "" } else { ",\"rejected_by\":\"pcm\"" }) };
        let _ = write!(
            text,
            "\n{{\"kind\":\"landmark\",\"id\":{},\"from\":{from},\"to\":{to},\"measurement\":[0,0,0],\"noise\":\"odometry\",\"truth\":{{\"correct\":{correct}}}{mark}}}",
            100 + edge
        );
    }
    text.push('\n');
    PoseGraph::read("test", text.as_bytes()).unwrap()
}

const PCM: &str = r#"{"stage":"pcm","version":"9.9.9","arguments":{"test":"mahalanobis","probability":0.99},"seed":null,"inputs":[]}"#;

/// Writes the graph of a method and its result, and returns its RMSE.
fn store(folder: &Path, labels: [&str; 3], method: &str, graph: &PoseGraph, reference: &PoseGraph) -> f64 {
    let [pipeline, session, seed] = labels;
    let mut bytes = Vec::new();
    graph.write(&mut bytes).unwrap();
    fs::write(folder.join(format!("{method}.optimized.jsonl")), bytes).unwrap();
    let options = Options {
        align: None,
        scope: posecut_evaluate::result::Scope::Joint,
        rpe_delta: 1,
        labels: [("pipeline", pipeline), ("session", session), ("seed", seed), ("method", method)]
            .map(|(name, value)| format!("{name}={value}"))
            .to_vec(),
    };
    let result = evaluate(graph, Some(reference), &options).unwrap();
    fs::write(folder.join(format!("{method}.result.json")), serde_json::to_vec(&result).unwrap()).unwrap();
    result.rmse.unwrap()
}

fn experiment(folder: &Path, labels: [&str; 3]) -> [f64; 2] {
    let reference = graph(0.0, false, "");
    let mut bytes = Vec::new();
    reference.write(&mut bytes).unwrap();
    fs::write(folder.join("oracle.optimized.jsonl"), bytes).unwrap();
    [
        store(folder, labels, "none", &graph(40.0, true, ""), &reference),
        store(folder, labels, "pcm", &graph(3.0, false, PCM), &reference),
    ]
}

#[test]
fn numbers_in_the_page_are_those_of_the_results() {
    let folder = tempfile::tempdir().unwrap();
    let [none, pcm] = experiment(folder.path(), ["paper", "s", "1"]);
    let text = page(&[folder.path().to_str().unwrap()], folder.path());
    let data = data(&text);
    let own = &data["experiments"][0];
    assert_eq!(own["spread"][0]["rmse"][0][1].as_f64(), Some(none), "unrounded");
    assert_eq!(own["spread"][1]["rmse"][0][1].as_f64(), Some(pcm), "unrounded");
    assert!(text.contains(&format!("<td>{none:.1}</td>")) && text.contains(&format!("<td>{pcm:.2}</td>")));
    let seed = &own["sessions"][0]["seeds"][0];
    for (method, rmse) in seed["methods"].as_array().unwrap().iter().zip([none, pcm]) {
        assert_eq!(method["rmse"].as_f64(), Some(rmse));
        let errors = decoded(method["error"].as_str().unwrap(), 0.01).unwrap();
        let drawn = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
        assert!((drawn - rmse).abs() < 0.01, "{drawn} {rmse}");
    }
    assert_eq!(
        (seed["methods"][0]["state"].as_str(), seed["methods"][1]["state"].as_str()),
        (Some("++++"), Some("+++a"))
    );
    assert_eq!(seed["edges"]["truth"], "tttf");
    assert_eq!(seed["methods"][1]["stages"][0], "pcm");
    assert_eq!(seed["methods"][0]["landmarks"], serde_json::json!([[0, 10], [1, 11], [2, 12]]));
    // East is to the right: the route runs north, 3 m east, in whatever frame the optimised graph was.
    let right = decoded(seed["reference"]["right"].as_str().unwrap(), 0.1).unwrap();
    let up = decoded(seed["reference"]["up"].as_str().unwrap(), 0.1).unwrap();
    assert!(right.iter().all(|east| (east - 3.0).abs() < 0.06) && (up[9] - 18.0).abs() < 0.06);
    let matrix = &seed["consistency"];
    assert_eq!(matrix["edges"].as_array().unwrap().len(), 4);
    assert_eq!(matrix["gate"], "11.34");
    // Edges in the order 0-10, 1-11, 1-18, 2-12: all except the third are in the clique.
    assert_eq!(matrix["clique"], "Cw==");
}

#[test]
fn the_same_inputs_give_the_same_bytes_in_any_order_and_no_path_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let (one, two) = (folder.path().join("one"), folder.path().join("two"));
    fs::create_dir_all(&one).unwrap();
    fs::create_dir_all(&two).unwrap();
    experiment(&one, ["paper", "s", "1"]);
    experiment(&two, ["paper", "s", "2"]);
    let (one, two) = (one.to_str().unwrap(), two.to_str().unwrap());
    let first = page(&[one, two], folder.path());
    assert!(
        first == page(&[two, one], folder.path())
            && first == page(&[one, two, "--threads", "1"], folder.path())
    );
    assert!(!first.contains(folder.path().to_str().unwrap()));
    for address in ["http://", "https://", "src=", "url(", "@import"] {
        let own = first.replace("http://www.w3.org/2000/svg", "");
        assert!(!own.contains(address), "{address}: the page asks nobody for anything");
    }
}

/// Session names and labels come from files of unknown origin, so the page must not trust them.
#[test]
fn hostile_names_stay_text() {
    let folder = tempfile::tempdir().unwrap();
    let hostile = "</script><script>alert('1')</script><!--\u{2028}\"><img onerror=alert(1)> {{data}}";
    experiment(folder.path(), [hostile, hostile, "1"]);
    let text =
        page(&[folder.path().to_str().unwrap(), "--title", hostile, "--missing", hostile], folder.path());
    assert_eq!(text.matches("<script").count(), 2, "the data and the page's own");
    assert_eq!(text.matches("</script").count(), 2);
    assert!(!text.contains("<img"));
    assert_eq!(data(&text)["experiments"][0]["name"], hostile);
    assert_eq!(data(&text)["experiments"][0]["sessions"][0]["name"], hostile);
}

#[test]
fn the_page_reports_what_is_missing_in_sentences() {
    let folder = tempfile::tempdir().unwrap();
    experiment(folder.path(), ["paper", "s", "1"]);
    for name in ["none", "pcm", "oracle"] {
        fs::remove_file(folder.path().join(format!("{name}.optimized.jsonl"))).unwrap();
    }
    let text = page(&[folder.path().to_str().unwrap(), "--missing", "t"], folder.path());
    for sentence in [
        "Requested sessions without data: t.",
        "there are no optimised graphs beside the results",
        "there is no reference beside the results",
        "PCM has processed none of the graphs beside the results.",
        "The multicut has processed none of the graphs beside the results.",
        "There are no results over regimes",
    ] {
        assert!(text.contains(sentence), "{sentence}");
    }
    let empty = tempfile::tempdir().unwrap();
    let text = page(&[empty.path().to_str().unwrap()], folder.path());
    assert!(text.contains("There are no results."));
    let (done, said) = run(&["html", folder.path().join("nothing").to_str().unwrap(), "-o", "/dev/null"]);
    assert!(!done && said.contains("nothing: cannot be opened"), "{said}");
}

#[test]
fn a_graph_that_is_not_the_one_evaluated_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    experiment(folder.path(), ["paper", "s", "1"]);
    let mut bytes = Vec::new();
    graph(7.0, false, PCM).write(&mut bytes).unwrap();
    fs::write(folder.path().join("pcm.optimized.jsonl"), bytes).unwrap();
    let (done, said) = run(&[
        "html",
        folder.path().to_str().unwrap(),
        "-o",
        folder.path().join("page.html").to_str().unwrap(),
    ]);
    assert!(done && said.contains("paper/s/1/pcm: the RMSE of the graph is"), "{said}");
}

#[test]
fn figures_are_drawn_of_the_same_graphs_and_refuse_others_in_sentences() {
    let folder = tempfile::tempdir().unwrap();
    experiment(folder.path(), ["paper", "s", "1"]);
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let named = |name: &str| format!("{name}={}", path(&format!("{name}.optimized.jsonl")));
    let reference = path("oracle.optimized.jsonl");
    for (task, arguments, text) in [
        ("consistency", vec![named("pcm")], "4 candidates, 3 kept; 1 incorrect, 0 of them kept"),
        ("components", vec![named("pcm")], "incorrect (1)"),
        (
            "error",
            vec![named("none"), named("pcm"), "--reference".to_owned(), reference.clone()],
            "none (RMSE ",
        ),
        (
            "graphs",
            vec![named("pcm"), "--reference".to_owned(), reference.clone()],
            "incorrect, rejected (1)",
        ),
    ] {
        let mut drawings = Vec::new();
        for name in ["one.svg", "two.svg"] {
            let file = path(name);
            let mut all: Vec<&str> = vec![task];
            all.extend(arguments.iter().map(String::as_str));
            all.extend(["-o", &file]);
            let (done, said) = run(&all);
            assert!(done, "{task}: {said}");
            drawings.push(fs::read_to_string(file).unwrap());
        }
        assert!(drawings[0].contains(text), "{task}: {text} is missing");
        assert!(drawings[0] == drawings[1], "{task}: the same bytes each time");
    }
    let svg = path("x.svg");
    let (_, said) = run(&["consistency", &named("none"), "-o", &svg]);
    assert!(said.contains("PCM has not processed this graph; name the output of posecut-pcm"), "{said}");
    let (_, said) = run(&["error", &named("pcm"), "--reference", &reference]);
    assert!(said.contains("a figure needs a file"), "{said}");
    let (_, said) = run(&["regimes", &path("pcm.result.json"), "-o", &svg]);
    assert!(said.contains("has no label covariance_scale"), "{said}");
}
