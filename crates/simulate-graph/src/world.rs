//! The true paths of the robots.

mod flight;
mod planar;
mod terrain;

use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_random::{ChaCha8Rng, random};
use serde::Serialize;

use crate::Character;
use terrain::Terrain;

/// The kind of paths. In space, all but flights lead over hills.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum World {
    /// Along the streets of a grid, with a turn at every crossing or none
    Streets,
    /// Anywhere in a square, with slow turns
    Meadow,
    /// Round after round of one closed path
    Rounds,
    /// Anywhere in a ball, turning about all axes (in space alone)
    Flight,
}

/// Poses that robots can walk through.
pub(crate) trait Walks<const DOF: usize>: LieGroup<DOF> {
    /// The paths of all robots, steps of about 1 m. Each attempt has others.
    fn walks(character: &Character, seed: u64, attempt: usize) -> Vec<Vec<Self>>;
}

impl Walks<3> for SE2 {
    fn walks(character: &Character, seed: u64, attempt: usize) -> Vec<Vec<Self>> {
        planar::walks(character, seed, attempt)
    }
}

impl Walks<6> for SE3 {
    fn walks(character: &Character, seed: u64, attempt: usize) -> Vec<Vec<Self>> {
        if character.world == World::Flight {
            return flight::walks(character, seed, attempt);
        }
        let terrain = Terrain::draw(&mut random(seed, "terrain"));
        let paths = planar::walks(character, seed, attempt);
        paths.iter().map(|path| path.iter().map(|pose| terrain.lift(pose)).collect()).collect()
    }
}

/// The random numbers of a robot's path.
fn path_of(robot: usize, seed: u64, attempt: usize) -> ChaCha8Rng {
    let again = if attempt == 0 { String::new() } else { format!(", attempt {attempt}") };
    random(seed, &format!("path of robot {robot}{again}"))
}
