//! The priors that marginalised poses leave, and their cliques in the tree.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use posecut_geometry::LieGroup;

use crate::prior::Prior;
use crate::tree::{NONE, Tree};

/// A prior, and its clique in the tree: one without frontal variables, whose update matrix is the prior's quadratic model.
#[derive(Debug)]
struct Listed<G, const DOF: usize> {
    prior: Prior<G, DOF>,
    clique: usize,
}

/// Priors by number, listed at their poses.
#[derive(Debug)]
pub(crate) struct Priors<G, const DOF: usize> {
    all: BTreeMap<usize, Listed<G, DOF>>,
    at: HashMap<usize, Vec<usize>>,
    next: usize,
    /// Priors whose cliques have to be written again.
    outdated: BTreeSet<usize>,
    /// The cost of marginalised edges that constrain no remaining pose.
    pub(crate) constant: f64,
}

impl<G: LieGroup<DOF>, const DOF: usize> Priors<G, DOF> {
    pub(crate) fn new() -> Self {
        Self { all: BTreeMap::new(), at: HashMap::new(), next: 0, outdated: BTreeSet::new(), constant: 0.0 }
    }

    /// Adds a prior. Its poses have to be eliminated again.
    pub(crate) fn add(&mut self, prior: Prior<G, DOF>, tree: &mut Tree) {
        let number = self.next;
        self.next += 1;
        for &node in &prior.nodes {
            self.at.entry(node).or_default().push(number);
        }
        let clique = tree.add();
        self.outdated.insert(number);
        self.all.insert(number, Listed { prior, clique });
    }

    /// Takes out the priors at these poses, in the order of their numbers. Their poses have to be eliminated again.
    pub(crate) fn take(&mut self, nodes: &[usize], tree: &mut Tree) -> Vec<Prior<G, DOF>> {
        let mut taken = Vec::new();
        for number in self.numbers(nodes) {
            let Some(Listed { prior, clique }) = self.all.remove(&number) else { continue };
            for node in &prior.nodes {
                if let Some(list) = self.at.get_mut(node) {
                    list.retain(|&other| other != number);
                    if list.is_empty() {
                        self.at.remove(node);
                    }
                }
            }
            self.outdated.remove(&number);
            tree.discard(clique);
            taken.push(prior);
        }
        taken
    }

    fn numbers(&self, nodes: &[usize]) -> BTreeSet<usize> {
        nodes.iter().filter_map(|node| self.at.get(node)).flatten().copied().collect()
    }

    /// The poses that share a prior with a pose, with repetitions, and with the pose itself.
    pub(crate) fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let numbers = self.at.get(&node).into_iter().flatten();
        numbers.flat_map(|number| self.all[number].prior.nodes.iter().copied())
    }

    /// Marks the priors at a pose to be expanded again.
    pub(crate) fn outdate(&mut self, node: usize) {
        if let Some(list) = self.at.get(&node) {
            self.outdated.extend(list);
        }
    }

    /// Expands the outdated priors at these points, for the poses that are variables.
    pub(crate) fn refresh(&mut self, points: &[G], fixed: &[bool], tree: &mut Tree) {
        for number in std::mem::take(&mut self.outdated) {
            let Listed { prior, clique } = &self.all[&number];
            prior.expand(points, |node| !fixed[node], tree.clique_mut(*clique));
        }
    }

    /// The cliques that hang on no other clique yet.
    pub(crate) fn loose(&self, tree: &Tree) -> Vec<usize> {
        let cliques = self.all.values().map(|listed| listed.clique);
        cliques.filter(|&clique| tree.clique(clique).parent == NONE).collect()
    }

    pub(crate) fn list(&self) -> impl Iterator<Item = &Prior<G, DOF>> {
        self.all.values().map(|listed| &listed.prior)
    }

    /// The cost at these poses, with that of edges that constrain no remaining pose.
    pub(crate) fn cost(&self, pose: impl Fn(usize) -> G) -> f64 {
        self.list().map(|prior| prior.cost(&pose)).fold(self.constant, |sum, cost| sum + cost)
    }

    /// Memory used, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.list().map(|prior| prior.scalars() * size_of::<f64>()).sum()
    }
}
