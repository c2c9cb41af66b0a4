//! How files are read.

use posecut_stage::Source;
use serde::{Serialize, Serializer};

use super::trajectory::TrajectoryOptions;
use crate::closures::ClosureOptions;
use crate::{FileFormat, Odometry};

/// The session of files that name no session.
const SESSION: &str = "0";

/// How files are read. Programs flatten these options into their own; their JSON goes into the provenance.
#[derive(Clone, Debug, Default, clap::Args, Serialize)]
pub struct ReadingOptions {
    /// Read this format [default: by the content of the file, else by its name]
    #[arg(long, value_enum, help_heading = "Input")]
    #[serde(skip)]
    pub from: Option<FileFormat>,

    /// Use this session name for files that name no session, or once for each file [default: 0, or the names of the files]
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    #[serde(serialize_with = "one_or_several")]
    pub session: Vec<String>,

    /// Set negative eigenvalues of information matrices to zero instead of refusing them
    #[arg(long, help_heading = "Input")]
    pub repair_information: bool,

    /// Skip lines and factors of unknown type instead of refusing them
    #[arg(long, help_heading = "Input")]
    pub skip_unknown: bool,

    /// Choose which edges are odometry, in formats that do not say it
    #[arg(long, value_enum, value_name = "RULE", default_value_t = Odometry::Auto, help_heading = "Input")]
    #[serde(skip_serializing_if = "is_default")]
    pub odometry: Odometry,

    /// Make each file a session, named by the file, and number nodes and edges anew
    #[arg(long, help_heading = "Input")]
    #[serde(skip_serializing_if = "is_default")]
    pub renumber: bool,

    /// What becomes of trajectories.
    #[command(flatten)]
    #[serde(flatten)]
    pub trajectory: TrajectoryOptions,

    /// Add the landmark edges of this table: CSV with named columns, such as from,to,x,y,theta
    #[arg(long, value_name = "FILE", help_heading = "Closures from a table")]
    #[serde(skip)]
    pub closures: Option<Source>,

    /// What a table of closures does not say.
    #[command(flatten)]
    #[serde(flatten)]
    pub closure_options: ClosureOptions,
}

impl ReadingOptions {
    /// The session of files that name no session.
    pub fn session(&self) -> &str {
        self.session.first().map_or(SESSION, String::as_str)
    }
}

/// Provenance leaves options out that have their defaults.
pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn one_or_several<S: Serializer>(sessions: &[String], serializer: S) -> Result<S::Ok, S::Error> {
    match sessions {
        [] => serializer.serialize_str(SESSION),
        [one] => serializer.serialize_str(one),
        several => several.serialize(serializer),
    }
}
