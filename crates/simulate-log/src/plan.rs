//! The building: blocks of rooms between corridors, in a rectangular pattern.

use posecut_random::{ChaCha8Rng, random};
use posecut_scan::Wall;
use rand::RngExt;

/// Width of a door, metres.
const DOOR: f64 = 1.0;

/// Rooms are at least this wide, metres.
const NARROWEST: f64 = 3.2;

/// A door between a corridor along x and a room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Door {
    /// The middle of the door, along the corridor.
    pub x: f64,
    /// How far the robot may drive into the room from the middle of the corridor; negative towards smaller y.
    pub depth: f64,
}

/// Walls, and where a robot may drive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plan {
    /// Everything that a beam can meet.
    pub walls: Vec<Wall>,
    /// The x of the middles of the corridors along y.
    pub columns: Vec<f64>,
    /// The y of the middles of the corridors along x.
    pub rows: Vec<f64>,
    /// For each corridor along x and each stretch between two corridors along y: its doors, by x.
    pub doors: Vec<Vec<Vec<Door>>>,
}

impl Plan {
    /// A building of `blocks` by `blocks` blocks. O(blocks^2).
    pub fn new(seed: u64, blocks: usize) -> Self {
        let mut random = random(seed, "building");
        let width = random.random_range(2.0..2.6);
        let mut middles = || {
            let mut at = 0.0;
            (0..=blocks)
                .map(|index| {
                    at += if index == 0 { 0.0 } else { random.random_range(9.0..14.0) + width };
                    at
                })
                .collect::<Vec<f64>>()
        };
        let (columns, rows) = (middles(), middles());
        let mut plan =
            Self { doors: vec![vec![Vec::new(); blocks]; blocks + 1], columns, rows, ..Self::default() };
        let half = 0.5 * width;
        let outer = |middles: &[f64]| [middles[0] - half, middles[blocks] + half];
        let ([left, right], [bottom, top]) = (outer(&plan.columns), outer(&plan.rows));
        plan.rectangle([left, bottom], [right, top]);
        plan.pilasters([left, bottom], [right, top], 1.0, &mut random);
        for column in 0..blocks {
            for row in 0..blocks {
                plan.block(column, row, half, &mut random);
            }
        }
        for doors in plan.doors.iter_mut().flatten() {
            doors.sort_by(|one, other| one.x.total_cmp(&other.x));
        }
        plan
    }

    fn wall(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.walls.push([from.into(), to.into()]);
    }

    fn rectangle(&mut self, [left, bottom]: [f64; 2], [right, top]: [f64; 2]) {
        let corners = [[left, bottom], [right, bottom], [right, top], [left, top]];
        for (index, corner) in corners.iter().enumerate() {
            self.wall(*corner, corners[(index + 1) % 4]);
        }
    }

    /// Pilasters on the left and right sides of a rectangle, and on the other two with `all`. They stand `side` towards its inside.
    fn pilasters(
        &mut self,
        [left, bottom]: [f64; 2],
        [right, top]: [f64; 2],
        side: f64,
        random: &mut ChaCha8Rng,
    ) {
        for (x, inwards) in [(left, side), (right, -side)] {
            for y in spread(bottom, top, random) {
                let depth = inwards * random.random_range(0.1..0.25);
                self.rectangle([x.min(x + depth), y - 0.2], [x.max(x + depth), y + 0.2]);
            }
        }
        if side > 0.0 {
            for (y, inwards) in [(bottom, side), (top, -side)] {
                for x in spread(left, right, random) {
                    let depth = inwards * random.random_range(0.1..0.25);
                    self.rectangle([x - 0.2, y.min(y + depth)], [x + 0.2, y.max(y + depth)]);
                }
            }
        }
    }

    /// A block: two bands of rooms, with doors to the corridors below and above.
    fn block(&mut self, column: usize, row: usize, half: f64, random: &mut ChaCha8Rng) {
        let (left, right) = (self.columns[column] + half, self.columns[column + 1] - half);
        let (bottom, top) = (self.rows[row] + half, self.rows[row + 1] - half);
        let middle = bottom + (top - bottom) * random.random_range(0.4..0.6);
        self.wall([left, bottom], [left, top]);
        self.wall([right, bottom], [right, top]);
        self.wall([left, middle], [right, middle]);
        self.pilasters([left, bottom], [right, top], -1.0, random);
        for (corridor, front) in [(row, bottom), (row + 1, top)] {
            let mut from = left;
            let mut start = left;
            while start < right {
                let rest = right - start;
                let size = if rest < 2.0 * NARROWEST {
                    rest
                } else {
                    random.random_range(NARROWEST..rest - NARROWEST + 1e-9)
                };
                let end = start + size;
                if end < right {
                    self.wall([end, front], [end, middle]);
                }
                let x = random.random_range(start + 0.9..end - 0.9);
                self.wall([from, front], [x - 0.5 * DOOR, front]);
                from = x + 0.5 * DOOR;
                let inside = middle - front;
                let depth = inside.signum() * (half + random.random_range(1.2..inside.abs() - 1.0));
                self.doors[corridor][column].push(Door { x, depth });
                self.furniture([start, end], [front, middle], x, random);
                start = end;
            }
            self.wall([from, front], [right, front]);
        }
    }

    /// Boxes beside the way of the robot.
    fn furniture(
        &mut self,
        [start, end]: [f64; 2],
        [front, back]: [f64; 2],
        door: f64,
        random: &mut ChaCha8Rng,
    ) {
        for _ in 0..random.random_range(1..4) {
            let size = [random.random_range(0.3..1.2), random.random_range(0.3..1.2)];
            let x = random.random_range(start + 0.7..end - 0.7);
            let y = front + (back - front) * random.random_range(0.3..0.8);
            if (x - door).abs() > 0.6 + 0.5 * size[0] {
                let corner = |sign: f64| [x + sign * 0.5 * size[0], y + sign * 0.5 * size[1]];
                self.rectangle(corner(-1.0), corner(1.0));
            }
        }
    }
}

/// Positions along a wall, 2 to 5 m apart.
fn spread(from: f64, to: f64, random: &mut ChaCha8Rng) -> Vec<f64> {
    let mut positions = Vec::new();
    let mut at = from;
    loop {
        at += random.random_range(2.0..5.0);
        if at > to - 0.5 {
            return positions;
        }
        positions.push(at);
    }
}
