//! The JSON of a dataset, as types. Errors of the JSON library name line and column.

use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

/// A whole file. Results (`.jrr`) have the same beginning but solutions instead of measurements.
#[derive(Deserialize)]
pub(super) struct Document {
    pub(super) name: Option<String>,
    pub(super) measurements: Option<ByRobot<Nullable<Vec<Entry>>>>,
    pub(super) groundtruth: Option<ByRobot<Values>>,
    pub(super) initialization: Option<ByRobot<Values>>,
    pub(super) potential_outlier_factors: Option<Factors>,
    pub(super) outlier_factors: Option<Factors>,
}

/// The measurements of one robot at one time.
#[derive(Deserialize)]
pub(super) struct Entry {
    pub(super) stamp: Option<u64>,
    #[serde(default)]
    pub(super) measurements: Nullable<Vec<Factor>>,
    /// Older files: for each potential outlier, whether it is one.
    #[serde(default)]
    pub(super) potential_outlier_statuses: Statuses,
}

/// A factor of any type. A missing field is an error only if the type needs it.
#[derive(Deserialize)]
pub(super) struct Factor {
    #[serde(rename = "type")]
    pub(super) kind: String,
    pub(super) key: Option<u64>,
    pub(super) key1: Option<u64>,
    pub(super) key2: Option<u64>,
    pub(super) measurement: Option<Value>,
    pub(super) prior: Option<Value>,
    /// Row by row.
    pub(super) covariance: Option<Vec<f64>>,
}

/// A value of any type: a pose has the fields of one.
#[derive(Default)]
pub(super) struct Value {
    pub(super) kind: Option<String>,
    pub(super) key: Option<u64>,
    pub(super) planar: [Option<f64>; 3],
    pub(super) translation: Option<Vec<f64>>,
    pub(super) rotation: Option<Vec<f64>>,
}

/// A list that is `null` if it is empty, as nlohmann's JSON writes it.
#[derive(Deserialize)]
#[serde(transparent)]
pub(super) struct Nullable<T>(Option<T>);

impl<T> Default for Nullable<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T> Nullable<T> {
    pub(super) fn of(list: T) -> Self {
        Self(Some(list))
    }
}

impl<T> Nullable<Vec<T>> {
    pub(super) fn len(&self) -> usize {
        self.0.as_ref().map_or(0, Vec::len)
    }
}

impl<T: Default> Nullable<T> {
    pub(super) fn into_inner(self) -> T {
        self.0.unwrap_or_default()
    }
}

/// Something for each robot.
pub(super) struct ByRobot<T>(pub(super) Vec<(String, T)>);

/// The values of a robot by key.
#[derive(Default)]
pub(super) struct Values(pub(super) Vec<(u64, Value)>);

/// A list of factors: the index of the entry and the index in it.
type FactorList = Nullable<Vec<(usize, usize)>>;

/// Factors by the index of their entry and their index in it.
pub(super) enum Factors {
    ByRobot(Vec<(String, FactorList)>),
    /// As the document has it, without robots.
    List(Vec<(usize, usize)>),
}

/// Indices of factors with a status.
#[derive(Default)]
pub(super) struct Statuses(pub(super) Vec<(usize, bool)>);

/// Reads one of several shapes of JSON.
struct Shape<T>(&'static str, PhantomData<T>);

macro_rules! deserialize_shape {
    ($type:ty, $expected:literal, $($bound:tt)*) => {
        impl<'de, $($bound)*> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(Shape::<Self>($expected, PhantomData))
            }
        }
    };
}

deserialize_shape!(ByRobot<T>, "an object with a field for each robot", T: Deserialize<'de>);
deserialize_shape!(Values, "a list of values or an object of values by key",);
deserialize_shape!(Value, "a value such as {\"type\":\"Pose3\", …}",);
deserialize_shape!(Factors, "an object with a list of factors for each robot",);
deserialize_shape!(Statuses, "an object of true and false by index",);

impl<'de, T: Deserialize<'de>> Visitor<'de> for Shape<ByRobot<T>> {
    type Value = ByRobot<T>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
        entries(map).map(ByRobot)
    }

    fn visit_unit<E: Error>(self) -> Result<Self::Value, E> {
        Ok(ByRobot(Vec::new()))
    }
}

