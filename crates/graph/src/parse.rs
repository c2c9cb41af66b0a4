//! Parses one line of JSON to one record in a single pass; an error names the field.

mod key;
mod line;
mod nested;

use serde::Deserialize;
use serde::de::{Error as _, MapAccess};
use serde_json::Value;

use key::Key;
use line::{Fields, explain, once, parse};
use nested::{UniqueFields, noise_model};

use crate::error::Problem;
use crate::{Dimension, Edge, EdgeKind, Extra, FORMAT, Header, Node, NoiseModel, Prior, VERSION};

/// Parses a line whose kind is known.
pub(crate) fn parse_header(line: &str) -> Result<Header, Problem> {
    let fields = parse(line, "header", HeaderFields::default())?;
    let header = || "header".to_owned();
    if fields.format.as_deref() != Some(FORMAT) {
        let found = fields.format.map_or_else(|| "no format".to_owned(), |name| format!("\"{name}\""));
        return Err(Problem::new(
            format!("expected the format \"{FORMAT}\", found {found}"),
            "convert other formats with posecut-convert",
        )
        .record(header())
        .field("format"));
    }
    if fields.version != Some(VERSION) {
        let found = fields.version.map_or_else(|| "none".to_owned(), |version| version.to_string());
        return Err(Problem::new(
            format!("this program reads version {VERSION} of the format, found {found}"),
            "use a posecut that reads that version, or write the file again with this one",
        )
        .record(header())
        .field("version"));
    }
    let Some(dimension) = fields.dimension.and_then(Dimension::from_number) else {
        let found = fields.dimension.map_or_else(|| "none".to_owned(), |number| number.to_string());
        return Err(Problem::new(format!("expected 2 or 3, found {found}"), "set \"dimension\" to 2 or 3")
            .record(header())
            .field("dimension"));
    };
    Ok(Header {
        dimension,
        noise_models: fields.noise_models,
        provenance: fields.provenance.unwrap_or_default(),
        extra: fields.extra,
    })
}

pub(crate) fn parse_node(line: &str) -> Result<Node, Problem> {
    let fields = parse(line, "node", NodeFields::default())?;
    let id = fields.id.ok_or_else(|| missing("node", "id"))?;
    Ok(Node { id, ..fields.node })
}

pub(crate) fn parse_edge(line: &str, kind: EdgeKind) -> Result<Edge, Problem> {
    let fields = parse(
        line,
        kind.name(),
        EdgeFields { id: None, from: None, to: None, edge: Edge::new(kind, 0, 0, 0) },
    )?;
    let id = fields.id.ok_or_else(|| missing(kind.name(), "id"))?;
    let name = format!("{} {id}", kind.name());
    let from = fields.from.ok_or_else(|| missing(&name, "from"))?;
    let to = fields.to.ok_or_else(|| missing(&name, "to"))?;
    Ok(Edge { id, from, to, ..fields.edge })
}

pub(crate) fn parse_prior(line: &str) -> Result<Prior, Problem> {
    let fields = parse(line, "prior", PriorFields::default())?;
    let id = fields.id.ok_or_else(|| missing("prior", "id"))?;
    let name = format!("prior {id}");
    let node = fields.node.ok_or_else(|| missing(&name, "node"))?;
    let measurement = fields.measurement.ok_or_else(|| missing(&name, "measurement"))?;
    Ok(Prior { id, node, measurement, ..fields.prior })
}

#[derive(Deserialize)]
struct KindOnly {
    kind: Option<String>,
}

/// The value of `"kind"`. If it is not the first field, this takes a pass over the line.
pub(crate) fn kind_of(line: &str) -> Result<std::borrow::Cow<'_, str>, Problem> {
    if let Some(rest) = line.strip_prefix("{\"kind\":\"")
        && let Some(end) = rest.find(['"', '\\'])
        && rest.as_bytes()[end] == b'"'
    {
        return Ok(rest[..end].into());
    }
    let only: KindOnly = serde_json::from_str(line).map_err(|error| explain(line, &error))?;
    only.kind.map(Into::into).ok_or_else(|| {
        Problem::new("the record has no kind", "give it \"kind\": header, node, odometry, landmark or prior")
            .field("kind")
    })
}

/// Checks a record of an unknown kind. It passes through unchanged, so other programs must be able to read it: it needs
/// exactly one kind and finite numbers.
pub(crate) fn check_unknown(line: &str) -> Result<(), Problem> {
    #[derive(Deserialize)]
    struct Unknown {
        #[serde(rename = "kind")]
        _kind: String,
        #[serde(flatten)]
        _fields: serde_json::Map<String, Value>,
    }
    serde_json::from_str::<Unknown>(line).map(drop).map_err(|error| explain(line, &error))
}

