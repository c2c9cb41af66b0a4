//! The tuning half and the test half of a family.
//!
//! Constants are chosen on the first half and judged on the second, so that no page reports how well a constant fits the
//! graphs it was chosen with. A declaration names both halves by patterns of names, and every session or graph of it
//! belongs to exactly one.

use std::collections::BTreeMap;

use anyhow::{Context as _, bail};
use serde::Deserialize;

/// One of the two halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Half {
    /// Constants are chosen on it
    Tuning,
    /// Results are reported on it
    Test,
}

impl Half {
    /// The value of the label `half`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tuning => "tuning",
            Self::Test => "test",
        }
    }
}

/// Which sessions and graphs belong to which half, by names or patterns with `*` and `?`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Halves {
    /// Names of the tuning half.
    pub tuning: Vec<String>,
    /// Names of the test half.
    pub test: Vec<String>,
    /// Why the halves are not independent, where one cluster has members in both.
    pub dependent: Option<String>,
}

impl Halves {
    /// The half of a session or graph; an error where it is in both or in neither.
    pub fn of(&self, name: &str) -> anyhow::Result<Half> {
        match (any(&self.tuning, name)?, any(&self.test, name)?) {
            (true, false) => Ok(Half::Tuning),
            (false, true) => Ok(Half::Test),
            (true, true) => bail!(
                "[halves]: \"{name}\" is in both halves, so that constants would be tuned on the test; name it in one"
            ),
            (false, false) => bail!("[halves]: \"{name}\" is in neither half; name it in tuning or test"),
        }
    }

    /// Refuses halves that share a cluster, unless the declaration says why.
    pub(crate) fn check<'a>(&self, members: impl Iterator<Item = (&'a str, &'a str)>) -> anyhow::Result<()> {
        let mut clusters: BTreeMap<&str, (Half, &str)> = BTreeMap::new();
        for (name, cluster) in members {
            let half = self.of(name)?;
            let &mut (known, other) = clusters.entry(cluster).or_insert((half, name));
            if known != half && self.dependent.is_none() {
                bail!(
                    "[halves]: \"{name}\" and \"{other}\" are of one cluster, \"{cluster}\", and in different halves; move one, or say under `dependent` why the halves are not independent"
                );
            }
        }
        Ok(())
    }
}

/// Whether one of the patterns is that of a name.
pub(crate) fn any(patterns: &[String], name: &str) -> anyhow::Result<bool> {
    for pattern in patterns {
        let matcher = glob::Pattern::new(pattern)
            .with_context(|| format!("\"{pattern}\" is neither a name nor a pattern with * and ?"))?;
        if pattern == name || matcher.matches(name) {
            return Ok(true);
        }
    }
    Ok(false)
}
