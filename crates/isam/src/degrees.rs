//! Variables in lists by their degree.

/// No variable.
const NONE: usize = usize::MAX;

/// Degrees, and doubly linked lists of the variables that wait for elimination, one a degree. Every operation but
/// [`least`](Self::least) takes constant time.
#[derive(Debug, Default)]
pub(crate) struct Degrees {
    /// The degree of each variable. That of a variable in a list must not be changed.
    pub(crate) of: Vec<usize>,
    heads: Vec<usize>,
    next: Vec<usize>,
    previous: Vec<usize>,
}

impl Degrees {
    /// Degrees of zero and empty lists.
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

    /// Puts a variable first into the list of its degree.
    pub(crate) fn insert(&mut self, variable: usize) {
        let head = std::mem::replace(&mut self.heads[self.of[variable]], variable);
        self.next[variable] = head;
        self.previous[variable] = NONE;
        if head != NONE {
            self.previous[head] = variable;
        }
    }

    /// Takes a variable out of its list, if it is in one.
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

/// Empties a list and fills it again; its memory stays.
pub(crate) fn refill<T: Clone>(values: &mut Vec<T>, count: usize, value: T) {
    values.clear();
    values.resize(count, value);
}
