//! Scans by time.

/// The position of the one nearest to a time, the earlier of two; `None` if all are further away than `within` microseconds. Times ascend.
/// O(log n).
pub fn nearest<T>(timed: &[(i64, T)], time: i64, within: u64) -> Option<usize> {
    let after = timed.partition_point(|(stamp, _)| *stamp < time);
    let distance = |index: &usize| timed[*index].0.abs_diff(time);
    let candidates = after.saturating_sub(1)..(after + 1).min(timed.len());
    candidates.min_by_key(distance).filter(|index| distance(index) <= within)
}
