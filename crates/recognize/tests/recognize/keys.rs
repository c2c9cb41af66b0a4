//! The index of keys answers as a search of all keys does.

use std::num::NonZero;

use posecut_recognize::keys::{Key, Keys};
use proptest::prelude::*;

/// Keys along a few directions that are no axes, some of them equal, as passages of one place are.
fn keys(numbers: &[[i32; 3]]) -> Vec<Key> {
    let direction = |which: i32, at: usize| f64::from((which * 7 + at as i32 * 3) % 11 - 5);
    let key = |number: &[i32; 3]| {
        std::array::from_fn(|at| {
            (0..3).map(|which| f64::from(number[which as usize]) * direction(which, at)).sum()
        })
    };
    numbers.iter().map(key).collect()
}

proptest! {
    #[test]
    fn the_index_finds_what_a_search_of_all_finds(
        numbers in prop::collection::vec(prop::array::uniform3(-9_i32..9), 1..300),
        position in 0_usize..300,
        count in 1_usize..60,
    ) {
        let keys = keys(&numbers);
        let position = position % keys.len();
        let squared =
            |other: &Key| other.iter().zip(&keys[position]).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let mut expected: Vec<f64> = keys.iter().map(squared).collect();
        expected.sort_by(f64::total_cmp);
        expected.truncate(count);
        let found = Keys::new(keys.clone()).nearest(position, NonZero::new(count).unwrap());
        prop_assert_eq!(found.iter().map(|(distance, _)| *distance).collect::<Vec<_>>(), expected);
        for (distance, other) in &found {
            prop_assert_eq!(*distance, squared(&keys[*other]));
        }
        for pair in found.windows(2) {
            prop_assert!(pair[0].0 < pair[1].0 || pair[0].1 < pair[1].1, "each once, the first of equal ones first");
        }
    }
}
