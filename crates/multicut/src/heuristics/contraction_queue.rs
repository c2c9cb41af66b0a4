//! A priority queue of pairs of clusters.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap, VecDeque};

/// A priority: the larger first number comes first, and the second number breaks ties in the same way.
pub(crate) type Priority = (f64, u32);

/// Bits of the priority, tie-breaker, pair.
type Entry = (u64, u32, Reverse<(u32, u32)>);

/// A queue of pairs. Pairs of equal priority leave the queue in insertion order in buckets, and by number in a heap.
///
/// If priorities take few values, each value has a bucket, and a step costs the logarithm of the number of buckets. Otherwise
/// a heap is used.
pub(crate) enum ContractionQueue {
    Buckets(BTreeMap<(u64, u32), VecDeque<(u32, u32)>>),
    Heap(BinaryHeap<Entry>),
}

impl ContractionQueue {
    pub(crate) fn new(whole: bool) -> Self {
        if whole { Self::Buckets(BTreeMap::new()) } else { Self::Heap(BinaryHeap::new()) }
    }

    /// Adds a pair; its first priority must be positive.
    pub(crate) fn push(&mut self, priority: Priority, tail: u32, head: u32) {
        // The bits of positive floats sort like the numbers.
        let key = (priority.0.to_bits(), priority.1);
        match self {
            Self::Buckets(buckets) => buckets.entry(key).or_default().push_back((tail, head)),
            Self::Heap(heap) => heap.push((key.0, key.1, Reverse((tail.min(head), tail.max(head))))),
        }
    }

    pub(crate) fn pop(&mut self) -> Option<(Priority, u32, u32)> {
        match self {
            Self::Buckets(buckets) => {
                let mut last = buckets.last_entry()?;
                let (bits, tie) = *last.key();
                let pair = last.get_mut().pop_front();
                if last.get().is_empty() {
                    last.remove();
                }
                let (tail, head) = pair?;
                Some(((f64::from_bits(bits), tie), tail, head))
            }
            Self::Heap(heap) => {
                let (bits, tie, Reverse((tail, head))) = heap.pop()?;
                Some(((f64::from_bits(bits), tie), tail, head))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_forms_give_the_same_order_but_for_ties() {
        let pairs =
            [((2.0, 1), 0, 1), ((7.0, 0), 1, 2), ((2.0, 3), 2, 3), ((7.0, 5), 3, 4), ((1.0, 9), 4, 5)];
        for whole in [true, false] {
            let mut queue = ContractionQueue::new(whole);
            for (priority, tail, head) in pairs {
                queue.push(priority, tail, head);
            }
            let order: Vec<u32> = std::iter::from_fn(|| queue.pop()).map(|entry| entry.1).collect();
            assert_eq!(order, [3, 1, 2, 0, 4]);
        }
    }

    #[test]
    fn equal_priorities_wait_in_line() {
        let mut queue = ContractionQueue::new(true);
        for tail in [5, 3, 4] {
            queue.push((1.0, 0), tail, 9);
        }
        assert_eq!(std::iter::from_fn(|| queue.pop()).map(|entry| entry.1).collect::<Vec<_>>(), [5, 3, 4]);
    }
}
