//! Reads a folder of `make map`.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow, bail};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use posecut_graph::PoseGraph;
use posecut_map::{Grid, MapError, write_opacity};
use posecut_scan::Scans;
use posecut_stage::{Context, Source, info};
use posecut_view::encode;

use super::errors::errors;
use super::{Candidates, LogMap, LogMaps, MAP_STEP, RelationErrors};
use crate::page::view::Track;

/// Cells of the finest maps, metres, as posecut-map draws them.
const FINEST: f64 = 0.05;

/// A picture has at most this many cells along each side: the maps of larger sites have larger cells.
const MOST_CELLS: f64 = 2400.0;

/// Cells of the grid that only measures how large a map is, metres.
const COARSE: f64 = 1.0;

/// A graph with its scans.
struct Site {
    path: PathBuf,
    graph: PoseGraph,
    scans: Scans,
    errors: Option<RelationErrors>,
}

/// Draws the maps in a folder. O(size of the graphs + cells of the maps + beams * range / resolution).
///
/// # Errors
///
/// `graph.jsonl` or `optimized.jsonl` is missing, a file is not what its name says, or a graph has no map.
pub fn read(folder: &Path, context: &mut Context) -> anyhow::Result<LogMaps> {
    let name = name(folder);
    for file in ["graph.jsonl", "optimized.jsonl"] {
        if !folder.join(file).is_file() {
            bail!(
                "{}: has no {file}, so it is no folder of maps; run make map LOG=FILE, and name the folder that it wrote",
                folder.display()
            );
        }
    }
    let mut site = |graph: &str, errors: &str| Site::read(folder, &name, graph, errors, context);
    let before = site("graph.jsonl", "before.errors.result.json")?;
    let after = site("optimized.jsonl", "errors.result.json")?;
    let unjudged = folder.join("all-candidates.jsonl").is_file();
    let all =
        unjudged.then(|| site("all-candidates.jsonl", "all-candidates.errors.result.json")).transpose()?;
    let sites: Vec<&Site> = [Some(&before), all.as_ref(), Some(&after)].into_iter().flatten().collect();
    for other in &sites[1..] {
        other.check_nodes(&before)?;
    }
    let mut longest: f64 = 0.0;
    for site in &sites {
        longest = longest.max(site.extent()?);
    }
    let mut resolution = FINEST;
    while longest / resolution > MOST_CELLS {
        resolution *= 2.0;
    }
    let candidates = Candidates::of(&after.graph);
    info!("map {name}: {} candidates, cells of {resolution} m", candidates.counts.candidates);
    Ok(LogMaps {
        name,
        resolution,
        candidates,
        before: before.drawn(resolution)?,
        all_candidates: all.map(|site| site.drawn(resolution)).transpose()?,
        after: after.drawn(resolution)?,
    })
}

/// The last part of a folder's path that is a name: `aces` of `results/map/aces/.`, and of the folder in which the program runs.
fn name(folder: &Path) -> String {
    let absolute = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
    absolute.file_name().map_or_else(|| "map".to_owned(), |name| name.to_string_lossy().into_owned())
}

impl Site {
    fn read(
        folder: &Path,
        name: &str,
        graph: &str,
        result: &str,
        context: &mut Context,
    ) -> anyhow::Result<Self> {
        let role = |file: &str| format!("map/{name}/{file}");
        let path = folder.join(graph);
        let graph = context.read_graph(&Source::File(path.clone()), &role(graph))?;
        let scans = Scans::of_graph(&graph).with_context(|| path.display().to_string())?;
        let result_path = folder.join(result);
        let errors = if result_path.is_file() {
            let (place, bytes) = context.read_bytes(&Source::File(result_path), &role(result))?;
            errors(&place, &bytes)?
        } else {
            None
        };
        Ok(Self { path, graph, scans, errors })
    }

    /// Edges are matched by id and drawn at the nodes of each graph, so all graphs must have the same nodes.
    fn check_nodes(&self, other: &Self) -> anyhow::Result<()> {
        let ids = |site: &Self| site.graph.nodes.iter().map(|node| node.id).collect::<Vec<u64>>();
        if ids(self) != ids(other) {
            bail!(
                "{}: has other nodes than {}; make both of one log: run make map again",
                self.path.display(),
                other.path.display()
            );
        }
        Ok(())
    }

    fn grid(&self, resolution: f64) -> anyhow::Result<Grid> {
        let place = self.path.display();
        Grid::of_graph(&self.graph, &self.scans, resolution, f64::INFINITY).map_err(|error| match error {
            MapError::NoScans => {
                anyhow!("{place}: has no laser scans; name a folder that make map LOG=FILE wrote")
            }
            MapError::TooLarge { width, height, .. } => anyhow!(
                "{place}: its map would be {width:.0} x {height:.0} m, too large to draw; look for poses far away"
            ),
            error => anyhow!("{place}: {error}"),
        })
    }

    /// Metres along the longer side, rounded up.
    fn extent(&self) -> anyhow::Result<f64> {
        let grid = self.grid(COARSE)?;
        Ok(grid.width.max(grid.height) as f64 * COARSE)
    }

    fn drawn(&self, resolution: f64) -> anyhow::Result<LogMap> {
        let grid = self.grid(resolution)?;
        let mut png = Vec::new();
        write_opacity(&grid, &mut png)
            .with_context(|| format!("{}: its map cannot be written as PNG", self.path.display()))?;
        let positions = self.graph.nodes.iter().map(|node| {
            let pose = node.pose.as_deref().ok_or_else(|| {
                anyhow!(
                    "{}: node {} has no pose; optimise the graph with posecut-optimize first",
                    self.path.display(),
                    node.id
                )
            })?;
            Ok((pose[0], pose[1]))
        });
        let positions: Vec<(f64, f64)> = positions.collect::<anyhow::Result<_>>()?;
        Ok(LogMap {
            picture: STANDARD.encode(png),
            corner: [grid.corner.x, grid.corner.y],
            size: [grid.width as f64 * resolution, grid.height as f64 * resolution],
            track: Track {
                right: encode::series(positions.iter().map(|position| position.0), MAP_STEP),
                up: encode::series(positions.iter().map(|position| position.1), MAP_STEP),
            },
            errors: self.errors,
        })
    }
}
