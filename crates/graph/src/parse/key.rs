//! Names of fields.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, Visitor};

/// All known fields of all kinds of records.
const KNOWN: [&str; 23] = [
    "kind",
    "id",
    "from",
    "to",
    "node",
    "measurement",
    "information",
    "noise",
    "source",
    "truth",
    "rejected_by",
    "cost",
    "score",
    "session",
    "frame",
    "utime",
    "pose",
    "landmark",
    "format",
    "version",
    "dimension",
    "provenance",
    "noise_models",
];

/// The name of a field. A known name is static and needs no allocation.
pub(super) enum Key {
    Known(&'static str),
    Other(String),
}

impl Key {
    pub(super) fn name(&self) -> &str {
        match self {
            Self::Known(name) => name,
            Self::Other(name) => name,
        }
    }

    /// The name for messages, if it is a known one.
    pub(super) fn known_name(&self) -> &'static str {
        match self {
            Self::Known(name) => name,
            Self::Other(_) => "",
        }
    }
}

impl<'de> Deserialize<'de> for Key {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = Key;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("the name of a field")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<Key, E> {
                let known = KNOWN.into_iter().find(|&known| known == name);
                Ok(known.map_or_else(|| Key::Other(name.to_owned()), Key::Known))
            }
        }

        deserializer.deserialize_identifier(Name)
    }
}
