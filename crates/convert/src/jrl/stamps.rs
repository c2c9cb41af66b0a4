//! Stamps of entries: to which nodes they belong, and their unit, which the format leaves open.

use std::collections::{BTreeMap, BTreeSet};

use posecut_graph::Node;

use super::STAMP;
use crate::odometry::{frame, robot};

/// Seconds since 1970 of the years 2000 and 2100. In any unit, their ranges of stamps do not overlap.
const YEARS: std::ops::Range<i128> = 946_684_800..4_102_444_800;

/// A unit of time since 1970.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Unit {
    per_second: i128,
}

impl Unit {
    /// The unit in which all stamps are times between the years 2000 and 2100; `None` if there is none.
    pub(super) fn of(stamps: &(impl Iterator<Item = u64> + Clone)) -> Option<Self> {
        stamps.clone().next()?;
        [1, 1_000, 1_000_000, 1_000_000_000]
            .into_iter()
            .find(|unit| stamps.clone().all(|stamp| YEARS.contains(&(i128::from(stamp) / unit))))
            .map(|per_second| Self { per_second })
    }

    /// The time in microseconds, rounded.
    pub(super) fn microseconds(self, stamp: u64) -> i64 {
        let (stamp, half) = (i128::from(stamp) * 1_000_000, self.per_second / 2);
        // The range of years keeps it far below 2^63.
        ((stamp + half) / self.per_second) as i64
    }
}

/// The stamps of one robot's entries.
#[derive(Default)]
struct OfRobot {
    entries: Vec<u64>,
    /// The stamp of the first entry that names a key of the robot.
    first: BTreeMap<u64, u64>,
}

/// The stamps of all entries, by the name of the robot.
#[derive(Default)]
pub(super) struct Stamps(BTreeMap<String, OfRobot>);

impl Stamps {
    /// The next entry of a robot.
    pub(super) fn begin(&mut self, name: &str, stamp: Option<u64>) {
        self.0.entry(name.to_owned()).or_default().entries.extend(stamp);
    }

    /// A factor of the robot's last entry names these keys.
    pub(super) fn name(&mut self, name: &str, keys: impl Iterator<Item = u64>) {
        let Some(of_robot) = self.0.get_mut(name) else { return };
        let Some(&stamp) = of_robot.entries.last() else { return };
        for key in keys.filter(|&key| belongs(key, name)) {
            of_robot.first.entry(key).or_insert(stamp);
        }
    }

    /// Gives nodes their times, or their stamps if these are no times. If a robot has as many entries as poses, each entry belongs to
    /// one pose; otherwise a pose has the stamp of the first entry that names it.
    pub(super) fn set(&self, nodes: &mut [Node]) {
        let mut stamps: BTreeMap<u64, u64> = BTreeMap::new();
        for (name, of_robot) in &self.0 {
            let own: BTreeSet<u64> =
                nodes.iter().map(|node| node.id).filter(|&key| belongs(key, name)).collect();
            if own.len() == of_robot.entries.len() {
                stamps.extend(own.into_iter().zip(of_robot.entries.iter().copied()));
            } else {
                stamps.extend(&of_robot.first);
            }
        }
        let all = || stamps.values().copied();
        let unit = Unit::of(&all());
        // Stamps that are all equal, or count frames, say nothing.
        let first = all().next();
        let idle = all().all(|stamp| Some(stamp) == first)
            || stamps.iter().all(|(&key, &stamp)| frame(key) == stamp);
        for node in nodes {
            match (stamps.get(&node.id), unit) {
                (Some(&stamp), Some(unit)) => node.utime = Some(unit.microseconds(stamp)),
                (Some(&stamp), None) if !idle => {
                    node.extra.insert(STAMP.to_owned(), stamp.into());
                }
                _ => {}
            }
        }
    }
}

/// Whether a key is one of this robot. Keys without a letter may be of any.
fn belongs(key: u64, name: &str) -> bool {
    robot(key).is_none_or(|letter| name == letter.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_size_of_stamps_shows_their_unit() {
        let of = |stamps: &[u64]| Unit::of(&stamps.iter().copied());
        for unit in [1, 1_000, 1_000_000, 1_000_000_000] {
            let stamps = [1_327_194_947 * unit, 1_327_194_948 * unit];
            let found = of(&stamps).unwrap();
            assert_eq!(found.microseconds(stamps[0]), 1_327_194_947_000_000);
        }
        assert_eq!(
            of(&[1_327_194_947_000_001_500]).unwrap().microseconds(1_327_194_947_000_001_500),
            1_327_194_947_000_002
        );
        assert_eq!(of(&[0, 1, 2]), None);
        assert_eq!(of(&[1_327_194_947, 1_327_194_947_000]), None, "one unit for all");
        assert_eq!(of(&[]), None);
        assert_eq!(of(&[u64::MAX]), None);
    }
}
