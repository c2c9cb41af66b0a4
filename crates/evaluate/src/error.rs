//! What cannot be compared.

/// Why an estimate cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// Plane against space.
    #[error(
        "the estimate has dimension {estimate}, the reference {reference}; optimise both from the same session graphs"
    )]
    Dimension {
        /// Of the estimate.
        estimate: u64,
        /// Of the reference.
        reference: u64,
    },
    /// Not one node is in both.
    #[error(
        "not one node has a pose both in the estimate ({estimate} nodes) and in the reference ({reference} nodes); the ids of the two files must mean the same nodes{hint}"
    )]
    NothingInCommon {
        /// Nodes of the estimate.
        estimate: usize,
        /// Nodes of the reference.
        reference: usize,
        /// What else may be wrong.
        hint: &'static str,
    },
    /// A probability that is none.
    #[error(
        "{edge}: `verify_probability` is {value}, expected a number between 0 and 1; correct or remove the field"
    )]
    Probability {
        /// Kind and id of the edge.
        edge: String,
        /// As found.
        value: String,
    },
    /// A label that is no pair.
    #[error("--label {label}: expected NAME=VALUE, such as --label session=2012-01-22")]
    Label {
        /// As given.
        label: String,
    },
}
