//! The files of NCLT's `velodyne_sync` that belong to the keyframes of a graph.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use posecut_graph::PoseGraph;
use posecut_nclt_sensors::times::nearest;
use posecut_nclt_sensors::velodyne::{read_hits, time_of_name};
use rayon::prelude::*;

use crate::scan_context::ContextOptions;
use crate::spatial::SpatialScan;

/// The scan of a keyframe is taken within this time of it, microseconds: the robot moves by 0.1 m at most. NCLT's are taken at the images,
/// and so at keyframes timed by them.
const WITHIN: u64 = 50_000;

/// The scans of a graph.
pub struct Spatial {
    /// By the position of the node; `None` for keyframes without a file.
    pub scans: Vec<Option<SpatialScan>>,
    /// A line `DIGEST  NAME` for each file that was read, by name: what `sha256sum` prints of them, if the digest is that.
    pub digests: String,
}

/// The scans of the keyframes of a graph. Files are read one by one and reduced at once; `digest` gives that of a file's content.
/// O(hits log hits).
///
/// # Errors
///
/// A folder or a file cannot be read, or no keyframe has a file.
pub fn read_folders(
    folders: &[PathBuf],
    graph: &PoseGraph,
    options: &ContextOptions,
    digest: impl Fn(&[u8]) -> String + Sync,
) -> anyhow::Result<Spatial> {
    let mut files: Vec<(i64, PathBuf)> = Vec::new();
    for folder in folders {
        files.extend(files_of(folder)?);
    }
    files.sort();
    // All results before the first error, so that it is the same one at any number of threads.
    let read: Vec<anyhow::Result<Option<(usize, String, SpatialScan)>>> = graph
        .nodes
        .par_iter()
        .map(|node| {
            let at = node.utime.and_then(|time| nearest(&files, time, WITHIN));
            let Some(index) = at else { return Ok(None) };
            let path = &files[index].1;
            let place = path.display().to_string();
            let bytes = fs::read(path).with_context(|| format!("{place}: cannot be read"))?;
            Ok(Some((index, digest(&bytes), SpatialScan::new(&read_hits(&place, &bytes)?, options))))
        })
        .collect();
    let (mut scans, mut digests) = (Vec::with_capacity(read.len()), BTreeMap::new());
    for scan in read {
        scans.push(scan?.map(|(index, digest, scan)| {
            digests.insert(index, digest);
            scan
        }));
    }
    ensure!(
        !digests.is_empty(),
        "none of the {} scans in {} is within 0.05 s of one of the {} keyframes; name the folder of the graph's session",
        files.len(),
        folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(" and "),
        graph.nodes.len()
    );
    let line = |(index, digest): (usize, String)| {
        let name = files[index].1.file_name().map(|name| name.to_string_lossy().into_owned());
        format!("{digest}  {}\n", name.unwrap_or_default())
    };
    Ok(Spatial { scans, digests: digests.into_iter().map(line).collect() })
}

/// The files of a folder that are named by a time.
fn files_of(folder: &Path) -> anyhow::Result<Vec<(i64, PathBuf)>> {
    let place = || format!("{}: cannot be read as a folder of velodyne_sync", folder.display());
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).with_context(place)? {
        let entry = entry.with_context(place)?;
        if let Some(time) = time_of_name(&entry.file_name().to_string_lossy()) {
            files.push((time, entry.path()));
        }
    }
    ensure!(
        !files.is_empty(),
        "{}: has no file UTIME.bin; name a folder as NCLT's velodyne_sync",
        folder.display()
    );
    Ok(files)
}
