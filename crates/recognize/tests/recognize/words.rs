//! Tables of words, trees of words, and the inverted index.

use posecut_graph::PoseGraph;
use posecut_recognize::Words;
use posecut_recognize::chow_liu::Tree;
use posecut_recognize::tf_idf::TfIdf;
use proptest::prelude::*;

fn graph() -> PoseGraph {
    let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":3}
{"kind":"node","id":5}
"#;
    PoseGraph::read("test", text.as_bytes()).unwrap()
}

#[test]
fn words_are_read_by_node_and_name() {
    let table = "node,word\n5,door\n3,wall\n5,wall\n5,door\n";
    let words = Words::read(&graph(), "words.csv", table.as_bytes()).unwrap();
    assert_eq!((words.bags, words.vocabulary), (vec![vec![1], vec![0, 1]], 2));
}

#[test]
fn what_is_no_table_of_words_is_refused_with_its_line() {
    for (table, expected) in [
        ("node,word\n3,door\n9,door\n", "words.csv, line 3: the graph has no node 9"),
        ("node,word\n3,\n", "words.csv, line 2: the word is empty"),
        ("node,word\n", "words.csv has no words"),
        ("keyframe,thing\n3,door\n", "words.csv is not a table of words; it needs a header line `node,word`"),
        ("node,word\nx,door\n", "words.csv is not a table of words"),
    ] {
        let said = format!("{:#}", Words::read(&graph(), "words.csv", table.as_bytes()).unwrap_err());
        assert!(said.starts_with(expected), "{said}");
    }
}

/// Bags of six words in which each depends on the one before.
fn chain(draws: &[[bool; 6]]) -> Words {
    let bag = |draw: &[bool; 6]| {
        let mut seen = draw[0];
        let mut bag = Vec::new();
        for (word, flip) in draw.iter().enumerate() {
            seen ^= *flip && word > 0;
            if seen {
                bag.push(word);
            }
        }
        bag
    };
    Words::new(draws.iter().map(bag).collect(), 6)
}

fn information(words: &Words, one: usize, other: usize) -> f64 {
    let total = words.bags.len() as f64;
    let share = |wanted: &dyn Fn(bool, bool) -> bool| {
        let count = words.bags.iter().filter(|bag| wanted(bag.contains(&one), bag.contains(&other))).count();
        count as f64 / total
    };
    let mut sum = 0.0;
    for (first, second) in [(false, false), (false, true), (true, false), (true, true)] {
        let joint = share(&|a, b| a == first && b == second);
        let product = share(&|a, _| a == first) * share(&|_, b| b == second);
        if joint > 0.0 {
            sum += joint * (joint / product).ln();
        }
    }
    sum
}

/// All parents of each of six words, as numbers in base 7: 6 is none.
fn is_forest(parents: [usize; 6]) -> bool {
    (0..6).all(|word| {
        let mut at = word;
        for _ in 0..6 {
            if parents[at] == 6 {
                return true;
            }
            at = parents[at];
        }
        false
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_forest_of_dependent_words_has_more_information(
        draws in prop::collection::vec((any::<bool>(), prop::array::uniform5(0.0..1.0)), 60..120),
        rates in prop::array::uniform5(0.02..0.5),
    ) {
        let draws: Vec<[bool; 6]> = draws
            .iter()
            .map(|(first, uniform)| {
                let mut draw = [*first; 6];
                for at in 0..5 {
                    draw[at + 1] = uniform[at] < rates[at];
                }
                draw
            })
            .collect();
        let words = chain(&draws);
        let all: Vec<usize> = (0..draws.len()).collect();
        let tree = Tree::new(&words, &all);
        let total = draws.len() as f64;
        // Edges that chance explains are not used.
        let gain = |one: usize, other: usize| {
            let value = information(&words, one, other);
            if one != other && 2.0 * total * value > 10.83 { value } else { 0.0 }
        };
        let gains: [[f64; 6]; 6] = std::array::from_fn(|one| std::array::from_fn(|other| gain(one, other)));
        let found: f64 =
            (0..6).filter_map(|word| tree.parent[word].map(|parent| gains[word][parent])).sum();
        let mut best: f64 = 0.0;
        for number in 0..7_usize.pow(6) {
            let mut parents = [0; 6];
            let mut rest = number;
            for parent in &mut parents {
                *parent = rest % 7;
                rest /= 7;
            }
            if is_forest(parents) {
                let sum = (0..6).filter(|word| parents[*word] < 6).map(|word| gains[word][parents[word]]).sum();
                best = best.max(sum);
            }
        }
        prop_assert!((found - best).abs() < 1e-9, "{found} is not {best}");
    }

    #[test]
    fn the_inverted_index_finds_what_a_search_of_all_finds(
        bags in prop::collection::vec(prop::collection::vec(0_usize..12, 0..8), 2..20),
    ) {
        let words = Words::new(bags, 12);
        let index = TfIdf::new(&words);
        for keyframe in 0..words.bags.len() {
            let found = index.nearest(keyframe, 5, |other| other != keyframe);
            let mut all: Vec<f64> = (0..words.bags.len())
                .filter(|other| *other != keyframe)
                .map(|other| index.similarity(keyframe, other))
                .filter(|similarity| *similarity > 0.0)
                .collect();
            all.sort_by(|one, other| other.total_cmp(one));
            all.truncate(5);
            let similarities: Vec<f64> =
                found.into_iter().map(|other| index.similarity(keyframe, other)).collect();
            prop_assert_eq!(similarities.len(), all.len());
            for (one, other) in similarities.iter().zip(&all) {
                prop_assert!((one - other).abs() < 1e-12);
            }
        }
    }
}
