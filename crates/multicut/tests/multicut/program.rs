//! The program from end to end. Tests in crates/contract check its certificates, because they have the program that verifies
//! them.
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A separate folder for each test.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn run(folder: &Path, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_posecut-multicut"))
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap()
}

fn succeed(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn fails(folder: &Path, arguments: &str, status: i32) -> String {
    let output = run(folder, arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(status), "{arguments}: {said}");
    said + &String::from_utf8(output.stdout).unwrap()
}

/// Asserts that the statistics contain `"key": value`.
fn holds(folder: &Path, file: &str, key: &str, value: &str) {
    let text = std::fs::read_to_string(folder.join(file)).unwrap();
    let line = format!("\"{key}\": {value}");
    assert!(text.lines().any(|found| found.trim().trim_end_matches(',') == line), "no {line} in {text}");
}

/// Two sessions; 0-3, 1-4, 2-5 support each other, 0-6 has no support.
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

/// The line with this id.
fn line<'a>(text: &'a str, id: &str) -> &'a str {
    text.lines().find(|line| line.contains(&format!("\"id\":{id},"))).unwrap()
}

#[test]
fn cost_models_and_cut_graphs() {
    let folder = folder("poses");
    std::fs::write(folder.join("g.jsonl"), POSES).unwrap();
    let support = succeed(&folder, "g.jsonl --stats s.json");
    assert!(line(&support, "20").contains("\"cost\":1"), "{support}");
    assert!(
        line(&support, "23").contains("\"cost\":-1")
            && line(&support, "23").contains("\"rejected_by\":\"multicut\"")
    );
    assert_eq!(support.matches("rejected_by").count(), 1);
    for (key, value) in [("objective", "-1.0"), ("landmarks", "3"), ("cut_edges", "1"), ("optimal", "true")] {
        holds(&folder, "s.json", key, value);
    }
    // Landmarks are numbered by their first node: 0-3, 1-4, 2-5.
    for (node, landmark) in [("0", 0), ("1", 1), ("2", 2), ("3", 0), ("4", 1), ("5", 2)] {
        assert!(line(&support, node).contains(&format!("\"landmark\":{landmark}")), "{support}");
    }
    let count = succeed(&folder, "g.jsonl --costs count");
    assert!(
        line(&count, "20").contains("\"cost\":1") && line(&count, "21").contains("\"cost\":2"),
        "{count}"
    );
    let field = succeed(&folder, "g.jsonl --costs field");
    assert!(
        line(&field, "20").contains("rejected_by") && !line(&field, "23").contains("rejected_by"),
        "{field}"
    );
    let wide = succeed(&folder, "g.jsonl --delta 2");
    assert!(!wide.contains("rejected_by"), "{wide}");
    // Odometry connects everything and outweighs the repulsive edge.
    let full = succeed(&folder, "g.jsonl --graph full --odometry-cost 2 --stats s.json");
    assert!(!full.contains("rejected_by"), "{full}");
    holds(&folder, "s.json", "landmarks", "1");
    assert!(!succeed(&folder, "g.jsonl --drop-rejected").contains("\"id\":23,"));
    let missing = POSES.replace("\"cost\":2,", "");
    std::fs::write(folder.join("m.jsonl"), missing).unwrap();
    assert!(fails(&folder, "m.jsonl --costs field", 2).contains("landmark 21: it has no \"cost\""));
    assert!(fails(&folder, "g.jsonl --graph full --odometry-cost nan", 2).contains("--odometry-cost"));
}

#[test]
fn options_of_another_program_name_it() {
    let folder = folder("moved");
    // The error comes before anything is read.
    let message = fails(&folder, "none.jsonl --format mc", 2);
    assert!(message.contains("posecut-partition solve INSTANCE"), "{message}");
    let message = fails(&folder, "none.jsonl --verify g.proof", 2);
    assert!(message.contains("posecut-partition verify g.proof INPUT"), "{message}");
}

#[test]
fn the_truth_is_not_looked_at() {
    let folder = folder("blind");
    std::fs::write(folder.join("g.jsonl"), POSES).unwrap();
    let lies = POSES.replace("\"correct\":true", "\"correct\":false");
    std::fs::write(folder.join("lies.jsonl"), &lies).unwrap();
    let records = |file: &str| {
        let text = succeed(&folder, file).replace("\"correct\":true", "\"correct\":false");
        // Skip the header, whose provenance has the digest of the input.
        text.lines().skip(1).map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(records("g.jsonl"), records("lies.jsonl"));
}

/// One session whose second half repeats the first: a closure at every `every`-th frame, and `false_ones` false ones elsewhere.
fn spaced(every: usize, false_ones: usize) -> String {
    let mut text =
        String::from("{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n");
    for id in 0..400 {
        text += &format!(
            "{{\"kind\":\"node\",\"id\":{id},\"session\":\"s\",\"frame\":{id},\"pose\":[{id},0,0]}}\n"
        );
    }
    for (count, from) in (0..200).step_by(every).enumerate() {
        text += &format!(
            "{{\"kind\":\"landmark\",\"id\":{},\"from\":{from},\"to\":{}}}\n",
            1000 + count,
            from + 200
        );
    }
    for count in 0..false_ones {
        let (from, to) = ((count * 71) % 190, 200 + (count * 37 + 93) % 190);
        text += &format!("{{\"kind\":\"landmark\",\"id\":{},\"from\":{from},\"to\":{to}}}\n", 2000 + count);
    }
    text
}

/// The standard error of the program.
fn said(folder: &Path, arguments: &str) -> String {
    let output = run(folder, arguments);
    assert!(output.status.success(), "{arguments}");
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn closures_at_every_fifth_frame_are_cut_by_delta_1_and_kept_by_delta_auto() {
    let folder = folder("spaced");
    std::fs::write(folder.join("g.jsonl"), spaced(5, 4)).unwrap();
    let warning = said(&folder, "g.jsonl --stats s.json -o out");
    assert!(
        warning.contains(
            "44 of 44 landmark edges are cut only because no other landmark edge is within 1 frame"
        ) && warning.contains("--delta auto"),
        "{warning}"
    );
    holds(&folder, "s.json", "cut_without_support", "44");
    holds(&folder, "s.json", "delta_largest", "1");
    let quiet = said(&folder, "g.jsonl --delta auto --stats s.json -o out");
    assert!(!quiet.contains("only because"), "{quiet}");
    for (key, value) in
        [("delta_smallest", "5"), ("delta_largest", "5"), ("cut_without_support", "4"), ("cut_edges", "4")]
    {
        holds(&folder, "s.json", key, value);
    }
    let text = std::fs::read_to_string(folder.join("out")).unwrap();
    assert!(text.lines().next().unwrap().contains("\"delta\":\"auto\""), "{text}");
}

#[test]
fn a_dense_overlap_has_delta_1_either_way() {
    let folder = folder("dense");
    std::fs::write(folder.join("g.jsonl"), spaced(1, 20)).unwrap();
    let records = |options: &str| {
        let text = succeed(&folder, &format!("g.jsonl --stats s.json {options}"));
        holds(&folder, "s.json", "delta_largest", "1");
        text.lines().skip(1).map(String::from).collect::<Vec<_>>()
    };
    assert_eq!(records(""), records("--delta auto"));
    assert!(!said(&folder, "g.jsonl -o out").contains("only because"));
    assert!(fails(&folder, "g.jsonl --delta often", 2).contains("expected `auto` or a number of frames"));
}
