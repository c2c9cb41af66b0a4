//! The index of keys answers as a search of all keys does, or nearly.

use posecut_random::rand::RngExt as _;
use posecut_random::random;
use posecut_recognize::keys::{Key, Keys, SEARCHED};
use posecut_recognize::polar_context::KEY;
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

fn squared(one: &Key, other: &Key) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum()
}

/// What a search of all keys finds.
fn searched(
    keys: &[Key],
    position: usize,
    most: usize,
    elsewhere: impl Fn(usize) -> bool,
) -> Vec<(f64, usize)> {
    let others = (0..keys.len()).filter(|other| elsewhere(*other));
    let mut found: Vec<(f64, usize)> =
        others.map(|other| (squared(&keys[position], &keys[other]), other)).collect();
    found.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
    found.truncate(most);
    found
}

proptest! {
    #[test]
    fn few_keys_are_searched_as_a_whole(
        numbers in prop::collection::vec(prop::array::uniform3(-9_i32..9), 1..300),
        position in 0_usize..300,
        most in 0_usize..60,
        beside in 0_usize..40,
    ) {
        let keys = keys(&numbers);
        let position = position % keys.len();
        let elsewhere = |other: usize| other.abs_diff(position) > beside;
        let expected = searched(&keys, position, most, elsewhere);
        prop_assert_eq!(Keys::new(keys).nearest(position, most, elsewhere), expected);
    }
}

/// A route along which keys change slowly, driven several times.
fn route(keyframes: usize, passes: usize) -> Vec<Key> {
    let mut random = random(7, "route of keys");
    let waves: Vec<[f64; 3]> =
        (0..KEY).map(|_| std::array::from_fn(|_| random.random_range(-1.0..1.0))).collect();
    let mut keys = Vec::new();
    for _ in 0..passes {
        for keyframe in 0..keyframes / passes {
            let along = keyframe as f64;
            keys.push(std::array::from_fn(|at| {
                let [fast, slow, phase] = waves[at];
                (0.02 * fast * along + phase).sin()
                    + (0.005 * slow * along).cos()
                    + 0.05 * random.random_range(-1.0..1.0)
            }));
        }
    }
    keys
}

#[test]
fn of_many_keys_nearly_all_nearest_are_found() {
    let keys = route(3 * SEARCHED, 6);
    let index = Keys::new(keys.clone());
    let (mut found, mut expected) = (0, 0);
    for position in (0..keys.len()).step_by(97) {
        let elsewhere = |other: usize| other.abs_diff(position) > 30;
        let truth = searched(&keys, position, 50, elsewhere);
        let nearest = index.nearest(position, 50, elsewhere);
        assert_eq!(nearest.len(), truth.len());
        assert!(nearest.windows(2).all(|pair| pair[0] < pair[1]), "each once, the nearest first");
        assert!(nearest.iter().all(|(distance, other)| {
            elsewhere(*other) && *distance == squared(&keys[position], &keys[*other])
        }));
        found += nearest.iter().filter(|neighbour| truth.contains(neighbour)).count();
        expected += truth.len();
    }
    let share = f64::from(found as u32) / f64::from(expected as u32);
    assert!(share > 0.95, "{share}");
}

#[test]
fn where_nearly_all_are_beside_the_index_goes_on_until_it_has_enough() {
    let keys = route(SEARCHED + 100, 1);
    let elsewhere = |other: usize| other.is_multiple_of(100);
    let found = Keys::new(keys.clone()).nearest(50, 40, elsewhere);
    assert_eq!(found.len(), 40);
    // With fewer elsewhere than are asked for, all of them.
    let found = Keys::new(keys.clone()).nearest(50, 50, elsewhere);
    assert_eq!(found, searched(&keys, 50, 50, elsewhere));
}

#[test]
fn equal_keys_are_one_group() {
    let keys = vec![[1.0; KEY]; SEARCHED + 1];
    let found = Keys::new(keys).nearest(5, 3, |other| other != 5);
    assert_eq!(found, [(0.0, 0), (0.0, 1), (0.0, 2)]);
}