/// The entries of an object, which must have different names.
fn entries<'de, A: MapAccess<'de>, T: Deserialize<'de>>(mut map: A) -> Result<Vec<(String, T)>, A::Error> {
    let mut entries = Vec::new();
    let mut names = std::collections::HashSet::new();
    while let Some((name, value)) = map.next_entry::<String, T>()? {
        if !names.insert(name.clone()) {
            return Err(A::Error::custom(format!("the field \"{name}\" occurs twice")));
        }
        entries.push((name, value));
    }
    Ok(entries)
}

/// The entries of an object whose names are numbers.
fn numbered<'de, A: MapAccess<'de>, N: std::str::FromStr, T: Deserialize<'de>>(
    map: A,
) -> Result<Vec<(N, T)>, A::Error> {
    let number = |(name, value): (String, T)| match name.parse() {
        Ok(number) => Ok((number, value)),
        Err(_) => Err(A::Error::custom(format!("\"{name}\" is not a number"))),
    };
    entries(map)?.into_iter().map(number).collect()
}

fn list<'de, A: SeqAccess<'de>, T: Deserialize<'de>>(mut sequence: A) -> Result<Vec<T>, A::Error> {
    let mut items = Vec::new();
    while let Some(item) = sequence.next_element()? {
        items.push(item);
    }
    Ok(items)
}

impl<'de> Visitor<'de> for Shape<Values> {
    type Value = Values;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Values, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = sequence.next_element::<Value>()? {
            let key = value.key.ok_or_else(|| A::Error::custom("the value has no key"))?;
            values.push((key, value));
        }
        Ok(Values(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Values, A::Error> {
        numbered(map).map(Values)
    }

    fn visit_unit<E: Error>(self) -> Result<Values, E> {
        Ok(Values::default())
    }
}

impl<'de> Visitor<'de> for Shape<Factors> {
    type Value = Factors;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<Factors, A::Error> {
        list(sequence).map(Factors::List)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Factors, A::Error> {
        entries(map).map(Factors::ByRobot)
    }

    fn visit_unit<E: Error>(self) -> Result<Factors, E> {
        Ok(Factors::ByRobot(Vec::new()))
    }
}

impl<'de> Visitor<'de> for Shape<Statuses> {
    type Value = Statuses;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, sequence: A) -> Result<Statuses, A::Error> {
        list(sequence).map(Statuses)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Statuses, A::Error> {
        numbered(map).map(Statuses)
    }

    fn visit_unit<E: Error>(self) -> Result<Statuses, E> {
        Ok(Statuses::default())
    }
}

impl<'de> Visitor<'de> for Shape<Value> {
    type Value = Value;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.0)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut value = Value::default();
        while let Some(name) = map.next_key::<String>()? {
            let twice = match name.as_str() {
                "type" => value.kind.replace(map.next_value()?).is_some(),
                "key" => value.key.replace(map.next_value()?).is_some(),
                "x" => value.planar[0].replace(map.next_value()?).is_some(),
                "y" => value.planar[1].replace(map.next_value()?).is_some(),
                "theta" => value.planar[2].replace(map.next_value()?).is_some(),
                "translation" => value.translation.replace(map.next_value()?).is_some(),
                "rotation" => value.rotation.replace(map.next_value()?).is_some(),
                _ => {
                    map.next_value::<IgnoredAny>()?;
                    false
                }
            };
            if twice {
                return Err(A::Error::custom(format!("the field \"{name}\" occurs twice")));
            }
        }
        Ok(value)
    }

    /// A number, as in the measurement of a range. It is no pose.
    fn visit_f64<E: Error>(self, _: f64) -> Result<Value, E> {
        Ok(Value::default())
    }

    fn visit_u64<E: Error>(self, _: u64) -> Result<Value, E> {
        Ok(Value::default())
    }

    fn visit_i64<E: Error>(self, _: i64) -> Result<Value, E> {
        Ok(Value::default())
    }
}
