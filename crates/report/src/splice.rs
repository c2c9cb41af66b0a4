//! Replaces the sections of documents that programs write.

use anyhow::{Context as _, bail};

/// Replaces the text between the lines `<!-- begin: NAME -->` and `<!-- end: NAME -->` of a document. Empty lines
/// around `text` do not matter.
pub fn splice(document: &str, name: &str, text: &str) -> anyhow::Result<String> {
    let (begin, end) = (format!("<!-- begin: {name} -->\n"), format!("<!-- end: {name} -->\n"));
    let (before, rest) =
        document.split_once(&begin).with_context(|| format!("has no line {}", begin.trim_end()))?;
    let Some((_, after)) = rest.split_once(&end) else {
        bail!("has no line {} after {}", end.trim_end(), begin.trim_end());
    };
    Ok(format!("{before}{begin}\n{}\n\n{end}{after}", text.trim_start_matches('\n').trim_end()))
}
