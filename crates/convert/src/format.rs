//! File formats.

use std::fmt;
use std::path::Path;

use posecut_graph::Content;

/// The formats that can be read and written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum FileFormat {
    /// Pose-graph JSON Lines (.jsonl)
    Jsonl,
    /// g2o pose graphs (.g2o)
    G2o,
    /// TORO pose graphs (.toro, .graph)
    Toro,
    /// JSON Robot Log datasets (.jrl)
    Jrl,
    /// TUM trajectories (.tum): seconds x y z qx qy qz qw
    Tum,
    /// KITTI trajectories (.kitti): 3x4 matrices, row by row
    Kitti,
    /// evo results (.zip): the error of the poses against --reference; only as output
    Evo,
}

impl FileFormat {
    /// The format of content that starts with these bytes; `None` if it is none of the known ones.
    pub fn of_content(head: &[u8]) -> Option<Self> {
        Some(match Content::of(head)? {
            Content::JsonLines => Self::Jsonl,
            Content::G2o => Self::G2o,
            Content::Toro => Self::Toro,
            // The reader of JRL says how to make JSON of CBOR.
            Content::Jrl | Content::Cbor => Self::Jrl,
            Content::Tum => Self::Tum,
            Content::Kitti => Self::Kitti,
            Content::Zip => Self::Evo,
        })
    }

    /// The format for a file name; `.gz` at its end does not count.
    pub fn of_name(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_lowercase();
        let name = name.strip_suffix(".gz").unwrap_or(&name);
        match name.rsplit_once('.')?.1 {
            "jsonl" | "json" | "ndjson" => Some(Self::Jsonl),
            "g2o" => Some(Self::G2o),
            "toro" | "graph" => Some(Self::Toro),
            "jrl" => Some(Self::Jrl),
            "tum" => Some(Self::Tum),
            "kitti" => Some(Self::Kitti),
            "zip" => Some(Self::Evo),
            _ => None,
        }
    }

    /// Whether a file of this format holds one trajectory and no edges.
    pub fn is_trajectory(self) -> bool {
        matches!(self, Self::Tum | Self::Kitti)
    }
}

impl fmt::Display for FileFormat {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Jsonl => "JSON Lines",
            Self::G2o => "g2o",
            Self::Toro => "TORO",
            Self::Jrl => "JRL",
            Self::Tum => "TUM",
            Self::Kitti => "KITTI",
            Self::Evo => "evo",
        })
    }
}
