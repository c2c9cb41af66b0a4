//! Markdown tables.

/// Lines of a table. The first `left` columns are aligned left, the others right.
pub(crate) fn table(head: &[String], left: usize, rows: &[Vec<String>]) -> Vec<String> {
    let right = head.len() - left;
    let mut lines = vec![row(head), format!("|{}{}", "---|".repeat(left), "---:|".repeat(right))];
    lines.extend(rows.iter().map(|cells| row(cells)));
    lines
}

/// One line of a table.
pub(crate) fn row(cells: &[impl AsRef<str>]) -> String {
    let cells: Vec<&str> = cells.iter().map(AsRef::as_ref).collect();
    format!("| {} |", cells.join(" | "))
}

/// Words as cells.
pub(crate) fn cells(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}
