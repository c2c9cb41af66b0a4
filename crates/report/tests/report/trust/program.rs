//! Tests the program with its files and the page.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use super::{done, filled, probabilities, sample};

#[test]
fn the_program_draws_the_diagram_and_the_page_has_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    fs::write(path("r.jsonl"), probabilities()).unwrap();
    for name in ["d.svg", "d.png"] {
        let (good, text, said) = run(&["trust", &path("r.jsonl"), "--reliability", &path(name)]);
        assert!(good && text.contains("### Calibration of probabilities, test half"), "{said}");
        assert!(fs::metadata(path(name)).unwrap().len() > 1000);
    }
    let (good, page, said) = run(&["html", "--trust", &path("r.jsonl")]);
    assert!(good, "{said}");
    assert!(page.contains("id=\"trust-reliability\"") && page.contains("\"reliability\":{\"half\":\"test\""));

    // An empty figure is not an error, because a benchmark of other methods has no probabilities.
    fs::write(path("none.jsonl"), sample("test")).unwrap();
    let (good, _, said) = run(&["trust", &path("none.jsonl"), "--reliability", &path("none.svg")]);
    assert!(good && said.contains("none.svg was not written"), "{said}");
    assert!(!Path::new(&path("none.svg")).exists());
    let (_, page, _) = run(&["html", "--trust", &path("none.jsonl")]);
    assert!(!page.contains("id=\"trust-reliability\""));
}

fn run(arguments: &[&str]) -> (bool, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_posecut-report")).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.success(), text(output.stdout), text(output.stderr))
}

#[test]
fn the_program_writes_tables_figure_and_document_and_the_page_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let hostile = "</script><img onerror=alert(1)> *{{data}}* | x";
    let mut text = sample("test") + &sample("tuning").replace("\"f ", "\"tuned ") + &filled();
    let _ = write!(text, "{}", done(("test", hostile, "a", 1), "one", 1.0, [1, 0, 0]));
    fs::write(path("r.jsonl"), &text).unwrap();
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/trust.md"), path("trust.md")).unwrap();
    let arguments = [
        "trust",
        &path("r.jsonl"),
        "--figure",
        &path("f.svg"),
        "--document",
        &path("trust.md"),
        "-o",
        &path("t.md"),
    ];
    let (good, _, said) = run(&arguments);
    assert!(good, "{said}");
    let files = ["f.svg", "trust.md", "t.md"].map(|name| fs::read(path(name)).unwrap());
    assert!(run(&arguments).0);
    assert_eq!(
        files,
        ["f.svg", "trust.md", "t.md"].map(|name| fs::read(path(name)).unwrap()),
        "the same bytes again"
    );
    assert!(String::from_utf8_lossy(&files[2]).contains("alert(1)> *{{data}}* \\| x"));
    for file in &files {
        let text = String::from_utf8_lossy(file);
        assert!(!text.contains("<img") && !text.contains("</script"), "{text}");
    }

    let (good, page, said) = run(&["html", "--trust", &path("r.jsonl")]);
    assert!(good, "{said}");
    assert!(!page.contains("<img") && page.matches("<script").count() == 2);
    let start = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let data: serde_json::Value =
        serde_json::from_str(&page[start..start + page[start..].find("</script>").unwrap()]).unwrap();
    assert_eq!(data["trust"]["families"][1]["name"], "f");
    assert_eq!(data["trust"]["methods"][0], "one");
    assert_eq!(data["trust"]["families"][1]["methods"][0]["unfinished"], 1);
    assert!(page.contains("<td>4 of 5 (1 failed)</td>"), "tables are there without scripts");
    let (_, page, _) = run(&["html", folder.path().to_str().unwrap()]);
    assert!(page.contains("There are no results of the trust benchmark"));

    let (good, _, said) = run(&["trust", &path("r.jsonl"), "--figure", &path("f.gif"), "-o", &path("n.md")]);
    assert!(!good && said.contains("f.gif") && !Path::new(&path("n.md")).exists(), "{said}");
    let (good, _, said) = run(&["trust", &path("r.jsonl"), "--document", &path("r.jsonl")]);
    assert!(!good && said.contains("would overwrite the other"), "{said}");
    fs::write(path("other.md"), "no markers\n").unwrap();
    let (good, _, said) = run(&["trust", &path("r.jsonl"), "--document", &path("other.md")]);
    assert!(!good && said.contains("has no line <!-- begin: answer -->"), "{said}");
    fs::write(path("half.jsonl"), sample("tuning")).unwrap();
    let (good, _, said) = run(&["trust", &path("half.jsonl")]);
    assert!(!good && said.contains("no run of the test half"), "{said}");
    assert!(run(&["trust", &path("half.jsonl"), "--half", "tuning"]).0);
}
