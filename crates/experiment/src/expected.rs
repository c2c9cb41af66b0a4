//! The expectations in `pipelines/expected.toml`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, bail};
use serde::{Deserialize, Serialize};
use toml::Value;

/// The expected results of experiments.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expected {
    /// The tolerance of numbers by family: `odometry` for `odometry_x`.
    #[serde(default)]
    pub tolerance: BTreeMap<String, Tolerance>,
    /// The experiments whose rows are recorded.
    #[serde(default)]
    pub cover: Vec<Cover>,
    /// Which method must do better than which other one.
    #[serde(default)]
    pub order: Vec<Order>,
    /// Counts and chosen edges of one file.
    #[serde(default)]
    pub exact: Vec<Recorded<Value>>,
    /// Numbers of one file, or means over seeds.
    #[serde(default)]
    pub close: Vec<Close>,
}

/// A number close to `value` differs by at most `absolute + relative * |value|`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tolerance {
    /// The absolute tolerance, in the number's own unit.
    #[serde(default)]
    pub absolute: f64,
    /// The relative tolerance, as a share of the expected value.
    #[serde(default)]
    pub relative: f64,
    /// Why the number may differ at all.
    pub reason: String,
}

/// An experiment whose files have expected rows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cover {
    /// The folder of its results.
    pub experiment: String,
    /// Every file of seeds 1 to this number has its rows.
    pub seeds: u64,
    /// The mean RMSE over seeds 1 to this number has a row.
    pub mean_over: u64,
}

/// A method that must do better than another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Order {
    /// The folder of the experiment's results.
    pub experiment: String,
    /// The method with the lower RMSE …
    pub better: String,
    /// … than this one's …
    pub worse: String,
    /// … in at least this share of the runs: seeds 1 to `seeds` of the sessions.
    pub share: f64,
    /// How many seeds.
    pub seeds: u64,
    /// The sessions for which the share was recorded. It is checked only if the plan has all of them. By default all sessions
    /// of the plan.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sessions: Vec<String>,
    /// Why the method must do better.
    pub reason: String,
}

/// Values of one file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recorded<T> {
    /// The file below the folder of results. `1-5` instead of a seed means the mean over these seeds.
    pub file: String,
    /// The step that writes it.
    pub stage: String,
    /// Quantities by name.
    #[serde(flatten)]
    pub values: BTreeMap<String, T>,
}

/// Numbers of one file.
pub type Close = Recorded<f64>;

const HEAD: &str = "\
# What the experiments are expected to give. `make check-results` compares, `make accept-results` records.
#
# tolerance, cover and order are written by hand: how far numbers may be off and why, which experiments have rows,
# and which method must do better. exact and close are recorded by `make accept-results`; look at the difference
# before you commit it.
";

impl Expected {
    /// Reads the expectations from a file.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let place = path.display();
        let text = std::fs::read_to_string(path).with_context(|| format!("{place}: cannot be read"))?;
        let expected: Self = crate::toml_text::parse(&text)
            .with_context(|| format!("{place}: is not a file of expectations"))?;
        for row in &expected.close {
            for name in row.values.keys() {
                expected.tolerance_of(name).with_context(|| format!("{place}: {}", row.file))?;
            }
        }
        if let Some(order) = expected.order.iter().find(|order| !(0.0..=1.0).contains(&order.share)) {
            bail!("{place}: an order's share is {}, and it must lie between 0 and 1", order.share);
        }
        Ok(expected)
    }

    /// The tolerance of a quantity.
    pub fn tolerance_of(&self, quantity: &str) -> anyhow::Result<&Tolerance> {
        let family = quantity.rsplit_once('_').map_or(quantity, |(family, _)| family);
        self.tolerance
            .get(quantity)
            .or_else(|| self.tolerance.get(family))
            .or_else(|| self.tolerance.get("other"))
            .with_context(|| format!("{quantity} has no tolerance; add [tolerance.{family}]"))
    }

    /// The file's text: rows in order, one quantity a line.
    pub fn write(&self) -> anyhow::Result<String> {
        #[derive(Serialize)]
        struct ByHand<'a> {
            tolerance: &'a BTreeMap<String, Tolerance>,
            cover: &'a [Cover],
            order: &'a [Order],
        }
        let by_hand = ByHand { tolerance: &self.tolerance, cover: &self.cover, order: &self.order };
        let mut text = format!("{HEAD}\n{}", toml::to_string(&by_hand)?);
        for row in &self.exact {
            section(
                &mut text,
                "exact",
                &row.file,
                &row.stage,
                row.values.iter().map(|(name, value)| (name, value.clone())),
            );
        }
        for row in &self.close {
            let values = row.values.iter().map(|(name, value)| (name, Value::Float(*value)));
            section(&mut text, "close", &row.file, &row.stage, values);
        }
        Ok(text)
    }
}

fn section<'a>(
    text: &mut String,
    kind: &str,
    file: &str,
    stage: &str,
    values: impl Iterator<Item = (&'a String, Value)>,
) {
    let quoted = |word: &str| Value::String(word.to_owned());
    // Writing to a string cannot fail.
    let _ = writeln!(text, "\n[[{kind}]]\nfile = {}\nstage = {}", quoted(file), quoted(stage));
    for (name, value) in values {
        let _ = writeln!(text, "{name} = {value}");
    }
}
