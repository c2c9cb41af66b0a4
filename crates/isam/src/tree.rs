//! The tree of cliques.

/// No clique, or no parent.
pub(crate) const NONE: usize = usize::MAX;

/// Frontal variables eliminated given a separator: a dense front of the factorisation.
#[derive(Debug, Default)]
pub(crate) struct Clique {
    /// Frontal variables, then the separator, in the order of elimination at the time it was made.
    pub(crate) variables: Vec<usize>,
    /// Number of frontal variables.
    pub(crate) frontals: usize,
    /// The clique that takes the update, or [`NONE`].
    pub(crate) parent: usize,
    /// The cliques whose updates this one takes.
    pub(crate) children: Vec<usize>,
    /// `[L; M; y^T]`, column-major: as many columns as frontal scalars, rows for all variables and the right-hand side.
    pub(crate) panel: Vec<f64>,
    /// The update matrix on the separator and the right-hand side: `-[M; y^T] [M; y^T]^T` plus the children's, lower
    /// triangle, column-major.
    pub(crate) update: Vec<f64>,
    /// Frontal nodes with an undetermined direction.
    pub(crate) undetermined: Vec<usize>,
    /// Whether the clique is about to be removed.
    marked: bool,
}

/// Cliques by number. Numbers and their memory are reused.
#[derive(Debug, Default)]
pub(crate) struct Tree {
    cliques: Vec<Clique>,
    free: Vec<usize>,
    /// The clique in which each variable is frontal, or [`NONE`].
    pub(crate) of: Vec<usize>,
}

/// A removed clique with more scalars than this frees its memory: small amounts are reused, large ones could pile up in small
/// cliques.
const KEPT_SCALARS: usize = 1 << 12;

impl Tree {
    /// Adds a node that is not a variable yet.
    pub(crate) fn add_node(&mut self) {
        self.of.push(NONE);
    }

    pub(crate) fn clique(&self, index: usize) -> &Clique {
        &self.cliques[index]
    }

    pub(crate) fn clique_mut(&mut self, index: usize) -> &mut Clique {
        &mut self.cliques[index]
    }

    /// Takes a clique out of the tree to work on it, until [`put_back`](Self::put_back).
    pub(crate) fn take(&mut self, index: usize) -> Clique {
        std::mem::take(&mut self.cliques[index])
    }

    pub(crate) fn put_back(&mut self, index: usize, clique: Clique) {
        self.cliques[index] = clique;
    }

    /// Adds a clique without children.
    pub(crate) fn add(&mut self) -> usize {
        let index = self.free.pop().unwrap_or_else(|| {
            self.cliques.push(Clique::default());
            self.cliques.len() - 1
        });
        self.cliques[index].parent = NONE;
        index
    }

    /// Marks a clique and its ancestors, and lists those that were not marked yet.
    pub(crate) fn mark_to_root(&mut self, mut index: usize, marked: &mut Vec<usize>) {
        while index != NONE && !std::mem::replace(&mut self.cliques[index].marked, true) {
            marked.push(index);
            index = self.cliques[index].parent;
        }
    }

    /// Removes the marked cliques. Appends their frontal variables and their unmarked children to the lists.
    pub(crate) fn remove(&mut self, marked: &[usize], frontals: &mut Vec<usize>, orphans: &mut Vec<usize>) {
        for &index in marked {
            let clique = &self.cliques[index];
            frontals.extend_from_slice(&clique.variables[..clique.frontals]);
            orphans.extend(clique.children.iter().copied().filter(|&child| !self.cliques[child].marked));
        }
        for &index in marked {
            self.free(index);
        }
        for &orphan in orphans.iter() {
            self.cliques[orphan].parent = NONE;
        }
    }

    fn free(&mut self, index: usize) {
        let clique = &mut self.cliques[index];
        for memory in [&mut clique.panel, &mut clique.update] {
            memory.clear();
            if memory.capacity() > KEPT_SCALARS {
                *memory = Vec::new();
            }
        }
        clique.variables.clear();
        clique.frontals = 0;
        clique.children.clear();
        clique.undetermined.clear();
        clique.marked = false;
        self.free.push(index);
    }

    /// Takes a clique without parent out of the tree for good.
    pub(crate) fn extract(&mut self, index: usize) -> Clique {
        self.free.push(index);
        self.take(index)
    }

    /// Removes a clique without children, whose parent is about to be made again.
    pub(crate) fn discard(&mut self, index: usize) {
        let parent = std::mem::replace(&mut self.cliques[index].parent, NONE);
        if parent != NONE {
            self.cliques[parent].children.retain(|&child| child != index);
        }
        self.free(index);
    }

    /// Blocks of all cliques: `frontals * variables` of the panel, `separator^2` of the update matrix.
    pub(crate) fn blocks(&self) -> usize {
        let blocks = |clique: &Clique| {
            let separator = clique.variables.len() - clique.frontals;
            clique.frontals * clique.variables.len() + separator * separator
        };
        self.cliques.iter().map(blocks).sum()
    }

    /// Memory used, in scalars.
    pub(crate) fn scalars(&self) -> usize {
        self.cliques.iter().map(|clique| clique.panel.capacity() + clique.update.capacity()).sum()
    }
}
