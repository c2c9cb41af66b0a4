//! Errors of evaluation.

/// Why an estimate cannot be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum EvaluateError {
    /// One graph is planar and the other spatial.
    #[error(
        "the estimate has dimension {estimate}, but the reference has {reference}; optimise both from the same session graphs"
    )]
    Dimension {
        /// Dimension of the estimate.
        estimate: u64,
        /// Dimension of the reference.
        reference: u64,
    },
    /// No node is in both graphs.
    #[error(
        "no node has a pose both in the estimate ({estimate} nodes) and in the reference ({reference} nodes); use files with the same node ids{hint}"
    )]
    NothingInCommon {
        /// Number of nodes of the estimate.
        estimate: usize,
        /// Number of nodes of the reference.
        reference: usize,
        /// Another possible reason.
        hint: &'static str,
    },
    /// A probability is not a number between 0 and 1.
    #[error(
        "{edge}: `verify_probability` is {value}, but must be a number between 0 and 1; correct or remove the field"
    )]
    Probability {
        /// Kind and id of the edge.
        edge: String,
        /// The value in the file.
        value: String,
    },
    /// A label is not of the form NAME=VALUE.
    #[error("--label {label}: expected NAME=VALUE, such as --label session=2012-01-22")]
    Label {
        /// The label on the command line.
        label: String,
    },
}
