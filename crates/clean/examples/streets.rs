//! Writes a large graph as g2o, to standard output: a walk through a grid of streets, closures where it comes back, and false ones.
//!
//! Usage: streets POSES CLOSURES SHARE-OF-FALSE-CLOSURES SEED

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::io::Write as _;

use nalgebra::Vector3;
use posecut_geometry::{LieGroup as _, SE2};
use posecut_random::{ChaCha8Rng, random};
use rand::RngExt as _;
use rand_distr::{Distribution as _, StandardNormal};

/// Distance of two crossings, steps of a metre.
const BLOCK: i64 = 10;
/// Standard deviations of a step of odometry and of a closure: metres, radians.
const STEP: (f64, f64) = (0.03, 0.003);
const CLOSURE: (f64, f64) = (0.1, 0.02);
/// A closure joins poses at least this many steps apart.
const APART: usize = 100;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [poses, closures, share, seed] = &arguments[..] else {
        return Err("usage: streets POSES CLOSURES SHARE-OF-FALSE-CLOSURES SEED".into());
    };
    let (poses, closures): (usize, usize) = (poses.parse()?, closures.parse()?);
    let mut random = random(seed.parse()?, "streets");
    let walk = walk(poses, &mut random);
    let truth: Vec<SE2> =
        walk.iter().map(|&(x, y, turn)| SE2::new(x as f64, y as f64, turn as f64 * FRAC_PI_2)).collect();
    let mut places: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (pose, &(x, y, _)) in walk.iter().enumerate() {
        places.entry((x, y)).or_default().push(pose);
    }
    let odometry: Vec<SE2> =
        truth.windows(2).map(|pair| noisy(&pair[0].between(&pair[1]), STEP, &mut random)).collect();
    let mut output = std::io::BufWriter::new(std::io::stdout().lock());
    let mut reckoned = SE2::identity();
    for pose in 0..poses {
        writeln!(output, "VERTEX_SE2 {pose} {}", numbers(&reckoned))?;
        reckoned = odometry.get(pose).map_or(reckoned, |step| reckoned.compose(step));
    }
    for (from, step) in odometry.iter().enumerate() {
        writeln!(output, "EDGE_SE2 {from} {} {} {}", from + 1, numbers(step), information(STEP))?;
    }
    let wrong = (closures as f64 * share.parse::<f64>()?) as usize;
    let mut written = 0;
    while written < closures {
        let to = random.random_range(APART..poses);
        let (from, motion) = if written < wrong {
            (random.random_range(0..=to - APART), SE2::identity())
        } else {
            let visits = &places[&(walk[to].0, walk[to].1)];
            let earlier = visits.partition_point(|&visit| visit + APART <= to);
            if earlier == 0 {
                continue;
            }
            let from = visits[random.random_range(0..earlier)];
            (from, truth[from].between(&truth[to]))
        };
        let motion = noisy(&motion, CLOSURE, &mut random);
        writeln!(output, "EDGE_SE2 {from} {to} {} {}", numbers(&motion), information(CLOSURE))?;
        written += 1;
    }
    Ok(output.flush()?)
}

/// Positions, and headings in quarter turns. The streets are so many that the walk visits each about five times.
fn walk(poses: usize, random: &mut ChaCha8Rng) -> Vec<(i64, i64, i64)> {
    let side = ((poses as f64 / 100.0).sqrt() as i64).max(2) * BLOCK;
    let ahead = |(x, y, turn): (i64, i64, i64)| {
        let (along, across) = [(1, 0), (0, 1), (-1, 0), (0, -1)][turn.rem_euclid(4) as usize];
        (x + along, y + across)
    };
    let (mut found, mut now) = (Vec::with_capacity(poses), (0, 0, 0));
    for _ in 0..poses {
        found.push(now);
        let (x, y) = ahead(now);
        let mut turn = now.2;
        if x % BLOCK == 0 && y % BLOCK == 0 {
            turn += random.random_range(-1..=1);
            let inside = |turn| {
                let (x, y) = ahead((x, y, turn));
                (0..=side).contains(&x) && (0..=side).contains(&y)
            };
            while !inside(turn) {
                turn += 1;
            }
        }
        now = (x, y, turn);
    }
    found
}

fn noisy(motion: &SE2, (metres, radians): (f64, f64), random: &mut ChaCha8Rng) -> SE2 {
    let mut normal = |sigma: f64| {
        let value: f64 = StandardNormal.sample(random);
        sigma * value
    };
    motion.compose(&SE2::exp(&Vector3::new(normal(metres), normal(metres), normal(radians))))
}

fn numbers(pose: &SE2) -> String {
    let components: Vec<String> = pose.components().iter().map(|number| format!("{number:.6}")).collect();
    components.join(" ")
}

fn information((metres, radians): (f64, f64)) -> String {
    let (translation, rotation) = (metres.powi(-2), radians.powi(-2));
    format!("{translation:.3} 0 0 {translation:.3} 0 {rotation:.3}")
}
