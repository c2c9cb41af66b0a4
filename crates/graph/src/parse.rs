//! One line of JSON to one record, in a single pass, with the field in hand when something is wrong.

use std::cell::Cell;
use std::fmt;

use serde::Deserialize;
use serde::de::{DeserializeOwned, DeserializeSeed, Deserializer, Error as _, MapAccess, Visitor};
use serde_json::Value;

use crate::error::Problem;
use crate::{
    Dimension, Edge, EdgeKind, EdgeTruth, Extra, FORMAT, Header, Node, NodeTruth, NoiseModel, VERSION,
};

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
            "use a posecut of that version, or write the file anew with this one",
        )
        .record(header())
        .field("version"));
    }
    let Some(dimension) = fields.dimension.and_then(Dimension::from_number) else {
        let found = fields.dimension.map_or_else(|| "none".to_owned(), |number| number.to_string());
        return Err(Problem::new(format!("expected 2 or 3, found {found}"), "say \"dimension\":2 or 3")
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

#[derive(Deserialize)]
struct KindOnly {
    kind: Option<String>,
}

/// The value of `"kind"`: at once where it stands first, by a pass over the line where it does not.
pub(crate) fn kind_of(line: &str) -> Result<std::borrow::Cow<'_, str>, Problem> {
    if let Some(rest) = line.strip_prefix("{\"kind\":\"")
        && let Some(end) = rest.find(['"', '\\'])
        && rest.as_bytes()[end] == b'"'
    {
        return Ok(rest[..end].into());
    }
    let only: KindOnly = serde_json::from_str(line).map_err(|error| explain(line, &error))?;
    only.kind.map(Into::into).ok_or_else(|| {
        Problem::new("the record has no kind", "give it \"kind\": header, node, odometry or landmark")
            .field("kind")
    })
}

fn missing(record: &str, field: &str) -> Problem {
    Problem::new("the field is missing", "every record of this kind must have it").record(record).field(field)
}

/// Fields of one kind of record, filled one by one.
trait Fields: Sized {
    /// Takes the value of `key`, or leaves it alone and returns the key's name as unknown.
    fn take<'de, A: MapAccess<'de>>(&mut self, key: Key, map: &mut A) -> Result<Option<String>, A::Error>;
    fn extra(&mut self) -> &mut Extra;
    fn id(&self) -> Option<u64> {
        None
    }
}

#[derive(Deserialize)]
#[serde(field_identifier, rename_all = "snake_case")]
enum Key {
    Kind,
    Id,
    From,
    To,
    Measurement,
    Information,
    Noise,
    Truth,
    RejectedBy,
    Cost,
    Score,
    Session,
    Frame,
    Utime,
    Pose,
    Landmark,
    Format,
    Version,
    Dimension,
    Provenance,
    NoiseModels,
    Other(String),
}

impl Key {
    fn name(&self) -> &str {
        match self {
            Self::Kind => "kind",
            Self::Id => "id",
            Self::From => "from",
            Self::To => "to",
            Self::Measurement => "measurement",
            Self::Information => "information",
            Self::Noise => "noise",
            Self::Truth => "truth",
            Self::RejectedBy => "rejected_by",
            Self::Cost => "cost",
            Self::Score => "score",
            Self::Session => "session",
            Self::Frame => "frame",
            Self::Utime => "utime",
            Self::Pose => "pose",
            Self::Landmark => "landmark",
            Self::Format => "format",
            Self::Version => "version",
            Self::Dimension => "dimension",
            Self::Provenance => "provenance",
            Self::NoiseModels => "noise_models",
            Self::Other(name) => name,
        }
    }

    fn static_name(&self) -> &'static str {
        match self {
            Self::Id => "id",
            Self::From => "from",
            Self::To => "to",
            Self::Measurement => "measurement",
            Self::Information => "information",
            Self::Noise => "noise",
            Self::Truth => "truth",
            Self::RejectedBy => "rejected_by",
            Self::Cost => "cost",
            Self::Score => "score",
            Self::Session => "session",
            Self::Frame => "frame",
            Self::Utime => "utime",
            Self::Pose => "pose",
            Self::Landmark => "landmark",
            Self::Format => "format",
            Self::Version => "version",
            Self::Dimension => "dimension",
            Self::Provenance => "provenance",
            Self::NoiseModels => "noise_models",
            Self::Kind | Self::Other(_) => "",
        }
    }
}

