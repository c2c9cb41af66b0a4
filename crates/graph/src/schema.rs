//! The format as a JSON Schema.

use serde_json::{Value, json};

use crate::{Dimension, FORMAT, PriorOf, VERSION};

/// The JSON Schema (draft 2020-12) of one line of a pose graph.
///
/// `$defs/plane` and `$defs/space` describe the lines of a file of dimension 2 and 3; the whole schema accepts both. It
/// accepts everything that the reader accepts. The reader also refuses what a schema of single lines cannot express:
/// duplicate ids, edges and priors of missing nodes, unknown noise models, quaternions whose norm is not 1, information that is
/// not positive semidefinite, duplicate fields, and whole numbers written with a fraction or an exponent.
pub fn schema() -> Value {
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": format!("{FORMAT} pose graph, version {VERSION}: one line"),
        "description": "JSON Lines: a header, then nodes, edges and priors, one object per line. Metres, radians, microseconds UTC.",
        "anyOf": [{"$ref": "#/$defs/plane"}, {"$ref": "#/$defs/space"}],
        "$defs": {
            "plane": record(Dimension::Two),
            "space": record(Dimension::Three),
            "id": {"type": "integer", "minimum": 0, "maximum": u64::MAX},
            "whole": {"type": ["integer", "null"], "minimum": i64::MIN, "maximum": i64::MAX},
            "text": {"type": ["string", "null"]},
            "number": {"type": ["number", "null"]},
        }
    })
}

/// Any record of a file of that dimension. Records of other kinds may hold anything.
fn record(dimension: Dimension) -> Value {
    let kinds = [
        ("header", header(dimension)),
        ("node", node(dimension)),
        ("odometry", edge(dimension, true)),
        ("landmark", edge(dimension, false)),
        ("prior", prior(dimension)),
    ];
    let cases: Vec<Value> = kinds
        .into_iter()
        .map(|(kind, schema)| json!({"if": {"properties": {"kind": {"const": kind}}}, "then": schema}))
        .collect();
    json!({
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": {"type": "string"}},
        "allOf": cases
    })
}

fn header(dimension: Dimension) -> Value {
    json!({
        "description": "The first line, once.",
        "required": ["format", "version", "dimension"],
        "properties": {
            "format": {"const": FORMAT},
            "version": {"const": VERSION},
            "dimension": {"const": dimension.number()},
            "noise_models": {
                "description": "Information matrices that edges share by name.",
                "type": ["object", "null"],
                "additionalProperties": {
                    "type": "object",
                    "required": ["information"],
                    "properties": {"information": information(dimension)}
                }
            },
            "provenance": {
                "description": "What each stage did, oldest first.",
                "type": ["array", "null"],
                "items": {"properties": {"doubts": {
                    "description": "Names of the stage's doubts about its result (docs/doubts.md); absent if there are none.",
                    "examples": [["not-converged", "parts-not-connected"]]
                }}}
            }
        }
    })
}

fn node(dimension: Dimension) -> Value {
    json!({
        "description": "A viewpoint (keyframe).",
        "required": ["id"],
        "properties": {
            "id": {"$ref": "#/$defs/id"},
            "session": {"$ref": "#/$defs/text"},
            "frame": {"$ref": "#/$defs/whole"},
            "utime": {"description": "Microseconds since 1970, UTC.", "$ref": "#/$defs/whole"},
            "pose": optional(&pose(dimension)),
            "landmark": {"anyOf": [{"$ref": "#/$defs/id"}, {"type": "null"}]},
            "truth": {"type": ["object", "null"], "properties": {"pose": optional(&pose(dimension))}}
        }
    })
}

