//! Lists of variables by degree.

/// No variable.
const NONE: usize = usize::MAX;

/// The degrees, and for each degree a doubly linked list of the variables that wait for elimination. Every operation but
/// [`least`](Self::least) takes constant time.
#[derive(Debug, Default)]
pub(crate) struct Degrees {
    /// The degree of each variable. It must not change while the variable is in a list.
    pub(crate) of: Vec<usize>,
    heads: Vec<usize>,
    next: Vec<usize>,
    previous: Vec<usize>,
}

impl Degrees {
    /// Sets all degrees to zero and empties the lists.
    pub(crate) fn clear(&mut self, variables: usize) {
        refill(&mut self.of, variables, 0);
        refill(&mut self.heads, variables + 1, NONE);
        refill(&mut self.next, variables, NONE);
        refill(&mut self.previous, variables, NONE);
    }

    /// The first variable of the lowest degree.
    pub(crate) fn least(&self) -> Option<usize> {
        self.heads.iter().copied().find(|&head| head != NONE)
    }

    /// Inserts a variable at the head of the list of its degree.
    pub(crate) fn insert(&mut self, variable: usize) {
        let head = std::mem::replace(&mut self.heads[self.of[variable]], variable);
        self.next[variable] = head;
        self.previous[variable] = NONE;
        if head != NONE {
            self.previous[head] = variable;
        }
    }

    /// Removes a variable from its list, if it is in one.
    pub(crate) fn withdraw(&mut self, variable: usize) {
        let (previous, next) = (self.previous[variable], self.next[variable]);
        if previous != NONE {
            self.next[previous] = next;
        } else if self.heads[self.of[variable]] == variable {
            self.heads[self.of[variable]] = next;
        }
        if next != NONE {
            self.previous[next] = previous;
        }
        self.next[variable] = NONE;
        self.previous[variable] = NONE;
    }
}

/// Empties a list and fills it again, in the memory it has.
pub(crate) fn refill<T: Clone>(values: &mut Vec<T>, count: usize, value: T) {
    values.clear();
    values.resize(count, value);
}
