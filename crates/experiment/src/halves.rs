//! The tuning half and the test half of a family.
//!
//! Constants are chosen on the tuning half and judged on the test half, so that no reported result comes from graphs on which
//! a constant was chosen. A declaration defines both halves by patterns of names or by seeds. Every session and graph, or
//! every seed, belongs to exactly one half.

use std::collections::BTreeMap;

use anyhow::{Context as _, bail};
use serde::Deserialize;

/// One of the two halves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Half {
    /// The half on which constants are chosen
    Tuning,
    /// The half on which results are reported
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

/// The two halves: by names of sessions and graphs, or patterns with `*` and `?`; or by seeds of all sessions.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Halves {
    /// Names of the tuning half.
    #[serde(default)]
    pub tuning: Vec<String>,
    /// Names of the test half.
    #[serde(default)]
    pub test: Vec<String>,
    /// Seeds of the tuning half, instead of names.
    #[serde(default)]
    pub tuning_seeds: Vec<u64>,
    /// Seeds of the test half, instead of names.
    #[serde(default)]
    pub test_seeds: Vec<u64>,
    /// Why the halves are not independent, if a cluster has members in both.
    pub dependent: Option<String>,
}

impl Halves {
    /// The half of a session or graph; an error if it is in both or in neither.
    pub fn of(&self, name: &str) -> anyhow::Result<Half> {
        match (any(&self.tuning, name)?, any(&self.test, name)?) {
            (true, false) => Ok(Half::Tuning),
            (false, true) => Ok(Half::Test),
            (true, true) => bail!(
                "[halves]: \"{name}\" is in both halves, so constants would be tuned on test data; name it in only one"
            ),
            (false, false) => bail!("[halves]: \"{name}\" is in neither half; name it in tuning or test"),
        }
    }

    /// Whether the halves are blocks of seeds.
    pub fn by_seed(&self) -> bool {
        !self.tuning_seeds.is_empty() || !self.test_seeds.is_empty()
    }

    /// The half of a seed; an error if it is in neither.
    pub fn of_seed(&self, seed: u64) -> anyhow::Result<Half> {
        if self.tuning_seeds.contains(&seed) {
            Ok(Half::Tuning)
        } else if self.test_seeds.contains(&seed) {
            Ok(Half::Test)
        } else {
            bail!("[halves]: seed {seed} is in neither half; name it in tuning_seeds or test_seeds")
        }
    }

    /// Refuses blocks of seeds that overlap, or that are combined with names.
    pub(crate) fn validate(&self) -> anyhow::Result<()> {
        if !self.by_seed() {
            return Ok(());
        }
        if !self.tuning.is_empty() || !self.test.is_empty() {
            bail!("[halves]: has both names and seeds; define the halves by one of them");
        }
        if let Some(seed) = self.tuning_seeds.iter().find(|seed| self.test_seeds.contains(seed)) {
            bail!(
                "[halves]: seed {seed} is in both halves, so constants would be tuned on test data; name it in only one"
            );
        }
        Ok(())
    }

    /// Refuses halves that share a cluster, unless the declaration says why.
    pub(crate) fn check<'a>(&self, members: impl Iterator<Item = (&'a str, &'a str)>) -> anyhow::Result<()> {
        let mut clusters: BTreeMap<&str, (Half, &str)> = BTreeMap::new();
        for (name, cluster) in members {
            let half = self.of(name)?;
            let &mut (known, other) = clusters.entry(cluster).or_insert((half, name));
            if known != half && self.dependent.is_none() {
                bail!(
                    "[halves]: \"{name}\" and \"{other}\" belong to one cluster, \"{cluster}\", but to different halves; move one, or explain in `dependent` why the halves are not independent"
                );
            }
        }
        Ok(())
    }
}

/// Whether one of the patterns matches a name.
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