fn missing(record: &str, field: &str) -> Problem {
    Problem::new("the field is missing", "add it: every record of this kind needs it")
        .record(record)
        .field(field)
}

#[derive(Default)]
struct NodeFields {
    id: Option<u64>,
    node: Node,
}

impl Fields for NodeFields {
    fn take<'de, A: MapAccess<'de>>(&mut self, key: &Key, map: &mut A) -> Result<Option<String>, A::Error> {
        match key.name() {
            "id" => once(map, &mut self.id),
            "session" => once(map, &mut self.node.session),
            "frame" => once(map, &mut self.node.frame),
            "utime" => once(map, &mut self.node.utime),
            "pose" => once(map, &mut self.node.pose),
            "landmark" => once(map, &mut self.node.landmark),
            "truth" => once(map, &mut self.node.truth),
            unknown => Ok(Some(unknown.to_owned())),
        }
    }

    fn extra(&mut self) -> &mut Extra {
        &mut self.node.extra
    }

    fn id(&self) -> Option<u64> {
        self.id
    }
}

struct EdgeFields {
    id: Option<u64>,
    from: Option<u64>,
    to: Option<u64>,
    edge: Edge,
}

impl Fields for EdgeFields {
    fn take<'de, A: MapAccess<'de>>(&mut self, key: &Key, map: &mut A) -> Result<Option<String>, A::Error> {
        match key.name() {
            "id" => once(map, &mut self.id),
            "from" => once(map, &mut self.from),
            "to" => once(map, &mut self.to),
            "measurement" => once(map, &mut self.edge.measurement),
            "information" => once(map, &mut self.edge.information),
            "noise" => once(map, &mut self.edge.noise),
            "truth" => once(map, &mut self.edge.truth),
            "rejected_by" => once(map, &mut self.edge.rejected_by),
            "cost" => once(map, &mut self.edge.cost),
            "score" => once(map, &mut self.edge.score),
            unknown => Ok(Some(unknown.to_owned())),
        }
    }

    fn extra(&mut self) -> &mut Extra {
        &mut self.edge.extra
    }

    fn id(&self) -> Option<u64> {
        self.id
    }
}

#[derive(Default)]
struct PriorFields {
    id: Option<u64>,
    node: Option<u64>,
    measurement: Option<Vec<f64>>,
    prior: Prior,
}

impl Fields for PriorFields {
    fn take<'de, A: MapAccess<'de>>(&mut self, key: &Key, map: &mut A) -> Result<Option<String>, A::Error> {
        match key.name() {
            "id" => once(map, &mut self.id),
            "node" => once(map, &mut self.node),
            "measurement" => once(map, &mut self.measurement),
            "information" => once(map, &mut self.prior.information),
            "noise" => once(map, &mut self.prior.noise),
            "source" => once(map, &mut self.prior.source),
            "truth" => once(map, &mut self.prior.truth),
            "rejected_by" => once(map, &mut self.prior.rejected_by),
            "score" => once(map, &mut self.prior.score),
            unknown => Ok(Some(unknown.to_owned())),
        }
    }

    fn extra(&mut self) -> &mut Extra {
        &mut self.prior.extra
    }

    fn id(&self) -> Option<u64> {
        self.id
    }
}

#[derive(Default)]
struct HeaderFields {
    format: Option<String>,
    version: Option<u64>,
    dimension: Option<u64>,
    provenance: Option<Vec<Value>>,
    noise_models: Vec<(String, NoiseModel)>,
    extra: Extra,
}

impl Fields for HeaderFields {
    fn take<'de, A: MapAccess<'de>>(&mut self, key: &Key, map: &mut A) -> Result<Option<String>, A::Error> {
        match key.name() {
            "format" => once(map, &mut self.format),
            "version" => once(map, &mut self.version),
            "dimension" => once(map, &mut self.dimension),
            "provenance" => once(map, &mut self.provenance),
            "noise_models" => {
                let models: Option<UniqueFields> = map.next_value()?;
                for (name, model) in models.map(|models| models.0).unwrap_or_default() {
                    let model = noise_model(model).map_err(A::Error::custom)?;
                    self.noise_models.push((name, model));
                }
                Ok(None)
            }
            unknown => Ok(Some(unknown.to_owned())),
        }
    }

    fn extra(&mut self) -> &mut Extra {
        &mut self.extra
    }
}
