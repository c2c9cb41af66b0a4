//! Objects within records.

use std::fmt;

use serde::Deserialize;
use serde::de::{DeserializeOwned, Deserializer, Error as _, MapAccess, Visitor};
use serde_json::Value;

use crate::{EdgeTruth, Extra, NodeTruth, NoiseModel};

/// The fields of a nested object. A duplicate field is an error here too: JSON parsers usually keep the last one, which would
/// lose data silently.
pub(super) struct UniqueFields(pub(super) Extra);

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
                        return Err(A::Error::custom(format!("\"{name}\" occurs twice")));
                    }
                    fields.insert(name, value);
                }
                Ok(UniqueFields(fields))
            }
        }

        deserializer.deserialize_map(Fields)
    }
}

pub(super) fn noise_model(value: Value) -> Result<NoiseModel, String> {
    let Value::Object(mut fields) = value else {
        return Err("a noise model must be an object with \"information\"".to_owned());
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