/// Where the parser stands: what an error message needs and the parser's own error does not say.
#[derive(Default)]
struct Place {
    field: Cell<&'static str>,
    id: Cell<Option<u64>>,
}

struct Seed<'a, F> {
    fields: F,
    place: &'a Place,
}

impl<'de, F: Fields> DeserializeSeed<'de> for Seed<'_, F> {
    type Value = F;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<F, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de, F: Fields> Visitor<'de> for Seed<'_, F> {
    type Value = F;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("one JSON object a line")
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut map: A) -> Result<F, A::Error> {
        while let Some(key) = map.next_key::<Key>()? {
            self.place.field.set(key.static_name());
            if matches!(key, Key::Kind) {
                map.next_value::<serde::de::IgnoredAny>()?;
                continue;
            }
            if let Some(name) = self.fields.take(key, &mut map)? {
                let value: Value = map.next_value()?;
                if self.fields.extra().insert(name.clone(), value).is_some() {
                    return Err(A::Error::custom(format!("the field \"{name}\" stands twice")));
                }
            }
            self.place.id.set(self.fields.id());
            self.place.field.set("");
        }
        Ok(self.fields)
    }
}

fn parse<F: Fields>(line: &str, kind: &str, fields: F) -> Result<F, Problem> {
    let place = Place::default();
    let mut deserializer = serde_json::Deserializer::from_str(line);
    let result = Seed { fields, place: &place }
        .deserialize(&mut deserializer)
        .and_then(|fields| deserializer.end().map(|()| fields));
    result.map_err(|error| {
        let mut problem = explain(line, &error);
        problem.record = Some(place.id.get().map_or_else(|| kind.to_owned(), |id| format!("{kind} {id}")));
        let field = place.field.get();
        problem.field = (!field.is_empty()).then(|| field.to_owned());
        problem
    })
}

/// The JSON parser's error in this format's words.
fn explain(line: &str, error: &serde_json::Error) -> Problem {
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    let place = format!("{message} (column {})", error.column());
    if error.is_eof() {
        return Problem::new(
            format!("the line ends in the middle of a record: {place}"),
            "the file was cut short; write or copy it again",
        );
    }
    if message.contains("number out of range") {
        return Problem::new(
            format!("a number is too large to be finite: {place}"),
            "poses, measurements and costs must be finite",
        );
    }
    if error.is_syntax() {
        let before = error.column().saturating_sub(12);
        let around = line.get(before..).unwrap_or(line);
        let around = &around.as_bytes()[..around.len().min(24)];
        let around = String::from_utf8_lossy(around).to_lowercase();
        if around.contains("nan") || around.contains("inf") {
            return Problem::new(
                format!("NaN and infinity are no numbers of this format (column {})", error.column()),
                "find out where the number was lost; leave a measurement that does not exist out",
            );
        }
        return Problem::new(format!("this is not JSON: {place}"), "write one JSON object a line, in UTF-8");
    }
    Problem::new(place, "see the format's description in crates/graph/README.md")
}

/// Takes an optional field; `null` counts as absent.
fn once<'de, A: MapAccess<'de>, T: Deserialize<'de>>(
    map: &mut A,
    slot: &mut Option<T>,
) -> Result<Option<String>, A::Error> {
    if slot.is_some() {
        return Err(A::Error::custom("the field stands twice"));
    }
    *slot = map.next_value()?;
    Ok(None)
}

#[derive(Default)]
struct NodeFields {
    id: Option<u64>,
    node: Node,
}

