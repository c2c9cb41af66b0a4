//! The doubts of stages in sentences. docs/doubts.md explains them to users.

use posecut_graph::Header;
use serde::Serialize;

/// Names of doubts, what they mean, and what to do.
const KNOWN: [(&str, &str, &str); 11] = [
    (
        "not-converged",
        "The optimiser stopped before it met a tolerance: the poses are not a minimum of the cost.",
        "Raise --max-iterations, start elsewhere (--initialisation), or check the information matrices.",
    ),
    (
        "non-finite-cost",
        "Squared residuals overflow the range of numbers, and only the robust cost is finite.",
        "Reject the edge with the gross measurement.",
    ),
    (
        "undetermined",
        "The edges do not determine a component of a pose; the result keeps it near its initial value.",
        "Give the edges information in every direction, or add edges.",
    ),
    (
        "not-certified",
        "No certificate of the global minimum was found, so the poses may be a local minimum.",
        "Start elsewhere (--initialisation), or check the landmark edges.",
    ),
    (
        "search-limit",
        "A search ended without a proof, because of a limit or a heuristic solver; a better result may exist.",
        "Raise the limit, or choose the exact solver.",
    ),
    (
        "nothing-kept",
        "There are candidates, but the stage kept or accepted none.",
        "Check units and covariances, and whether there is overlap at all.",
    ),
    ("everything-cut", "The multicut cuts every landmark edge.", "Check the costs, or --delta."),
    (
        "no-support-within-delta",
        "Most landmark edges are cut only because no other one is within --delta frames; this is no evidence against them.",
        "Set --delta to the spacing of the candidates (--delta auto), or use posecut-verify.",
    ),
    (
        "calibration-on-prior",
        "The landmark edges have too little information to estimate the covariance scale, or the estimate ended at a bound.",
        "Check the covariances, or give --scale.",
    ),
    (
        "covariance-invented",
        "The stage invented or repaired covariances, because the source has none or has an impossible one.",
        "Provide the sensor's covariances.",
    ),
    (
        "parts-not-connected",
        "No edge in use joins some components of the graph: their positions relative to each other mean nothing.",
        "Add or re-admit edges between them, or look at each component by itself.",
    ),
];

/// A doubt of a stage.
#[derive(Debug, Serialize)]
pub(crate) struct Doubted {
    stage: String,
    doubt: String,
    /// Empty for a doubt that this version does not know.
    meaning: &'static str,
    remedy: &'static str,
}

/// The doubts in the history of a graph.
pub(crate) fn doubts(header: &Header) -> Vec<Doubted> {
    header
        .doubts()
        .into_iter()
        .map(|found| {
            let known = KNOWN.iter().find(|(name, _, _)| *name == found.doubt);
            let (meaning, remedy) = known.map_or(("", ""), |(_, meaning, remedy)| (*meaning, *remedy));
            Doubted { stage: found.stage, doubt: found.doubt, meaning, remedy }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use posecut_stage::Doubt;

    use super::KNOWN;

    #[test]
    fn every_doubt_has_its_sentences() {
        let names: Vec<&str> = Doubt::ALL.iter().map(|doubt| doubt.name()).collect();
        let known: Vec<&str> = KNOWN.iter().map(|(name, _, _)| *name).collect();
        assert_eq!(known, names);
    }
}