fn edge(dimension: Dimension, odometry: bool) -> Value {
    let mut required = vec!["id", "from", "to"];
    let mut conditions = vec![
        json!({"not": {"allOf": [present("information"), present("noise")]}}),
        json!({"if": present("measurement"), "then": {"anyOf": [present("information"), present("noise")]}}),
    ];
    if odometry {
        required.push("measurement");
        conditions.push(present("measurement"));
    }
    json!({
        "description": if odometry {
            "Motion between successive nodes of a session."
        } else {
            "A landmark edge (loop closure), correct or incorrect."
        },
        "required": required,
        "properties": {
            "id": {"$ref": "#/$defs/id"},
            "from": {"$ref": "#/$defs/id"},
            "to": {"$ref": "#/$defs/id"},
            "measurement": {"description": "The pose of \"to\" in the frame of \"from\".", "anyOf": optional(&pose(dimension))["anyOf"]},
            "information": {"description": "Upper triangle, row by row.", "anyOf": optional(&information(dimension))["anyOf"]},
            "noise": {"description": "A noise model of the header.", "$ref": "#/$defs/text"},
            "truth": {"type": ["object", "null"], "properties": {"correct": {"type": ["boolean", "null"]}}},
            "rejected_by": {"description": "The stage that rejected the edge; absent while the edge is in use.", "$ref": "#/$defs/text"},
            "cost": {"$ref": "#/$defs/number"},
            "score": {"$ref": "#/$defs/number"}
        },
        "allOf": conditions
    })
}

/// A prior measures a pose or a position, and its information matrix has as many rows as the error.
fn prior(dimension: Dimension) -> Value {
    let numbers = |of: PriorOf| numbers(of.information_terms(dimension));
    let position = json!({"allOf": [
        {"properties": {
            "measurement": position(dimension),
            "information": numbers(PriorOf::Position),
            "noise": {"type": "null"}
        }},
        present("information")
    ]});
    let pose = json!({"allOf": [
        {"properties": {"measurement": pose(dimension), "information": optional(&numbers(PriorOf::Pose))}},
        {"not": {"allOf": [present("information"), present("noise")]}},
        {"anyOf": [present("information"), present("noise")]}
    ]});
    json!({
        "description": "A measurement of one node in the frame of the map: of its pose, or of its position alone.",
        "required": ["id", "node", "measurement"],
        "properties": {
            "id": {"description": "Unique among priors.", "$ref": "#/$defs/id"},
            "node": {"$ref": "#/$defs/id"},
            "noise": {"description": "A noise model of the header; only for a pose.", "$ref": "#/$defs/text"},
            "source": {"description": "The sensor or program that it comes from.", "$ref": "#/$defs/text"},
            "truth": {"type": ["object", "null"], "properties": {"correct": {"type": ["boolean", "null"]}}},
            "rejected_by": {"description": "The stage that rejected the prior; absent while it is in use.", "$ref": "#/$defs/text"},
            "score": {"$ref": "#/$defs/number"}
        },
        "anyOf": [pose, position]
    })
}

fn position(dimension: Dimension) -> Value {
    let mut schema = numbers(dimension.position_components());
    schema["description"] =
        format!("A position of dimension {dimension}: {}.", dimension.position_layout()).into();
    schema
}

fn pose(dimension: Dimension) -> Value {
    let count = dimension.pose_components();
    let mut schema = json!({
        "description": format!("A pose of dimension {dimension}: {}.", dimension.pose_layout()),
        "type": "array", "items": {"type": "number"}, "minItems": count, "maxItems": count
    });
    if dimension == Dimension::Three {
        let (any, unit) =
            (json!({"type": "number"}), json!({"type": "number", "minimum": -1.001, "maximum": 1.001}));
        schema["prefixItems"] = [vec![any; 3], vec![unit; 4]].concat().into();
    }
    schema
}

fn information(dimension: Dimension) -> Value {
    numbers(dimension.information_terms())
}

fn numbers(count: usize) -> Value {
    json!({"type": "array", "items": {"type": "number"}, "minItems": count, "maxItems": count})
}

/// `null` counts as absent.
fn optional(schema: &Value) -> Value {
    json!({"anyOf": [schema, {"type": "null"}]})
}

fn present(field: &str) -> Value {
    json!({"required": [field], "properties": {field: {"not": {"type": "null"}}}})
}