impl Fields for NodeFields {
    fn take<'de, A: MapAccess<'de>>(&mut self, key: Key, map: &mut A) -> Result<Option<String>, A::Error> {
        match key {
            Key::Id => once(map, &mut self.id),
            Key::Session => once(map, &mut self.node.session),
            Key::Frame => once(map, &mut self.node.frame),
            Key::Utime => once(map, &mut self.node.utime),
            Key::Pose => once(map, &mut self.node.pose),
            Key::Landmark => once(map, &mut self.node.landmark),
            Key::Truth => once(map, &mut self.node.truth),
            unknown => Ok(Some(unknown.name().to_owned())),
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
    fn take<'de, A: MapAccess<'de>>(&mut self, key: Key, map: &mut A) -> Result<Option<String>, A::Error> {
        match key {
            Key::Id => once(map, &mut self.id),
            Key::From => once(map, &mut self.from),
            Key::To => once(map, &mut self.to),
            Key::Measurement => once(map, &mut self.edge.measurement),
            Key::Information => once(map, &mut self.edge.information),
            Key::Noise => once(map, &mut self.edge.noise),
            Key::Truth => once(map, &mut self.edge.truth),
            Key::RejectedBy => once(map, &mut self.edge.rejected_by),
            Key::Cost => once(map, &mut self.edge.cost),
            Key::Score => once(map, &mut self.edge.score),
            unknown => Ok(Some(unknown.name().to_owned())),
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
struct HeaderFields {
    format: Option<String>,
    version: Option<u64>,
    dimension: Option<u64>,
    provenance: Option<Vec<Value>>,
    noise_models: Vec<(String, NoiseModel)>,
    extra: Extra,
}

impl Fields for HeaderFields {
    fn take<'de, A: MapAccess<'de>>(&mut self, key: Key, map: &mut A) -> Result<Option<String>, A::Error> {
        match key {
            Key::Format => once(map, &mut self.format),
            Key::Version => once(map, &mut self.version),
            Key::Dimension => once(map, &mut self.dimension),
            Key::Provenance => once(map, &mut self.provenance),
            Key::NoiseModels => {
                let models: Option<UniqueFields> = map.next_value()?;
                for (name, model) in models.map(|models| models.0).unwrap_or_default() {
                    let model = noise_model(model).map_err(A::Error::custom)?;
                    self.noise_models.push((name, model));
                }
                Ok(None)
            }
            unknown => Ok(Some(unknown.name().to_owned())),
        }
    }

    fn extra(&mut self) -> &mut Extra {
        &mut self.extra
    }
}

/// The fields of a nested object. One that stands twice is a fault here too: JSON's own answer, that the last
/// one counts, would lose data without a word.
struct UniqueFields(Extra);

impl<'de> Deserialize<'de> for UniqueFields {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Fields;

        impl<'de> Visitor<'de> for Fields {
            type Value = UniqueFields;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<UniqueFields, A::Error> {
                let mut fields = Extra::new();
                while let Some((name, value)) = map.next_entry::<String, Value>()? {
                    if fields.contains_key(&name) {
                        return Err(A::Error::custom(format!("\"{name}\" stands twice")));
                    }
                    fields.insert(name, value);
                }
                Ok(UniqueFields(fields))
            }
        }

        deserializer.deserialize_map(Fields)
    }
}

fn noise_model(value: Value) -> Result<NoiseModel, String> {
    let Value::Object(mut fields) = value else {
        return Err("a noise model is an object with \"information\"".to_owned());
    };
    let information = take_known(&mut fields, "information")?
        .ok_or_else(|| "a noise model needs \"information\"".to_owned())?;
    Ok(NoiseModel { information, extra: fields })
}

fn take_known<T: DeserializeOwned>(fields: &mut Extra, name: &str) -> Result<Option<T>, String> {
    match fields.shift_remove(name) {
        None | Some(Value::Null) => Ok(None),
        Some(value) => {
            serde_json::from_value(value).map(Some).map_err(|error| format!("\"{name}\": {error}"))
        }
    }
}

impl<'de> Deserialize<'de> for NodeTruth {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let UniqueFields(mut extra) = UniqueFields::deserialize(deserializer)?;
        let pose = take_known(&mut extra, "pose").map_err(D::Error::custom)?;
        Ok(Self { pose, extra })
    }
}

impl<'de> Deserialize<'de> for EdgeTruth {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let UniqueFields(mut extra) = UniqueFields::deserialize(deserializer)?;
        let correct = take_known(&mut extra, "correct").map_err(D::Error::custom)?;
        Ok(Self { correct, extra })
    }
}
