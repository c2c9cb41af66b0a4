//! What verification is made of, and can be done without to see what it is worth.

use serde::Serialize;

/// A part of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Ingredient {
    /// Factors on covariances, from the graph's loops; without them covariances are used as claimed
    Calibration,
    /// Errors of odometry that accumulate, such as that of the wheels' scale
    Coherent,
    /// A t distribution of errors; without it they are Gaussian
    HeavyTails,
    /// Groups of false edges beside the correct ones as an alternative in the calibration
    Shift,
    /// Comparison with edges far away; without it only near ones are compared
    FarPartners,
    /// The minimum-cost multicut; without it edges that any evidence ties together are one cluster
    Multicut,
    /// Rounds of map and verdicts; without them what the cut accepts is final
    Rounds,
    /// Doubt of lone edges where others are measured somewhat wrongly
    Local,
    /// A prior of their own for edges where the map says little; without it that of all edges
    Prior,
    /// The usual motion of a session where its odometry is interrupted
    Bridges,
    /// Groups of edges behind odometry that is broken, where the usual motion leads to them
    Breaks,
    /// Groups of edges that the map contradicts, where a map with them agrees with other groups
    Trials,
}
