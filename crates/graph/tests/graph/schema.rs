//! The schema and the reader agree, as far as a schema of single lines can express the rules.

use jsonschema::Validator;
use posecut_graph::{PoseGraph, schema};
use serde_json::Value;

fn whole() -> Validator {
    jsonschema::validator_for(&schema()).unwrap()
}

/// The schema of the lines of one dimension.
fn of(name: &str) -> Validator {
    let mut schema = schema();
    schema.as_object_mut().unwrap().remove("anyOf");
    schema["$ref"] = format!("#/$defs/{name}").into();
    jsonschema::validator_for(&schema).unwrap()
}

const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{"wheels":{"information":[1,0,0,1,0,1]}}}"#;
const NODES: &str = "{\"kind\":\"node\",\"id\":0}\n{\"kind\":\"node\",\"id\":1}";

/// Whether the reader accepts a line at its position in a file.
fn read(line: &str) -> bool {
    let text =
        if line.contains("\"header\"") { line.to_owned() } else { format!("{HEADER}\n{NODES}\n{line}\n") };
    PoseGraph::read("test", text.as_bytes()).is_ok()
}

fn parsed(line: &str) -> Value {
    serde_json::from_str(line).unwrap()
}

#[test]
fn it_is_a_schema_of_the_draft_it_names() {
    assert!(jsonschema::meta::is_valid(&schema()));
}

#[test]
fn both_take_what_is_sound() {
    let (schema, plane) = (whole(), of("plane"));
    for line in [
        HEADER,
        r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"provenance":null,"noise_models":null,"x":1}"#,
        r#"{"kind":"node","id":18446744073709551615,"frame":-9223372036854775808,"utime":null,"pose":null,"truth":{"pose":null,"x":[]}}"#,
        r#"{"kind":"node","id":7,"session":"a","pose":[1,2.5,-3e-9],"landmark":0,"mood":"fine"}"#,
        r#"{"kind":"odometry","id":0,"from":0,"to":1,"measurement":[1,0,0],"noise":"wheels","information":null}"#,
        r#"{"kind":"landmark","id":0,"from":1,"to":0}"#,
        r#"{"kind":"landmark","id":0,"from":1,"to":0,"information":[1,0,0,1,0,1]}"#,
        r#"{"kind":"landmark","id":0,"from":1,"to":0,"rejected_by":"pcm","cost":-1,"score":0.25,"truth":{"correct":true}}"#,
        r#"{"kind":"gps","at":[1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2,0.5],"information":[1,0,0,1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2,0.5],"noise":"wheels","information":null}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2],"information":[1,0,1],"noise":null,"source":"gps","score":1,"rejected_by":null,"truth":{"correct":false},"sats":7}"#,
    ] {
        assert!(read(line), "the reader refuses {line}");
        assert!(schema.is_valid(&parsed(line)), "the schema refuses {line}");
        assert!(plane.is_valid(&parsed(line)), "the schema of the plane refuses {line}");
    }
}

