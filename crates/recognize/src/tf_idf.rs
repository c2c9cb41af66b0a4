//! Term frequency times inverse document frequency (Sivic and Zisserman, *Video Google*, ICCV 2003): the similarity beside which the
//! probability is measured, and the inverted index that finds candidates by words.

use crate::Words;

/// An inverted index over the words of keyframes.
pub struct TfIdf<'a> {
    words: &'a Words,
    /// `ln(keyframes / keyframes with the word)`, squared.
    weight: Vec<f64>,
    /// The length of each keyframe's vector.
    norm: Vec<f64>,
    /// The keyframes with each word.
    seen_at: Vec<Vec<usize>>,
}

impl<'a> TfIdf<'a> {
    /// Indexes all keyframes. O(words of all keyframes).
    pub fn new(words: &'a Words) -> Self {
        let mut seen_at = vec![Vec::new(); words.vocabulary];
        for (keyframe, bag) in words.bags.iter().enumerate() {
            for &word in bag {
                seen_at[word].push(keyframe);
            }
        }
        let keyframes = words.bags.iter().filter(|bag| !bag.is_empty()).count() as f64;
        let weight: Vec<f64> =
            seen_at.iter().map(|at| (keyframes / at.len().max(1) as f64).ln().powi(2)).collect();
        let norm =
            words.bags.iter().map(|bag| bag.iter().map(|&word| weight[word]).sum::<f64>().sqrt()).collect();
        Self { words, weight, norm, seen_at }
    }

    /// The cosine of the vectors of two keyframes, 0 to 1. O(words of both).
    pub fn similarity(&self, one: usize, other: usize) -> f64 {
        let bag = &self.words.bags[other];
        let shared = self.words.bags[one].iter().filter(|word| bag.binary_search(word).is_ok());
        self.normalised(shared.map(|&word| self.weight[word]).sum(), one, other)
    }

    /// The keyframes most alike to one, at most `most`, of those that are wanted; the best first. O(keyframes that share a word).
    pub fn nearest(&self, keyframe: usize, most: usize, wanted: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut sums = vec![0.0; self.words.bags.len()];
        let mut touched = Vec::new();
        for &word in &self.words.bags[keyframe] {
            if self.weight[word] == 0.0 {
                continue;
            }
            for &other in &self.seen_at[word] {
                if sums[other] == 0.0 {
                    touched.push(other);
                }
                sums[other] += self.weight[word];
            }
        }
        let mut found: Vec<(f64, usize)> = touched
            .into_iter()
            .filter(|&other| wanted(other))
            .map(|other| (self.normalised(sums[other], keyframe, other), other))
            .collect();
        found.sort_by(|one, other| other.0.total_cmp(&one.0).then(one.1.cmp(&other.1)));
        found.into_iter().take(most).map(|(_, other)| other).collect()
    }

    fn normalised(&self, shared: f64, one: usize, other: usize) -> f64 {
        let norms = self.norm[one] * self.norm[other];
        if norms > 0.0 { shared / norms } else { 0.0 }
    }
}
