//! Writes lines of g2o and TORO: a tag, ids, numbers.

use std::fmt::Write as _;

/// Adds a line. Numbers have the fewest digits that read back to the same bits.
pub(crate) fn line(text: &mut String, tag: &str, ids: &[u64], numbers: &[f64]) {
    text.push_str(tag);
    // Writing to a string cannot fail.
    for id in ids {
        let _ = write!(text, " {id}");
    }
    for number in numbers {
        let _ = write!(text, " {number}");
    }
    text.push('\n');
}
