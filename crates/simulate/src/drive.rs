//! Drives a line in time: the robot's pose at every instant.

use nalgebra::Vector2;
use posecut_geometry::{SE3, wrap_angle};
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;
use rand_distr::{Distribution, Exp1};

use crate::campus::Campus;
use crate::noise::Wander;

/// Speed on a free path, m/s: the median of the real sessions.
const CRUISE: f64 = 1.36;
/// Sideways acceleration allowed in turns, which limits the speed, m/s^2.
const SIDEWAYS_ACCELERATION: f64 = 0.25;
/// Acceleration of the robot, m/s^2.
const ACCELERATION: f64 = 0.6;
/// Mean distance between stops, metres, and mean length of a stop, seconds.
const STOP_EVERY: f64 = 140.0;
const STOP_LASTS: f64 = 14.0;
/// Heading and curvature are differences over this many points on either side.
const WHEELBASE: usize = 4;

/// The robot at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instant {
    /// Seconds since the start.
    pub seconds: f64,
    /// World from body.
    pub pose: SE3,
    /// Forward speed, m/s.
    pub speed: f64,
    /// Turn rate, rad/s, clockwise seen from above.
    pub yaw_rate: f64,
}

/// Drives along a line until its end, with one instant every `period` seconds.
pub fn drive(campus: &Campus, line: &[Vector2<f64>], period: f64, draw: &mut ChaCha8Rng) -> Vec<Instant> {
    let track = Track::new(campus, line);
    let mut mood = Wander::new(draw, 0.06, 60.0);
    let mut next_stop = STOP_EVERY * exponential(draw);
    let mut stopped = 0.0;
    let (mut place, mut speed, mut seconds) = (0.0, 0.0, 0.0);
    let mut instants: Vec<Instant> = Vec::new();
    while place < track.length() {
        let (pose, curvature) = track.at(place);
        let yaw = pose.to_planar().angle();
        let yaw_rate = instants
            .last()
            .map_or(0.0, |last: &Instant| wrap_angle(yaw - last.pose.to_planar().angle()) / period);
        instants.push(Instant { seconds, pose, speed, yaw_rate });
        seconds += period;
        let turn_limit = (SIDEWAYS_ACCELERATION / curvature.abs().max(1e-6)).sqrt();
        let mut wanted = (CRUISE * (1.0 + mood.step(draw, period))).min(turn_limit).max(0.25);
        if place >= next_stop {
            if stopped <= 0.0 {
                stopped = STOP_LASTS * exponential(draw);
            }
            stopped -= period;
            wanted = 0.0;
            if stopped <= 0.0 {
                next_stop = place + STOP_EVERY * exponential(draw);
            }
        }
        speed += (wanted - speed).clamp(-ACCELERATION * period, ACCELERATION * period);
        place += speed * period;
    }
    instants
}

fn exponential(draw: &mut ChaCha8Rng) -> f64 {
    let unit: f64 = Exp1.sample(draw);
    // Limit the draw: a stop of an hour would be unrealistic.
    unit.min(6.0) + draw.random_range(0.0..1e-9)
}

/// A line with its length, heading, slope and curvature.
struct Track {
    places: Vec<f64>,
    poses: Vec<SE3>,
    curvatures: Vec<f64>,
}

impl Track {
    fn new(campus: &Campus, line: &[Vector2<f64>]) -> Self {
        let mut track = Self { places: Vec::new(), poses: Vec::new(), curvatures: Vec::new() };
        let mut place = 0.0;
        for (index, point) in line.iter().enumerate() {
            if index > 0 {
                place += (point - line[index - 1]).norm();
            }
            let (before, after) =
                (line[index.saturating_sub(WHEELBASE)], line[(index + WHEELBASE).min(line.len() - 1)]);
            let along = (after - before).try_normalize(1e-9).unwrap_or_else(Vector2::x);
            let right = Vector2::new(-along.y, along.x);
            let slope = |direction: &Vector2<f64>| {
                campus.height(&(point + direction)) - campus.height(&(point - direction))
            };
            // z points down: uphill the nose goes up, and the pitch is positive.
            let (pitch, roll) = ((0.5 * slope(&along)).atan(), -(0.5 * slope(&right)).atan());
            let yaw = along.y.atan2(along.x);
            track.places.push(place);
            track.poses.push(SE3::from_euler(point.x, point.y, -campus.height(point), roll, pitch, yaw));
        }
        for index in 0..line.len() {
            let (before, after) = (index.saturating_sub(WHEELBASE), (index + WHEELBASE).min(line.len() - 1));
            let turn =
                wrap_angle(track.poses[after].to_planar().angle() - track.poses[before].to_planar().angle());
            let way = (track.places[after] - track.places[before]).max(1e-3);
            track.curvatures.push(turn / way);
        }
        track
    }

    fn length(&self) -> f64 {
        self.places.last().copied().unwrap_or(0.0)
    }

    /// Pose and curvature at a position along the line.
    fn at(&self, place: f64) -> (SE3, f64) {
        let after = self.places.partition_point(|&known| known < place).clamp(1, self.places.len() - 1);
        let before = after - 1;
        let way = (self.places[after] - self.places[before]).max(1e-9);
        let fraction = ((place - self.places[before]) / way).clamp(0.0, 1.0);
        let pose = posecut_geometry::LieGroup::interpolate(&self.poses[before], &self.poses[after], fraction);
        (pose, self.curvatures[before])
    }
}
