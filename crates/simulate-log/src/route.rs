//! The way of the robot: a random walk along the corridors, into every third room it passes.

use nalgebra::Vector2;
use posecut_random::{ChaCha8Rng, random};
use rand::RngExt;

use crate::plan::Plan;

/// The share of doors that the robot enters.
const ENTERED: f64 = 0.3;

/// The robot keeps to the middle of a corridor up to this, metres.
const ASIDE: f64 = 0.2;

/// The corners of a way of at least this length, metres.
pub fn route(plan: &Plan, seed: u64, length: f64) -> Vec<Vector2<f64>> {
    let mut random = random(seed, "route");
    let mut at = [0_usize, 0_usize];
    let mut before: Option<[usize; 2]> = None;
    let mut way = vec![crossing(plan, at)];
    let mut driven = 0.0;
    while driven < length {
        let all = neighbours(plan, at);
        // Turn back only where there is no other way.
        let mut choices: Vec<[usize; 2]> = all.iter().copied().filter(|next| Some(*next) != before).collect();
        if choices.is_empty() {
            choices = all;
        }
        let next = choices[random.random_range(0..choices.len())];
        let start = way.len() - 1;
        if next[1] == at[1] {
            rooms(plan, at, next, &mut way, &mut random);
        }
        let aside = Vector2::from_fn(|_, _| random.random_range(-ASIDE..ASIDE));
        way.push(crossing(plan, next) + aside);
        driven += way[start..].windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>();
        (before, at) = (Some(at), next);
    }
    way
}

fn crossing(plan: &Plan, [column, row]: [usize; 2]) -> Vector2<f64> {
    Vector2::new(plan.columns[column], plan.rows[row])
}

fn neighbours(plan: &Plan, [column, row]: [usize; 2]) -> Vec<[usize; 2]> {
    let mut found = Vec::new();
    if column > 0 {
        found.push([column - 1, row]);
    }
    if column + 1 < plan.columns.len() {
        found.push([column + 1, row]);
    }
    if row > 0 {
        found.push([column, row - 1]);
    }
    if row + 1 < plan.rows.len() {
        found.push([column, row + 1]);
    }
    found
}

/// Visits rooms on the way between two crossings of one corridor along x.
fn rooms(
    plan: &Plan,
    at: [usize; 2],
    next: [usize; 2],
    way: &mut Vec<Vector2<f64>>,
    random: &mut ChaCha8Rng,
) {
    let doors = &plan.doors[at[1]][at[0].min(next[0])];
    let mut visited: Vec<_> = doors.iter().filter(|_| random.random_bool(ENTERED)).collect();
    if next[0] < at[0] {
        visited.reverse();
    }
    for door in visited {
        let y = plan.rows[at[1]];
        way.push(Vector2::new(door.x, y + random.random_range(-ASIDE..ASIDE)));
        way.push(Vector2::new(door.x, y + door.depth));
        way.push(Vector2::new(door.x, y + random.random_range(-ASIDE..ASIDE)));
    }
}
