//! What is drawn once for a graph.

use posecut_random::random;
use rand::RngExt as _;
use serde::Serialize;

use crate::{Mistake, Options, World};

/// Everything that distinguishes one graph from another but for the draws of single poses and edges.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Character {
    /// 2 or 3.
    pub dimension: u64,
    /// The kind of paths.
    pub world: World,
    /// The number of robots, each a session.
    pub robots: usize,
    /// The number of poses of each robot.
    pub poses: usize,
    /// Standard deviations that the covariance of a step of odometry claims, metres and radians.
    pub odometry_sigma: (f64, f64),
    /// The deviations of steps, in those that are claimed.
    pub odometry_ratio: f64,
    /// The share by which all lengths of a robot are wrong, standard deviation over robots.
    pub odometry_scale: f64,
    /// The turn that a robot adds to each step, radians, standard deviation over robots.
    pub odometry_turn: f64,
    /// The probability that a robot slips in a step: by about 1 m and 0.2 rad.
    pub slip_rate: f64,
    /// Standard deviations that the covariance of a landmark edge claims, metres and radians.
    pub landmark_sigma: (f64, f64),
    /// The deviations of correct landmark edges, in those that are claimed.
    pub landmark_ratio: f64,
    /// Whether the noise of landmark edges has heavy tails: Student's t with four degrees of freedom.
    pub heavy_tails: bool,
    /// The distance within which the recogniser finds a place again, metres.
    pub radius: f64,
    /// The angle within which it does, radians.
    pub angle: f64,
    /// The mean number of successive edges by which it follows a place that it found.
    pub run_length: f64,
    /// The largest number of correct edges.
    pub correct_edges: usize,
    /// The share of incorrect edges among all landmark edges.
    pub incorrect_rate: f64,
    /// The kinds of mistakes, with their shares.
    pub mistakes: Vec<(Mistake, f64)>,
}

/// Draws of one seed. Each name has a stream of its own, so that what an option fixes changes nothing else.
struct Draws(u64);

impl Draws {
    /// Uniform between 0 and 1.
    fn unit(&self, name: &str) -> f64 {
        random(self.0, &format!("character: {name}")).random()
    }

    /// A number whose logarithm is uniform.
    fn between(&self, name: &str, least: f64, most: f64) -> f64 {
        least * (most / least).powf(self.unit(name))
    }

    /// Whether an event of this probability happens.
    fn happens(&self, name: &str, probability: f64) -> bool {
        self.unit(name) < probability
    }

    /// The first entry whose cumulated share exceeds the draw.
    fn one_of<T: Copy>(&self, name: &str, shares: &[(T, f64)]) -> T {
        let mut left = self.unit(name) * shares.iter().map(|(_, share)| share).sum::<f64>();
        for &(entry, share) in shares {
            if left < share {
                return entry;
            }
            left -= share;
        }
        shares[shares.len() - 1].0
    }
}

impl Character {
    /// Draws what the options leave open. The README has the distributions.
    pub fn draw(options: &Options) -> Self {
        let draws = Draws(options.seed);
        let flies = options.world == Some(World::Flight);
        let drawn = if flies || draws.happens("space", 0.3) { 3 } else { 2 };
        let dimension = options.dimension.unwrap_or(drawn);
        let flight = if dimension == 3 { 0.3 } else { 0.0 };
        let worlds =
            [(World::Streets, 0.35), (World::Meadow, 0.35), (World::Rounds, 0.3), (World::Flight, flight)];
        let robots = [(1, 0.5), (2, 0.25), (3, 0.15), (4, 0.1)];
        let claims = [((0.5, 2.0), 0.6), ((2.0, 8.0), 0.2), ((0.1, 0.5), 0.2)];
        let (least, most) = draws.one_of("how sure odometry is", &claims);
        let only = |name: &str, probability, value: f64| {
            if draws.happens(name, probability) { value } else { 0.0 }
        };
        Self {
            dimension,
            world: options.world.unwrap_or_else(|| draws.one_of("world", &worlds)),
            robots: options.robots.map_or_else(|| draws.one_of("robots", &robots), |robots| robots as usize),
            poses: options
                .poses
                .map_or_else(|| draws.between("poses", 150.0, 800.0) as usize, |poses| poses as usize),
            odometry_sigma: (
                draws.between("odometry, translation", 0.005, 0.05),
                draws.between("odometry, rotation", 0.0005, 0.01),
            ),
            odometry_ratio: options
                .odometry_ratio
                .unwrap_or_else(|| draws.between("odometry ratio", least, most)),
            odometry_scale: only("wrong scale", 0.4, 0.02),
            odometry_turn: only("wrong turn", 0.3, 5e-4),
            slip_rate: only("slips", 0.3, draws.between("slip rate", 1.0 / 400.0, 1.0 / 100.0)),
            landmark_sigma: (
                draws.between("landmark edges, translation", 0.03, 0.3),
                draws.between("landmark edges, rotation", 0.005, 0.05),
            ),
            landmark_ratio: options
                .landmark_ratio
                .unwrap_or_else(|| draws.between("landmark ratio", 0.3, 3.0)),
            heavy_tails: draws.happens("heavy tails", 0.2),
            radius: draws.between("radius", 1.0, 4.0),
            angle: draws.between("angle", 0.5, std::f64::consts::PI),
            run_length: draws.between("run length", 1.0, 8.0),
            correct_edges: options
                .correct_edges
                .map_or_else(|| draws.between("correct edges", 20.0, 400.0) as usize, |edges| edges as usize),
            incorrect_rate: options
                .incorrect_rate
                .unwrap_or_else(|| only("mistakes", 0.9, 0.8 * draws.unit("rate"))),
            mistakes: mistakes(&draws, &options.incorrect_kind),
        }
    }
}

/// The given kinds in equal shares; or one kind, two or all, in drawn shares.
fn mistakes(draws: &Draws, given: &[Mistake]) -> Vec<(Mistake, f64)> {
    if !given.is_empty() {
        return given.iter().map(|&kind| (kind, 1.0 / given.len() as f64)).collect();
    }
    let number = draws.one_of("kinds of mistakes", &[(1, 0.5), (2, 0.3), (Mistake::ALL.len(), 0.2)]);
    let mut left = Mistake::ALL.to_vec();
    let mut found = Vec::new();
    for place in 0..number {
        let next = (draws.unit(&format!("kind {place}")) * left.len() as f64) as usize;
        found.push((left.remove(next.min(left.len() - 1)), 0.1 + draws.unit(&format!("share {place}"))));
    }
    let sum: f64 = found.iter().map(|(_, share)| share).sum();
    found.into_iter().map(|(kind, share)| (kind, share / sum)).collect()
}
