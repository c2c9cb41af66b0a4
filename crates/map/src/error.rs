//! Graphs without a map.

/// Why a graph has no map.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// The graph is spatial.
    #[error(
        "the graph has dimension 3, but a map of laser scans is planar; read the log with posecut-ingest, which writes planar graphs"
    )]
    Spatial,
    /// No scan.
    #[error(
        "the graph has no scans; use a graph that posecut-ingest wrote from a log, or name its scans with --scans"
    )]
    NoScans,
    /// A node with a scan but without a pose.
    #[error("node {0} has a scan but no pose; optimise the graph with posecut-optimize first")]
    NoPose(u64),
    /// A grid that does not fit.
    #[error(
        "the map would be {width:.0} x {height:.0} m, more than {most} cells of {resolution} m; increase --resolution, decrease --max-range, or \
         look for poses far away"
    )]
    TooLarge {
        /// Metres along x.
        width: f64,
        /// Metres along y.
        height: f64,
        /// Side of a cell, metres.
        resolution: f64,
        /// The largest number of cells.
        most: usize,
    },
}
