//! Numbers with their nouns.

/// `1 group`, `2 groups`: the number with the singular, or with an s.
pub fn counted(number: usize, singular: &str) -> String {
    if number == 1 { format!("1 {singular}") } else { format!("{number} {singular}s") }
}