/// Tries one counterexample for each rule that concerns one line.
#[test]
fn both_refuse_what_is_not() {
    let (schema, plane) = (whole(), of("plane"));
    for line in [
        r#"{"kind":"header","format":"other","version":1,"dimension":2}"#,
        r#"{"kind":"header","version":1,"dimension":2}"#,
        r#"{"kind":"header","format":"posecut","version":2,"dimension":2}"#,
        r#"{"kind":"header","format":"posecut","version":1,"dimension":4}"#,
        r#"{"kind":"header","format":"posecut","version":1}"#,
        r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{"a":{}}}"#,
        r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":{"a":{"information":[1]}}}"#,
        r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"noise_models":[]}"#,
        r#"{"kind":"header","format":"posecut","version":1,"dimension":2,"provenance":{}}"#,
        r#"{"id":0}"#,
        r#"{"kind":7}"#,
        r#"["gps"]"#,
        r#"{"kind":"node"}"#,
        r#"{"kind":"node","id":null}"#,
        r#"{"kind":"node","id":-1}"#,
        r#"{"kind":"node","id":0.5}"#,
        r#"{"kind":"node","id":18446744073709551616}"#,
        r#"{"kind":"node","id":"7"}"#,
        r#"{"kind":"node","id":7,"session":1}"#,
        r#"{"kind":"node","id":7,"frame":"1"}"#,
        r#"{"kind":"node","id":7,"frame":9223372036854775808}"#,
        r#"{"kind":"node","id":7,"utime":1.5}"#,
        r#"{"kind":"node","id":7,"landmark":-1}"#,
        r#"{"kind":"node","id":7,"pose":[1,2]}"#,
        r#"{"kind":"node","id":7,"pose":[1,2,"3"]}"#,
        r#"{"kind":"node","id":7,"truth":[]}"#,
        r#"{"kind":"node","id":7,"truth":{"pose":[1]}}"#,
        r#"{"kind":"landmark","from":0,"to":1}"#,
        r#"{"kind":"landmark","id":0,"to":1}"#,
        r#"{"kind":"landmark","id":0,"from":0}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"measurement":[1,0,0]}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"measurement":[1,0,0],"information":[1,0,0]}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"noise":"wheels","information":[1,0,0,1,0,1]}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"noise":1}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"rejected_by":true}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"cost":"1"}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"score":[]}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"truth":{"correct":1}}"#,
        r#"{"kind":"prior","node":1,"measurement":[1,2],"information":[1,0,1]}"#,
        r#"{"kind":"prior","id":0,"measurement":[1,2],"information":[1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"information":[1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1],"information":[1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":null,"information":[1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2],"information":[1,0,0,1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2,0],"information":[1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2],"noise":"wheels"}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2,0],"noise":"wheels","information":[1,0,0,1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2],"information":[1,0,1],"source":1}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2],"information":[1,0,1],"rejected_by":true}"#,
        r#"{"kind":"odometry","id":0,"from":0,"to":1}"#,
        r#"{"kind":"odometry","id":0,"from":0,"to":1,"measurement":null,"noise":"wheels"}"#,
        r#"{"kind":"odometry","id":0,"from":0,"to":1,"measurement":[1,0,0]}"#,
    ] {
        assert!(!read(line), "the reader takes {line}");
        assert!(!schema.is_valid(&parsed(line)), "the schema takes {line}");
        assert!(!plane.is_valid(&parsed(line)), "the schema of the plane takes {line}");
    }
}

/// Tests the list in the documentation of `schema`: this fails as soon as the schema expresses one of its rules.
#[test]
fn what_only_the_reader_refuses_is_known() {
    let schema = whole();
    for line in [
        r#"{"kind":"node","id":1}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":9}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":0}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"measurement":[1,0,0],"noise":"unknown"}"#,
        r#"{"kind":"landmark","id":0,"from":0,"to":1,"information":[1,2,0,1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":9,"measurement":[1,2],"information":[1,0,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2],"information":[1,2,1]}"#,
        r#"{"kind":"prior","id":0,"node":1,"measurement":[1,2,0],"noise":"unknown"}"#,
        r#"{"kind":"node","id":7,"id":8}"#,
        r#"{"kind":"node","id":7.0}"#,
    ] {
        assert!(!read(line), "the reader takes {line}");
        assert!(schema.is_valid(&parsed(line)), "the schema refuses {line}");
    }
}

#[test]
fn dimensions_are_told_apart() {
    let (plane, space) = (of("plane"), of("space"));
    let spatial = parsed(r#"{"kind":"node","id":0,"pose":[0,0,0,0,0,0,1]}"#);
    assert!(space.is_valid(&spatial) && !plane.is_valid(&spatial) && whole().is_valid(&spatial));
    assert!(
        !space.is_valid(&parsed(r#"{"kind":"node","id":0,"pose":[0,0,0,0,0,0,2]}"#)),
        "no unit quaternion"
    );
    assert!(!space.is_valid(&parsed(HEADER)) && plane.is_valid(&parsed(HEADER)));
}
