//! The largest distance of support edges: a number of frames, or the spacing of the candidates.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use serde::{Serialize, Serializer};

/// Pairs of sessions with fewer gaps than this at both ends take the spacing of all pairs together.
const FEWEST_GAPS: usize = 10;

/// The largest distance of a support edge at each end, in frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delta {
    /// The same number for all pairs of sessions.
    Frames(u32),
    /// The spacing of the candidates of each pair of sessions.
    Auto,
}

impl FromStr for Delta {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text == "auto" {
            return Ok(Self::Auto);
        }
        text.parse().map(Self::Frames).map_err(|_| "expected `auto` or a number of frames".to_owned())
    }
}

impl fmt::Display for Delta {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frames(frames) => write!(formatter, "{frames}"),
            Self::Auto => formatter.write_str("auto"),
        }
    }
}

impl Serialize for Delta {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Frames(frames) => serializer.serialize_u32(*frames),
            Self::Auto => serializer.serialize_str("auto"),
        }
    }
}

/// The spacing of candidates for each pair of sessions, in frames, as [`Delta`] uses it for `auto`.
///
/// `frames` has, for each pair of sessions, the frames of its candidates at either end. The spacing at one end is the median
/// gap between consecutive distinct frames; the spacing of the pair is the smaller one of both ends. False candidates fall
/// into the gaps and can only shorten the spacing, so that they seldom support each other. A pair with fewer than 10 gaps at
/// each end takes the spacing of the gaps of all pairs together. If these are fewer than 10, too, the spacing is 1.
/// O(candidates log candidates).
pub(crate) fn spacings<K: Copy + Ord>(frames: BTreeMap<K, [Vec<i64>; 2]>) -> BTreeMap<K, u32> {
    let gaps: BTreeMap<K, [Vec<u64>; 2]> =
        frames.into_iter().map(|(pair, ends)| (pair, ends.map(gaps_between))).collect();
    let mut pooled: [Vec<u64>; 2] = Default::default();
    for ends in gaps.values() {
        for (all, gaps) in pooled.iter_mut().zip(ends) {
            all.extend_from_slice(gaps);
        }
    }
    let fallback = spacing(pooled).unwrap_or(1);
    gaps.into_iter().map(|(pair, ends)| (pair, spacing(ends).unwrap_or(fallback))).collect()
}

fn gaps_between(mut frames: Vec<i64>) -> Vec<u64> {
    frames.sort_unstable();
    frames.dedup();
    frames.windows(2).map(|pair| pair[1].abs_diff(pair[0])).collect()
}

/// The smaller median of both ends, leaving out an end with too few gaps; `None` if both have too few.
fn spacing(ends: [Vec<u64>; 2]) -> Option<u32> {
    let median = |mut gaps: Vec<u64>| {
        let middle = gaps.len().checked_sub(1)? / 2;
        (gaps.len() >= FEWEST_GAPS).then(|| *gaps.select_nth_unstable(middle).1)
    };
    let [first, second] = ends.map(median);
    let smaller = first.into_iter().chain(second).min()?;
    Some(u32::try_from(smaller).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_pair(first: Vec<i64>, second: Vec<i64>) -> u32 {
        spacings(BTreeMap::from([((), [first, second])]))[&()]
    }

    #[test]
    fn the_spacing_is_the_smaller_median_gap() {
        let every_fifth: Vec<i64> = (0..40).map(|turn| 5 * turn).collect();
        let every_seventh: Vec<i64> = (0..40).map(|turn| 7 * turn).collect();
        assert_eq!(one_pair(every_fifth.clone(), every_seventh), 5);
        // One long gap in the overlap and repeated frames change nothing.
        let mut broken = every_fifth.clone();
        broken.extend_from_slice(&every_fifth);
        broken.extend((0..10).map(|turn| 5000 + 5 * turn));
        assert_eq!(one_pair(broken.clone(), broken), 5);
    }

    #[test]
    fn false_candidates_shorten_the_spacing_and_never_lengthen_it() {
        let mut frames: Vec<i64> = (0..40).map(|turn| 5 * turn).collect();
        frames.extend((0..200).map(|turn| (turn * 7919) % 200));
        assert_eq!(one_pair(frames.clone(), frames), 1);
    }

    #[test]
    fn pairs_with_few_candidates_take_the_spacing_of_all() {
        let many: Vec<i64> = (0..40).map(|turn| 5 * turn).collect();
        let frames = BTreeMap::from([
            (1, [many.clone(), many]),
            (2, [vec![0, 569], vec![3, 1000]]),
            (3, [vec![7], vec![7]]),
        ]);
        assert_eq!(spacings(frames), BTreeMap::from([(1, 5), (2, 5), (3, 5)]));
        assert_eq!(one_pair(vec![0, 569], vec![3, 1000]), 1);
        assert!(spacings(BTreeMap::<(), _>::new()).is_empty());
    }

    #[test]
    fn the_option_is_a_number_or_auto() {
        assert_eq!("auto".parse(), Ok(Delta::Auto));
        assert_eq!("3".parse(), Ok(Delta::Frames(3)));
        for text in ["-1", "1.5", "", "automatic"] {
            assert!(text.parse::<Delta>().is_err(), "{text}");
        }
        for delta in [Delta::Auto, Delta::Frames(1)] {
            assert_eq!(delta.to_string().parse(), Ok(delta));
        }
    }
}
