//! The campus: its paths, its terrain, and the iron that disturbs a compass.

use nalgebra::Vector2;
use petgraph::algo::connected_components;
use petgraph::graph::{EdgeIndex, NodeIndex, UnGraph};
use petgraph::visit::EdgeRef as _;
use posecut_random::{ChaCha8Rng, random};
use rand::RngExt as _;

use crate::noise::normal;

/// Number of crossings from south to north and from west to east: about 420 m by 830 m, the extent of NCLT's routes.
const ROWS: usize = 5;
const COLUMNS: usize = 9;
/// Metres between crossings before they are displaced.
const SPACING: f64 = 100.0;
/// How far crossings are displaced from the grid, metres.
const DISPLACEMENT: f64 = 18.0;
/// Share of the grid's paths that are not built.
const MISSING_PATHS: f64 = 0.25;

/// A whole turn, rounded to two digits: directions and phases are drawn from it.
#[expect(clippy::approx_constant, reason = "more digits would only change every simulated session")]
const TURN: f64 = 6.28;

/// A network of paths between crossings, on a terrain.
#[derive(Clone, Debug)]
pub struct Campus {
    /// Crossings (x north, y east, metres) and the paths between them.
    pub paths: UnGraph<Vector2<f64>, ()>,
    hills: Vec<Wave>,
    iron: Vec<Bump>,
}

#[derive(Clone, Debug)]
struct Wave {
    direction: Vector2<f64>,
    phase: f64,
    amplitude: f64,
}

#[derive(Clone, Debug)]
struct Bump {
    centre: Vector2<f64>,
    radius: f64,
    height: f64,
}

impl Campus {
    /// The campus with this seed. All sessions of one experiment share it.
    pub fn new(seed: u64) -> Self {
        let mut draw = random(seed, "campus");
        let paths = network(&mut draw);
        let hills = (0..4)
            .map(|_| {
                let (length, heading): (f64, f64) =
                    (draw.random_range(180.0..600.0), draw.random_range(0.0..TURN));
                let direction = Vector2::new(heading.cos(), heading.sin()) * (std::f64::consts::TAU / length);
                Wave {
                    direction,
                    phase: draw.random_range(0.0..TURN),
                    amplitude: draw.random_range(0.5..3.0),
                }
            })
            .collect();
        let iron = (0..45)
            .map(|index| {
                let centre = Vector2::new(
                    draw.random_range(-50.0..SPACING * ROWS as f64),
                    draw.random_range(-50.0..SPACING * COLUMNS as f64),
                );
                // Most buildings disturb a compass by some degrees, a few by far more.
                let sigma = if index % 9 == 0 { 1.0 } else { 0.2 };
                Bump { centre, radius: draw.random_range(8.0..30.0), height: normal(&mut draw, sigma) }
            })
            .collect();
        Self { paths, hills, iron }
    }

    /// Height above the lowest plain, metres, positive upwards.
    pub fn height(&self, place: &Vector2<f64>) -> f64 {
        self.hills.iter().map(|wave| wave.amplitude * (wave.direction.dot(place) + wave.phase).sin()).sum()
    }

    /// The error of a compass at a position, caused by iron nearby, radians.
    pub fn compass_error(&self, place: &Vector2<f64>) -> f64 {
        let bend = |bump: &Bump| {
            let distance = (place - bump.centre).norm() / bump.radius;
            bump.height * (-0.5 * distance * distance).exp()
        };
        self.iron.iter().map(bend).sum()
    }
}

/// A displaced grid without some of its paths. A path is removed only if all crossings remain reachable and none
/// becomes a dead end.
fn network(draw: &mut ChaCha8Rng) -> UnGraph<Vector2<f64>, ()> {
    let mut paths = UnGraph::new_undirected();
    let crossings: Vec<NodeIndex> = (0..ROWS * COLUMNS)
        .map(|index| {
            let (row, column) = (index / COLUMNS, index % COLUMNS);
            paths.add_node(Vector2::new(
                row as f64 * SPACING + draw.random_range(-DISPLACEMENT..DISPLACEMENT),
                column as f64 * SPACING + draw.random_range(-DISPLACEMENT..DISPLACEMENT),
            ))
        })
        .collect();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let here = crossings[row * COLUMNS + column];
            if column + 1 < COLUMNS {
                paths.add_edge(here, crossings[row * COLUMNS + column + 1], ());
            }
            if row + 1 < ROWS {
                paths.add_edge(here, crossings[(row + 1) * COLUMNS + column], ());
            }
        }
    }
    let wanted = (paths.edge_count() as f64 * (1.0 - MISSING_PATHS)) as usize;
    for _ in 0..1000 {
        if paths.edge_count() <= wanted {
            break;
        }
        let candidate = EdgeIndex::new(draw.random_range(0..paths.edge_count()));
        let mut thinner = paths.clone();
        let ends = thinner.edge_endpoints(candidate);
        thinner.remove_edge(candidate);
        let dead_end = ends.is_none_or(|(a, b)| thinner.edges(a).count() < 2 || thinner.edges(b).count() < 2);
        if !dead_end && connected_components(&thinner) == 1 {
            paths = thinner;
        }
    }
    paths
}

/// The crossings that a path joins with this crossing, in ascending order.
pub(crate) fn neighbours(paths: &UnGraph<Vector2<f64>, ()>, crossing: NodeIndex) -> Vec<NodeIndex> {
    let mut found: Vec<NodeIndex> = paths.edges(crossing).map(|path| path.target()).collect();
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_crossing_can_be_reached_and_left() {
        for seed in 1..6 {
            let campus = Campus::new(seed);
            assert_eq!(connected_components(&campus.paths), 1);
            assert!(
                campus.paths.node_indices().all(|crossing| neighbours(&campus.paths, crossing).len() >= 2)
            );
        }
    }

    #[test]
    fn a_seed_fixes_the_campus() {
        let place = Vector2::new(120.0, 340.0);
        assert_eq!(Campus::new(3).height(&place), Campus::new(3).height(&place));
        assert_ne!(Campus::new(3).height(&place), Campus::new(4).height(&place));
    }
}
