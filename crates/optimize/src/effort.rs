//! What a search may still cost. It counts operations, since a limit in seconds would make the result depend on the machine.

/// Operations that take as long as reading a byte of a matrix that is too large for the caches.
const OPERATIONS_OF_A_BYTE: f64 = 1.5;

/// Operations that are left.
#[derive(Debug)]
pub struct Effort {
    left: f64,
}

impl Effort {
    /// A limit in operations.
    pub(crate) fn of(operations: f64) -> Self {
        Self { left: operations }
    }

    /// Whether nothing is left.
    pub(crate) fn is_spent(&self) -> bool {
        self.left <= 0.0
    }

    /// How often something of this many operations may be done, up to a limit.
    pub(crate) fn affords(&self, operations: f64, limit: usize) -> usize {
        // The cast saturates: at 0 if nothing is left.
        ((self.left / operations) as usize).min(limit)
    }

    /// Counts operations on numbers in the caches.
    pub(crate) fn compute(&mut self, operations: f64) {
        self.left -= operations;
    }

    /// Counts triangular solves with a factor of this many bytes.
    pub(crate) fn substitute(&mut self, solves: usize, bytes: usize) {
        // Each solve reads the factor twice.
        self.left -= 2.0 * OPERATIONS_OF_A_BYTE * (solves * bytes) as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effort_is_spent_by_what_is_counted() {
        let mut effort = Effort::of(100.0);
        assert_eq!([effort.affords(30.0, 9), effort.affords(30.0, 2), effort.affords(0.0, 9)], [3, 2, 9]);
        effort.compute(40.0);
        effort.substitute(2, 10);
        assert!(effort.is_spent(), "40 operations and four readings of 10 bytes");
        assert_eq!(effort.affords(1.0, 9), 0);
    }
}
