//! Sections of documents: the text between `<!-- begin: NAME -->` and `<!-- end: NAME -->`.

use std::path::Path;

use anyhow::Context as _;

use crate::splice::splice;

/// Replaces a section of a document, and writes the document only if it changes.
///
/// # Errors
/// If the document has no such section, or cannot be read or written.
pub fn replace(document: &Path, name: &str, text: &str) -> anyhow::Result<()> {
    let place = || format!("{}: cannot be used", document.display());
    let before = std::fs::read_to_string(document).with_context(place)?;
    let after = splice(&before, name, text).with_context(place)?;
    if after != before {
        std::fs::write(document, after).with_context(place)?;
    }
    Ok(())
}

/// The cells of the tables in a section, for measurements that keep some of the rows.
///
/// # Errors
/// If the document has no such section, or cannot be read.
pub fn rows(document: &Path, name: &str) -> anyhow::Result<Vec<Vec<String>>> {
    let place = || format!("{}: cannot be used", document.display());
    let text = std::fs::read_to_string(document).with_context(place)?;
    let (begin, end) = (format!("<!-- begin: {name} -->\n"), format!("<!-- end: {name} -->"));
    let (_, rest) = text
        .split_once(&begin)
        .with_context(|| format!("has no line {}", begin.trim_end()))
        .with_context(place)?;
    let (section, _) =
        rest.split_once(&end).with_context(|| format!("has no line {end}")).with_context(place)?;
    Ok(section.lines().filter_map(cells).collect())
}

/// The cells of a row of a Markdown table.
fn cells(line: &str) -> Option<Vec<String>> {
    let inside = line.strip_prefix('|')?.strip_suffix('|')?;
    Some(inside.split('|').map(|cell| cell.trim().to_owned()).collect())
}
