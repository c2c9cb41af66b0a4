//! JSON Robot Log (JRL) datasets, the JSON format of COSMO-Bench: <https://github.com/DanMcGann/jrl>, `format/DATASET_FORMAT.md`.
//!
//! A dataset is one object with the measurements of each robot, ground truth, initialisation, and lists of factors that may be or are
//! outliers. Keys are gtsam's symbols: the letter in the top byte names the robot, which becomes a session; the rest is the frame.
//!
//! - `BetweenFactorPose2` and `BetweenFactorPose3` become edges: those among the potential outliers are landmark edges, of the others
//!   those between successive keys are odometry ([`Odometry`](crate::Odometry)).
//! - `outlier_factors` become labels: landmark edges in that list are incorrect, the others correct.
//! - A prior on the first pose of a robot anchors the graph: the first one becomes `fixed`, further ones are counted and left out.
//!   A prior on another pose becomes a prior.
//! - Covariances of `Pose3` have gtsam's order, rotation first; ours have translation first. Both belong to right perturbations.
//! - Stamps that are times since 1970 (in seconds, or thousandths, millionths or billionths of them) become `utime`; others stay as the
//!   field `stamp` of nodes.
//!
//! The document and the library that writes these files differ. The reader accepts both: robots as letters or as their codes, values
//! as a list or by key, lists of factors by robot or, for one robot, as they are, and the older `potential_outlier_statuses`.

mod covariance;
mod document;
mod read;
mod stamps;
mod write;

pub use read::{ReadOptions, ReadSummary, read};
pub use write::{WriteSummary, write};

/// The highest number of a pose: JRL uses those above for other variables, such as landmarks.
pub(crate) const LAST_POSE: u64 = 999_999_999;

/// The field of a node with a stamp of unknown unit.
pub(crate) const STAMP: &str = "stamp";

/// The field of the header with the name of the dataset.
pub(crate) const NAME: &str = "name";
