//! Trees of words (Chow and Liu, *Approximating discrete probability distributions with dependence trees*, IEEE Transactions on
//! Information Theory 14, 1968).
//!
//! Words that stand for one thing are seen together, and counting each as evidence of its own would make a recogniser far too sure. The
//! tree conditions each word on the one that says most about it: among all trees it is the nearest to the joint distribution in
//! Kullback-Leibler divergence, and it maximises the sum of the mutual informations of its edges.

use posecut_graph::connectivity::Forest;

use crate::Words;

/// How often words are seen, alone and given their parents in the tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// The parent of each word; `None` for a root.
    pub parent: Vec<Option<usize>>,
    /// The probability of each word.
    pub marginal: Vec<f64>,
    /// The probability of each word if its parent is not seen, and if it is; the marginal for a root.
    pub given: Vec<[f64; 2]>,
}

/// Two words depend on each other only if their mutual information is above what chance gives: for independent words,
/// `2 n I` follows a chi-square distribution with one degree of freedom, which exceeds this once in a thousand.
const CHANCE: f64 = 10.83;

/// Keyframes added to every count, half with the word's marginal probability: no probability is 0 or 1.
const UNSEEN: f64 = 1.0;

impl Tree {
    /// The tree of the words seen at some keyframes. O(sum of squared bags, logarithmic factor).
    pub fn new(words: &Words, keyframes: &[usize]) -> Self {
        let total = keyframes.len() as f64;
        let mut counts = vec![0_u32; words.vocabulary];
        let mut pairs = Vec::new();
        for &keyframe in keyframes {
            let bag = &words.bags[keyframe];
            for (position, &word) in bag.iter().enumerate() {
                counts[word] += 1;
                pairs.extend(bag[..position].iter().map(|&other| (other as u32, word as u32)));
            }
        }
        pairs.sort_unstable();
        let mut edges: Vec<(f64, usize, usize, u32)> = pairs
            .chunk_by(|one, other| one == other)
            .filter_map(|equal| {
                let (one, other) = equal.first().map(|pair| (pair.0 as usize, pair.1 as usize))?;
                let both = equal.len() as u32;
                let information = mutual_information(total, counts[one], counts[other], both);
                (2.0 * total * information > CHANCE).then_some((information, one, other, both))
            })
            .collect();
        edges.sort_by(|a, b| b.0.total_cmp(&a.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut forest = Forest::new(words.vocabulary);
        let mut neighbours: Vec<Vec<(usize, u32)>> = vec![Vec::new(); words.vocabulary];
        for (_, one, other, both) in edges {
            if forest.join(one, other) {
                neighbours[one].push((other, both));
                neighbours[other].push((one, both));
            }
        }
        Self::rooted(total, &counts, &neighbours)
    }

    /// Directs the edges away from the first word of each part, and estimates the probabilities.
    fn rooted(total: f64, counts: &[u32], neighbours: &[Vec<(usize, u32)>]) -> Self {
        let marginal: Vec<f64> =
            counts.iter().map(|&count| (f64::from(count) + 0.5 * UNSEEN) / (total + UNSEEN)).collect();
        let mut given: Vec<[f64; 2]> = marginal.iter().map(|&probability| [probability; 2]).collect();
        let mut parent = vec![None; counts.len()];
        let mut reached = vec![false; counts.len()];
        for root in 0..counts.len() {
            if std::mem::replace(&mut reached[root], true) {
                continue;
            }
            let mut open = vec![root];
            while let Some(word) = open.pop() {
                for &(child, both) in &neighbours[word] {
                    if std::mem::replace(&mut reached[child], true) {
                        continue;
                    }
                    parent[child] = Some(word);
                    let share =
                        |seen: u32, of: f64| (f64::from(seen) + UNSEEN * marginal[child]) / (of + UNSEEN);
                    let with = f64::from(counts[word]);
                    given[child] = [share(counts[child] - both, total - with), share(both, with)];
                    open.push(child);
                }
            }
        }
        Self { parent, marginal, given }
    }
}

/// The mutual information of two words in nats, from the number of keyframes in all, with each, and with both.
fn mutual_information(total: f64, one: u32, other: u32, both: u32) -> f64 {
    let (one, other, both) = (f64::from(one), f64::from(other), f64::from(both));
    let term = |joint: f64, first: f64, second: f64| {
        if joint > 0.0 { joint / total * (joint * total / (first * second)).ln() } else { 0.0 }
    };
    term(both, one, other)
        + term(one - both, one, total - other)
        + term(other - both, total - one, other)
        + term(total - one - other + both, total - one, total - other)
}
