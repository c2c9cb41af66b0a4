//! Tests the re-admission pipeline, a script around two stages.

use std::process::Command;

use posecut_contract::{program, workspace};

/// Two chains of four steps with a gap between them. The first has a loop; one edge without support crosses the gap.
fn with_a_gap() -> String {
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for id in 0..10 {
        text += &format!("{{\"kind\":\"node\",\"id\":{id},\"session\":\"a\",\"frame\":{id}}}\n");
    }
    let information = "[100,0,0,100,0,400]";
    for from in (0..9).filter(|from| *from != 4) {
        text += &format!(
            "{{\"kind\":\"odometry\",\"id\":{from},\"from\":{from},\"to\":{},\"measurement\":[1,0,1.5707963267948966],\"information\":{information}}}\n",
            from + 1
        );
    }
    for (id, from, to, rejected) in [(20, 0, 4, ""), (21, 1, 7, ",\"rejected_by\":\"pcm\"")] {
        text += &format!(
            "{{\"kind\":\"landmark\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[0,0,0],\"information\":{information}{rejected}}}\n"
        );
    }
    text
}

#[test]
fn edges_over_a_gap_that_nothing_predicts_stay_rejected() {
    let folder = std::env::temp_dir().join(format!("posecut-readmission-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (graph, output) = (folder.join("graph.jsonl"), folder.join("output.jsonl"));
    std::fs::write(&graph, with_a_gap()).unwrap();
    let done = Command::new(workspace().join("pipelines/readmission.sh"))
        .args(["--pcm".as_ref(), program("pcm").as_os_str()])
        .args(["--readmit".as_ref(), program("readmit").as_os_str()])
        .args(["--optimize".as_ref(), program("optimize").as_os_str()])
        .args([&graph, &output])
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let text = std::fs::read_to_string(&output).unwrap();
    let of =
        |id: u64| text.lines().find(|line| line.contains(&format!("\"landmark\",\"id\":{id},"))).unwrap();
    assert!(of(21).contains("\"rejected_by\":\"pcm\""), "{}", of(21));
    assert!(!of(20).contains("rejected_by"), "{}", of(20));
    std::fs::remove_dir_all(&folder).unwrap();
}
