//! Tests certificates of multicuts of pose graphs: one program writes them, another one checks them.

use posecut_contract::{run, succeed};

/// Two sessions. The edges 0-3, 1-4 and 2-5 support each other; 0-6 has no support.
const POSES: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0,"session":"a","frame":0,"pose":[0,0,0]}
{"kind":"node","id":1,"session":"a","frame":1,"pose":[1,0,0]}
{"kind":"node","id":2,"session":"a","frame":2,"pose":[2,0,0]}
{"kind":"node","id":3,"session":"b","frame":0,"pose":[0,0,0]}
{"kind":"node","id":4,"session":"b","frame":1,"pose":[1,0,0]}
{"kind":"node","id":5,"session":"b","frame":2,"pose":[2,0,0]}
{"kind":"node","id":6,"session":"b","frame":3,"pose":[3,0,0]}
{"kind":"odometry","id":10,"from":0,"to":1,"measurement":[1,0,0],"information":[1,0,0,1,0,1]}
{"kind":"odometry","id":11,"from":1,"to":2,"measurement":[1,0,0],"information":[1,0,0,1,0,1]}
{"kind":"odometry","id":13,"from":3,"to":4,"measurement":[1,0,0],"information":[1,0,0,1,0,1]}
{"kind":"odometry","id":14,"from":4,"to":5,"measurement":[1,0,0],"information":[1,0,0,1,0,1]}
{"kind":"odometry","id":12,"from":5,"to":6,"measurement":[1,0,0],"information":[1,0,0,1,0,1]}
{"kind":"landmark","id":20,"from":0,"to":3,"cost":-1,"truth":{"correct":true}}
{"kind":"landmark","id":21,"from":4,"to":1,"cost":2,"truth":{"correct":true}}
{"kind":"landmark","id":22,"from":2,"to":5,"cost":3,"truth":{"correct":true}}
{"kind":"landmark","id":23,"from":0,"to":6,"cost":5,"truth":{"correct":false}}
"#;

#[test]
fn pose_graphs_have_certificates_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (graph, proof) = (path("g.jsonl"), path("g.proof"));
    std::fs::write(&graph, POSES).unwrap();
    let verified = |options: &[&str]| {
        String::from_utf8(succeed("partition", &[&["verify", &proof, &graph], options].concat(), b""))
            .unwrap()
    };
    let cut = |options: &[&str]| succeed("multicut", &[&[graph.as_str()], options].concat(), b"");
    for options in [
        &[][..],
        &["--costs", "field"],
        &["--graph", "full"],
        &["--delta", "auto"],
        &["--odometry-cost", "2"],
    ] {
        let with = cut(&[options, &["--certificate", &proof]].concat());
        assert_eq!(cut(options), with, "{options:?}");
        let said = verified(options);
        assert!(said.contains("no multicut costs less\n"), "{options:?}: {said}");
    }
    cut(&["--solver", "gaec", "--certificate", &proof]);
    assert!(verified(&[]).contains("no multicut costs less\n"));
    let piped = run("partition", &["verify", &proof], POSES.as_bytes());
    assert_eq!(piped.stdout, verified(&[]).as_bytes());
    let said = verified(&["--costs", "field"]);
    assert!(!said.contains("no multicut costs less\n"), "a proof for other costs: {said}");
    let output =
        run("partition", &["verify", &proof, &graph, "--graph", "full", "--odometry-cost", "nan"], b"");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--odometry-cost"));
}
