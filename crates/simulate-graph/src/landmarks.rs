//! Correct landmark edges: a recogniser that finds places again.

use std::collections::{BTreeSet, HashMap};

use posecut_geometry::LieGroup;
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

use crate::Character;

/// A robot does not find the place again where it was fewer steps ago.
const APART: usize = 30;

/// A pose with the robot that was there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viewpoint<G> {
    pub(crate) robot: usize,
    pub(crate) pose: G,
}

/// The viewpoints of all robots, and which of them see the same.
pub(crate) struct Scene<'a, G, const DOF: usize> {
    /// One robot after the other.
    pub(crate) viewpoints: Vec<Viewpoint<G>>,
    pub(crate) character: &'a Character,
    /// All pairs that see the same place, the earlier viewpoint first, in ascending order.
    pub(crate) similar: Vec<(usize, usize)>,
}

impl<'a, G: LieGroup<DOF>, const DOF: usize> Scene<'a, G, DOF> {
    /// Finds the pairs that see the same place. O(n), as long as few viewpoints are within the radius of each other.
    pub(crate) fn new(paths: &[Vec<G>], character: &'a Character) -> Self {
        let of_robot = |(robot, path): (usize, &Vec<G>)| {
            path.iter().map(move |&pose| Viewpoint { robot, pose }).collect::<Vec<_>>()
        };
        let viewpoints = paths.iter().enumerate().flat_map(of_robot).collect();
        let cell = |place: [f64; 3]| place.map(|along| (along / character.radius).floor() as i64);
        let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        let mut scene = Self { viewpoints, character, similar: Vec::new() };
        for to in 0..scene.viewpoints.len() {
            let here = cell(scene.viewpoints[to].pose.translation());
            let mut found: Vec<usize> = neighbours(here)
                .filter_map(|near| cells.get(&near))
                .flatten()
                .copied()
                .filter(|&from| scene.may_match(from, to) && scene.sees_the_same(from, to))
                .collect();
            found.sort_unstable();
            scene.similar.extend(found.into_iter().map(|from| (from, to)));
            cells.entry(here).or_default().push(to);
        }
        scene.similar.sort_unstable();
        scene
    }

    /// The true motion from one viewpoint to another.
    pub(crate) fn motion(&self, from: usize, to: usize) -> G {
        self.viewpoints[from].pose.between(&self.viewpoints[to].pose)
    }

    /// Whether the recogniser compares these two at all: other robots, or the same one long before.
    pub(crate) fn may_match(&self, from: usize, to: usize) -> bool {
        self.viewpoints[from].robot != self.viewpoints[to].robot || from.abs_diff(to) >= APART
    }

    /// Whether the motion between two viewpoints is one that the recogniser can measure.
    pub(crate) fn is_in_sight(&self, motion: &G) -> bool {
        let [x, y, z] = motion.translation();
        x.hypot(y).hypot(z) <= self.character.radius && motion.rotation_angle() <= self.character.angle
    }

    fn sees_the_same(&self, from: usize, to: usize) -> bool {
        self.is_in_sight(&self.motion(from, to))
    }

    /// Draws correct edges: a place that is found again is followed for some steps, forwards on the one path and either way on the other.
    /// At least half of the pairs remain for mistakes between near viewpoints.
    pub(crate) fn recognised(&self, random: &mut ChaCha8Rng) -> BTreeSet<(usize, usize)> {
        let wanted = self.character.correct_edges.min(self.similar.len().div_ceil(2));
        let mut chosen = BTreeSet::new();
        while chosen.len() < wanted {
            let (mut from, mut to) = self.similar[random.random_range(0..self.similar.len())];
            let forwards = self.similar.binary_search(&(from + 1, to + 1)).is_ok();
            while chosen.len() < wanted && self.similar.binary_search(&(from, to)).is_ok() {
                chosen.insert((from, to));
                if from == 0 || random.random::<f64>() * self.character.run_length < 1.0 {
                    break;
                }
                (from, to) = (if forwards { from + 1 } else { from - 1 }, to + 1);
            }
        }
        chosen
    }
}

/// A cell and those around it.
fn neighbours([x, y, z]: [i64; 3]) -> impl Iterator<Item = [i64; 3]> {
    (0..27).map(move |index| [x + index % 3 - 1, y + index / 3 % 3 - 1, z + index / 9 - 1])
}
