//! What verification is made of, and can be done without to see what it is worth.

use serde::Serialize;

/// A part of the method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Ingredient {
    /// Covariance scales estimated from loops; without them, covariances are used unchanged
    Calibration,
    /// Odometry errors that accumulate, such as a wrong wheel size
    Coherent,
    /// A separate factor for odometry between neighbouring edges; without it, one factor for all odometry
    ShortStretches,
    /// A t distribution of the errors; without it, they are Gaussian
    HeavyTails,
    /// False edges that come in groups, as an alternative to correct edges in the calibration
    Shift,
    /// Comparison with distant edges; without it, only near edges are compared
    FarPartners,
    /// The minimum-cost multicut; without it, edges that any evidence connects form one cluster
    Multicut,
    /// Rounds of map and verdicts; without them, the verdicts of the multicut are final
    Rounds,
    /// Doubt about lone edges in graphs where other measurements are somewhat wrong
    Local,
    /// A separate prior for edges where the map is uncertain; without it, one prior for all edges
    Prior,
    /// The usual motion of a session across gaps in its odometry
    Bridges,
    /// Groups of edges beyond a broken odometry step, if the usual motion leads to them
    Breaks,
    /// Groups of edges that the map contradicts, if a map with them agrees with other groups
    Trials,
    /// Short groups of edges that wait while a rival has comparable evidence, or the map contradicts more groups like them than it
    /// accepts; without it, the heavier group is accepted
    Rivals,
    /// The score that a front end gives a candidate, with a weight learnt from the graph
    Score,
}
