//! The targets of fuzzing, and the laws that they must keep.

mod logs;
mod readers;
mod sensors;
mod session;
mod stages;

use std::cell::OnceCell;
use std::path::PathBuf;

use crate::seeds;

/// The outcome of a target for one input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The input was accepted, with a short description.
    Read(String),
    /// The input was refused, with this sentence.
    Refused(String),
}

impl Outcome {
    fn refused(error: impl std::fmt::Display) -> Self {
        Self::Refused(format!("{error:#}"))
    }
}

/// A reader or a stage.
pub struct Target {
    /// The name of the target, of the folder of its corpus and of the stream of its random numbers.
    pub name: &'static str,
    /// Words of the target's format.
    pub words: &'static [&'static str],
    /// Gives an input to the target; panics if a law is broken.
    pub read: fn(&[u8]) -> Outcome,
    seeds: fn() -> Vec<Vec<u8>>,
}

impl Target {
    /// Valid inputs, then those in the corpus.
    pub fn seeds(&self) -> Vec<Vec<u8>> {
        let mut all = (self.seeds)();
        all.extend(seeds::kept(self.name));
        all
    }
}

const JSON: &[&str] = &[
    "kind",
    "header",
    "node",
    "odometry",
    "landmark",
    "id",
    "from",
    "to",
    "measurement",
    "information",
    "noise",
    "truth",
    "pose",
    "correct",
    "rejected_by",
    "cost",
    "score",
    "session",
    "frame",
    "utime",
    "format",
    "version",
    "dimension",
    "provenance",
    "noise_models",
    "null",
    "true",
    "false",
    "posecut",
];

const CSV: &[&str] =
    &["nan", "frame_i", "frame_j", "score", "session_i", "session_j", "wheels.csv", "kvh.csv"];

/// All targets.
pub const TARGETS: &[Target] = &[
    Target { name: "jsonl", words: JSON, read: readers::jsonl, seeds: seeds::graphs },
    Target { name: "schema", words: JSON, read: readers::schema, seeds: seeds::graphs },
    Target {
        name: "g2o",
        words: &["VERTEX_SE2", "EDGE_SE2", "VERTEX_SE3:QUAT", "EDGE_SE3:QUAT", "FIX", "VERTEX_XY"],
        read: readers::g2o,
        seeds: seeds::g2o,
    },
    Target {
        name: "toro",
        words: &["VERTEX2", "EDGE2", "VERTEX3", "EDGE3"],
        read: readers::toro,
        seeds: seeds::toro,
    },
    Target { name: "tum", words: &["nan"], read: readers::tum, seeds: seeds::tum },
    Target { name: "kitti", words: &["nan"], read: readers::kitti, seeds: seeds::kitti },
    Target { name: "mc", words: &["MULTICUT", "nan"], read: readers::mc, seeds: seeds::instances },
    Target {
        name: "certificate",
        words: &["labels", "component", "end", "cycle", "path", "fix", "join", "cut", "blocks", "branch"],
        read: readers::certificate,
        seeds: seeds::certificates,
    },
    Target { name: "matches", words: CSV, read: readers::matches, seeds: seeds::matches },
    Target { name: "result", words: JSON, read: readers::result, seeds: seeds::results },
    Target {
        name: "published",
        words: &["source", "rmse", "pcm"],
        read: readers::published,
        seeds: seeds::published,
    },
    Target {
        name: "gzip",
        words: &[],
        read: readers::gzip,
        seeds: || vec![seeds::compressed(&seeds::graphs()[3])],
    },
    Target {
        name: "log",
        words: &["FLASER", "ROBOTLASER1", "TRUEPOS", "ODOM", "RAWLASER1", "nan", "inf", "1e300", "-1"],
        read: logs::log,
        seeds: seeds::logs,
    },
    Target {
        name: "relations",
        words: &["nan", "inf", "1e300"],
        read: logs::relative,
        seeds: seeds::relations,
    },
    Target { name: "hokuyo", words: &[], read: sensors::hokuyo, seeds: seeds::planar_scans },
    Target { name: "velodyne", words: &[], read: sensors::velodyne, seeds: seeds::spatial_scans },
    Target { name: "session", words: CSV, read: session::directory, seeds: seeds::sessions },
    Target { name: "archive", words: CSV, read: session::archive, seeds: seeds::archives },
    Target { name: "pcm", words: JSON, read: stages::pcm, seeds: seeds::graphs },
    Target { name: "readmit", words: JSON, read: stages::readmit, seeds: seeds::predicted },
    Target { name: "multicut", words: JSON, read: stages::multicut, seeds: seeds::graphs },
    Target { name: "verify", words: JSON, read: stages::verify, seeds: seeds::graphs },
    Target { name: "optimize", words: JSON, read: stages::optimize, seeds: seeds::graphs },
    Target { name: "gnc", words: JSON, read: stages::gnc, seeds: seeds::graphs },
    Target { name: "ransac", words: JSON, read: stages::ransac, seeds: seeds::graphs },
    Target { name: "islands", words: JSON, read: stages::islands, seeds: seeds::graphs },
    Target { name: "densest", words: JSON, read: stages::densest, seeds: seeds::graphs },
    Target { name: "voting", words: JSON, read: stages::voting, seeds: seeds::graphs },
    Target { name: "oracle", words: JSON, read: stages::oracle, seeds: seeds::graphs },
    Target { name: "evaluate", words: JSON, read: stages::evaluate, seeds: seeds::graphs },
    Target { name: "construct", words: JSON, read: stages::construct, seeds: seeds::graphs },
];

thread_local! {
    static SCRATCH: OnceCell<tempfile::TempDir> = const { OnceCell::new() };
}

/// A path for readers that open files themselves; in memory if the system offers that.
fn scratch(name: &str) -> PathBuf {
    SCRATCH.with(|folder| {
        let folder = folder.get_or_init(|| {
            tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a temporary folder")
        });
        folder.path().join(name)
    })
}
