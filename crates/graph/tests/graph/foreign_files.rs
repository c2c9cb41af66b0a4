//! Files of other tools are refused with the command that converts them.

use posecut_graph::PoseGraph;

fn refused(name: &str, bytes: &[u8]) -> String {
    PoseGraph::read(name, bytes).unwrap_err().to_string()
}

#[test]
fn the_remedy_is_the_command_that_converts_the_file() {
    for (text, expected) in [
        (
            "VERTEX_SE2 0 0 0 0\n",
            "line 1: this is a g2o graph, not pose-graph JSON Lines; convert it first: posecut convert map.txt --to jsonl",
        ),
        ("\u{feff}EDGE_SE3:QUAT 0 1\n", "line 1: this is a g2o graph"),
        ("VERTEX2 0 0 0 0\n", "line 1: this is a TORO graph"),
        ("{\"name\":\"x\",\"robots\":[97]}\n", "line 1: this is a JRL file"),
        ("0.5 0 0 0 0 0 0 1\n", "line 1: this is a TUM trajectory"),
        ("1 0 0 0 0 1 0 0 0 0 1 0\n", "line 1: this is a KITTI trajectory"),
        ("PK\u{3}\u{4}", "line 1: this is a zip archive, not pose-graph JSON Lines; unpack it"),
        ("{\"id\":0}\n", "field \"kind\": the record has no kind"),
        (
            "# a comment\n",
            "line 1: the line is a comment, which JSON Lines does not have; convert other formats first: posecut convert map.txt --to jsonl",
        ),
    ] {
        let said = refused("map.txt", text.as_bytes());
        assert!(said.starts_with("map.txt, ") && said.contains(expected), "{text}: {said}");
    }
    assert!(refused("x", b"\xa5dname").contains("this is CBOR"));
    // The name of standard input is no file.
    assert!(refused("standard input", b"FIX 0\n").ends_with("posecut convert FILE --to jsonl"));
}

/// A JRL dataset is one line. It used to be refused for its length.
#[test]
fn a_long_dataset_is_recognised() {
    let long = format!("{{\"groundtruth\":{{\"a\":[{}]}}}}", "1,".repeat(9 << 20));
    assert!(refused("a.jrl", long.as_bytes()).contains("line 1: this is a JRL file"), "one line of 18 MiB");
    let long = format!("{{\"else\":{{\"a\":[{}]}}}}", "1,".repeat(9 << 20));
    assert!(refused("a.jrl", long.as_bytes()).contains("16 MiB"));
}
