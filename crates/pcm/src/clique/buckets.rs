//! A queue of vertices by small keys that only decrease.

const NONE: u32 = u32::MAX;

/// Vertices in doubly linked lists, one list for each key. Every operation is O(1) amortised.
pub(super) struct Buckets {
    head: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
    key: Vec<u32>,
}

impl Buckets {
    /// An empty queue for `vertices` vertices with keys up to `largest`.
    pub(super) fn new(vertices: usize, largest: usize) -> Self {
        Self {
            head: vec![NONE; largest + 1],
            next: vec![NONE; vertices],
            previous: vec![NONE; vertices],
            key: vec![0; vertices],
        }
    }

    pub(super) fn key(&self, vertex: usize) -> usize {
        self.key[vertex] as usize
    }

    /// The vertex that was last inserted under this key.
    pub(super) fn first(&self, key: usize) -> Option<usize> {
        let vertex = self.head[key];
        (vertex != NONE).then_some(vertex as usize)
    }

    pub(super) fn insert(&mut self, vertex: usize, key: usize) {
        let old = self.head[key];
        self.key[vertex] = key as u32;
        self.next[vertex] = old;
        self.previous[vertex] = NONE;
        if old != NONE {
            self.previous[old as usize] = vertex as u32;
        }
        self.head[key] = vertex as u32;
    }

    pub(super) fn remove(&mut self, vertex: usize) {
        let (next, previous) = (self.next[vertex], self.previous[vertex]);
        if next != NONE {
            self.previous[next as usize] = previous;
        }
        if previous == NONE {
            self.head[self.key[vertex] as usize] = next;
        } else {
            self.next[previous as usize] = next;
        }
    }

    pub(super) fn decrease(&mut self, vertex: usize) {
        let key = self.key[vertex] as usize;
        self.remove(vertex);
        self.insert(vertex, key - 1);
    }
}
