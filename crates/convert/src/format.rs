//! File formats.

use std::path::Path;

/// The formats that can be read and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum FileFormat {
    /// Pose-graph JSON Lines (.jsonl)
    Jsonl,
    /// g2o pose graphs (.g2o)
    G2o,
    /// TORO pose graphs (.toro)
    Toro,
    /// TUM trajectories (.tum): seconds x y z qx qy qz qw
    Tum,
    /// KITTI trajectories (.kitti): 3x4 matrices, row by row
    Kitti,
    /// evo results (.zip): the error of the poses against --reference; only as output
    Evo,
}

impl FileFormat {
    /// The format for a file name; `.gz` at its end does not count.
    pub fn of_name(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        match name.rsplit_once('.')?.1 {
            "jsonl" | "json" | "ndjson" => Some(Self::Jsonl),
            "g2o" => Some(Self::G2o),
            "toro" => Some(Self::Toro),
            "tum" => Some(Self::Tum),
            "kitti" => Some(Self::Kitti),
            "zip" => Some(Self::Evo),
            _ => None,
        }
    }
}
