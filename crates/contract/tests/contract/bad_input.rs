//! Tests that programs refuse impossible input with exit status 2 and a sentence that names position and remedy, and that
//! they change no file.

use posecut_contract::{run, samples};

/// The programs that read pose graphs from standard input, with the subcommand if there is one.
const READERS: &[&str] = &[
    "construct",
    "densest",
    "evaluate",
    "inspect filter",
    "inspect info",
    "isam",
    "islands",
    "multicut",
    "optimize",
    "oracle",
    "pcm",
    "ransac",
    "readmit",
    "verify",
    "voting",
];

const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;
const NODES: &str = r#"{"kind":"node","id":0,"session":"a","frame":0,"pose":[0,0,0]}
{"kind":"node","id":1,"session":"b","frame":0,"pose":[1,0,0]}"#;

/// Each error with a text that contains it and the words that the message must contain.
#[expect(clippy::too_many_lines, reason = "a list")]
fn faults() -> Vec<(&'static str, String, &'static [&'static str])> {
    let with = |rest: &str| format!("{HEADER}\n{NODES}\n{rest}\n");
    vec![
        ("empty file", String::new(), &["is empty", "starts with a header"]),
        ("blank file", "\n\n".to_owned(), &["is empty"]),
        ("no header", NODES.to_owned(), &["line 1", "kind \"node\"", "starts with"]),
        (
            "wrong version",
            HEADER.replace("\"version\":1", "\"version\":7"),
            &["line 1", "header", "\"version\"", "found 7"],
        ),
        ("wrong format", HEADER.replace("posecut", "other"), &["line 1", "\"format\"", "found \"other\""]),
        (
            "wrong dimension",
            HEADER.replace("\"dimension\":2", "\"dimension\":4"),
            &["\"dimension\"", "found 4"],
        ),
        ("second header", format!("{HEADER}\n{HEADER}\n"), &["line 2", "second header"]),
        ("cut line", format!("{HEADER}\n{{\"kind\":\"node\",\"id\":0,\"po"), &["line 2", "cut short"]),
        ("no JSON", format!("{HEADER}\nnode 0\n"), &["line 2", "not JSON"]),
        ("no kind", format!("{HEADER}\n{{\"id\":0}}\n"), &["line 2", "\"kind\""]),
        ("duplicate node", with(r#"{"kind":"node","id":1,"pose":[2,0,0]}"#), &["line 4", "node 1", "line 3"]),
        (
            "duplicate edge",
            with(
                "{\"kind\":\"landmark\",\"id\":5,\"from\":0,\"to\":1}\n{\"kind\":\"landmark\",\"id\":5,\"from\":0,\"to\":1}",
            ),
            &["line 5", "landmark 5", "line 4"],
        ),
        (
            "indefinite prior",
            with(r#"{"kind":"prior","id":5,"node":0,"measurement":[1,2],"information":[1,2,1]}"#),
            &["line 4", "prior 5", "\"information\"", "not positive semidefinite"],
        ),
        (
            "prior of neither pose nor position",
            with(r#"{"kind":"prior","id":5,"node":0,"measurement":[1,2,0,0],"information":[1,0,1]}"#),
            &["line 4", "prior 5", "\"measurement\"", "found 4"],
        ),
        (
            "dangling edge",
            with(r#"{"kind":"landmark","id":5,"from":0,"to":9}"#),
            &["line 4", "landmark 5", "\"to\"", "no node 9"],
        ),
        ("loop", with(r#"{"kind":"landmark","id":5,"from":1,"to":1}"#), &["line 4", "landmark 5", "itself"]),
        ("missing id", format!("{HEADER}\n{{\"kind\":\"node\"}}\n"), &["line 2", "\"id\"", "missing"]),
        (
            "text for a number",
            format!("{HEADER}\n{{\"kind\":\"node\",\"id\":\"x\"}}\n"),
            &["line 2", "\"id\"", "expected u64"],
        ),
        (
            "NaN",
            with(
                r#"{"kind":"landmark","id":5,"from":0,"to":1,"measurement":[NaN,0,0],"information":[1,0,0,1,0,1]}"#,
            ),
            &["line 4", "landmark 5", "\"measurement\"", "NaN"],
        ),
        (
            "infinity",
            with(
                r#"{"kind":"landmark","id":5,"from":0,"to":1,"measurement":[1e999,0,0],"information":[1,0,0,1,0,1]}"#,
            ),
            &["line 4", "landmark 5", "\"measurement\"", "finite"],
        ),
        (
            "short pose",
            format!("{HEADER}\n{{\"kind\":\"node\",\"id\":0,\"pose\":[1,2]}}\n"),
            &["line 2", "node 0", "\"pose\"", "expected 3", "found 2"],
        ),
        (
            "short information",
            with(r#"{"kind":"landmark","id":5,"from":0,"to":1,"measurement":[1,0,0],"information":[1,0,0]}"#),
            &["line 4", "\"information\"", "expected 6", "found 3"],
        ),
        (
            "indefinite information",
            with(
                r#"{"kind":"landmark","id":5,"from":0,"to":1,"measurement":[1,0,0],"information":[1,2,0,1,0,1]}"#,
            ),
            &["line 4", "landmark 5", "\"information\"", "not positive semidefinite", "-1e0"],
        ),
        (
            "no information",
            with(r#"{"kind":"landmark","id":5,"from":0,"to":1,"measurement":[1,0,0]}"#),
            &["line 4", "landmark 5", "\"information\"", "no information matrix"],
        ),
        (
            "unknown noise model",
            with(r#"{"kind":"landmark","id":5,"from":0,"to":1,"measurement":[1,0,0],"noise":"wheels"}"#),
            &["line 4", "\"noise\"", "\"wheels\""],
        ),
        (
            "odometry without measurement",
            with(r#"{"kind":"odometry","id":5,"from":0,"to":1}"#),
            &["line 4", "odometry 5", "\"measurement\""],
        ),
        (
            "twice the same field",
            format!("{HEADER}\n{{\"kind\":\"node\",\"id\":0,\"id\":1}}\n"),
            &["line 2", "\"id\"", "twice"],
        ),
        // Two kinds: other readers would use the last one.
        (
            "twice the kind",
            format!("{HEADER}\n{{\"kind\":\"node\",\"id\":0,\"kind\":7}}\n"),
            &["line 2", "\"kind\"", "twice"],
        ),
        (
            "twice the kind of a record that passes through",
            with(r#"{"kind":"gps","at":[1,2],"kind":"node"}"#),
            &["line 4", "`kind`"],
        ),
        // Other programs would read this as infinity and then write invalid JSON.
        (
            "infinity in a record that passes through",
            with(r#"{"kind":"gps","at":[1,-1e309]}"#),
            &["line 4", "finite"],
        ),
        ("cut record that passes through", format!("{HEADER}\n{{\"kind\":\"gps\",\"a\":[1"), &["line 2", "cut short"]),
        (
            "twice the same noise model",
            r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{"a":{"information":[1,0,0,1,0,1]},"a":{"information":[2,0,0,2,0,2]}}}"#.to_owned(),
            &["line 1", "\"noise_models\"", "\"a\" occurs twice"],
        ),
        (
            "twice the same truth",
            format!("{HEADER}\n{{\"kind\":\"node\",\"id\":0,\"truth\":{{\"pose\":[0,0,0],\"pose\":[1,0,0]}}}}\n"),
            &["line 2", "\"truth\"", "\"pose\" occurs twice"],
        ),
        ("no UTF-8", format!("{HEADER}\n"), &[]),
    ]
}

#[test]
fn every_reader_refuses_every_fault_with_its_place() {
    for (fault, text, expected) in faults() {
        let mut bytes = text.into_bytes();
        let mut expected = expected.to_vec();
        if fault == "no UTF-8" {
            bytes.extend(b"{\"kind\":\"n\xff\"}\n");
            expected = vec!["line 2", "not UTF-8"];
        }
        for reader in READERS {
            let (name, task) = reader.split_once(' ').unwrap_or((reader, "-"));
            let folder = tempfile::tempdir().unwrap();
            let (out, stats) = (folder.path().join("out.jsonl"), folder.path().join("stats.json"));
            std::fs::write(&out, "precious").unwrap();
            let input = if task == "-" { &["-"][..] } else { &[task, "-"] };
            let outputs = ["-o", out.to_str().unwrap(), "--stats", stats.to_str().unwrap()];
            let output = run(name, &[input, &outputs].concat(), &bytes);
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{name}, {fault}: {said}");
            assert!(
                said.starts_with(&format!("posecut-{name}: error: standard input")),
                "{name}, {fault}: {said}"
            );
            for part in &expected {
                assert!(said.contains(part), "{name}, {fault}: \"{part}\" is not in: {said}");
            }
            assert_eq!(said.lines().count(), 1, "{name}, {fault}: one sentence, not a trace: {said}");
            assert_eq!(std::fs::read_to_string(&out).unwrap(), "precious", "{name}, {fault}");
            assert!(!stats.exists(), "{name}, {fault}");
            assert_eq!(
                std::fs::read_dir(folder.path()).unwrap().count(),
                1,
                "{name}, {fault}: something was left"
            );
        }
    }
}

#[test]
fn missing_files_and_directories_are_refused() {
    for reader in READERS {
        let (name, task) = reader.split_once(' ').map_or((*reader, None), |(name, task)| (name, Some(task)));
        let at = |path| task.into_iter().chain([path]).collect::<Vec<_>>();
        let output = run(name, &at("/no/such/file.jsonl"), b"");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}: {said}");
        assert!(said.contains("/no/such/file.jsonl"), "{name}: {said}");
        let output = run(name, &at("/"), b"");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}: {said}");
        assert!(said.contains("is a directory"), "{name}: {said}");
    }
}

#[test]
fn an_unknown_session_is_refused_with_those_that_are_there() {
    let unknown = samples().path("2012-99-99");
    let output = run("ingest", &[&unknown], b"");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("no such session") && said.contains("2012-01-22"), "{said}");
}

#[test]
fn graphs_without_nodes_or_edges_have_an_answer() {
    let empty = format!("{HEADER}\n");
    for name in [
        "densest", "isam", "islands", "multicut", "optimize", "oracle", "pcm", "ransac", "readmit", "verify",
        "voting",
    ] {
        let output = run(name, &[], empty.as_bytes());
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let lone = format!("{HEADER}\n{}\n", NODES.lines().next().unwrap());
        let output = run(name, &[], lone.as_bytes());
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    }
    for (name, part) in
        [("construct", "no node of the graph has ground truth"), ("evaluate", "no node has a pose")]
    {
        let output = run(name, &[], empty.as_bytes());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{name}: {said}");
        assert!(said.contains(part), "{name}: {said}");
    }
}

#[test]
fn impossible_requests_to_construct_are_refused() {
    let session = samples().path("session.jsonl");
    let cases: &[(&[&str], &str)] = &[
        (&["--incorrect-rate", "1"], "below 1"),
        (&["--incorrect-rate", "NaN"], "--incorrect-rate"),
        (&["--radius", "0"], "--radius"),
        (&["--radius", "0.000001"], "no two viewpoints"),
        (
            &["--incorrect-rate", "0.9", "--radius", "8", "--incorrect-distance", "100000"],
            "0 of 54 (--incorrect-rate 0.9, --incorrect-kind uniform, --incorrect-distance 100000); decrease",
        ),
        (&["--split", "none"], "no two viewpoints"),
        (&[&session], "in two of the graphs"),
    ];
    for (arguments, part) in cases {
        let all: Vec<&str> = [session.as_str()].into_iter().chain(arguments.iter().copied()).collect();
        let output = run("construct", &all, b"");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(part), "{arguments:?}: {said}");
        assert!(output.stdout.is_empty());
    }
}
