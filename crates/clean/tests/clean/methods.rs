//! Other methods than verification.

use crate::{clean, landmark_edges, laps, stderr};

#[test]
fn without_a_method_all_edges_stay() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.g2o"), laps(&[(3, 18)])).unwrap();
    let output = clean(folder.path(), &["map.g2o", "--method", "none"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(landmark_edges(&String::from_utf8(output.stdout).unwrap()).len(), 41);
}

/// A script that can be run, copied by another process: the system refuses to run a file that a child of another test still has
/// open for writing.
#[cfg(unix)]
fn script(folder: &std::path::Path, name: &str, body: &str) {
    let text = folder.join("script");
    std::fs::write(&text, format!("#!/bin/sh\n{body}\n")).unwrap();
    let mut install = std::process::Command::new("install");
    assert!(install.args(["-m", "755"]).args([text, folder.join(name)]).status().unwrap().success());
}

#[cfg(unix)]
#[test]
fn a_program_of_the_users_own_can_judge() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.g2o"), laps(&[(3, 18)])).unwrap();
    script(
        folder.path(),
        "mine",
        r#"[ "$1" = --far ] && sed '/"from":3,"to":18/s/}$/,"rejected_by":"mine"}/'"#,
    );
    let output = clean(folder.path(), &["map.g2o", "--method", "./mine --far"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("rejected   1 (1 mine)"), "{said}");
    assert_eq!(landmark_edges(&String::from_utf8(output.stdout).unwrap()).len(), 40);
}

#[cfg(unix)]
#[test]
fn a_program_that_fails_or_removes_edges_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.g2o"), laps(&[])).unwrap();
    script(folder.path(), "fails", "exit 7");
    script(folder.path(), "removes", "sed '$d'");
    for (method, sentence) in [
        ("./fails", "./fails: failed with exit status: 7"),
        ("./removes", "other nodes or edges than its input"),
    ] {
        let output = clean(folder.path(), &["map.g2o", "-o", "out.g2o", "--method", method]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(sentence), "{}", stderr(&output));
        assert!(!folder.path().join("out.g2o").exists());
    }
}
