//! Makes names safe in tables. They come from files of unknown origin.

/// Text in one line of Markdown that can neither end a cell nor start an HTML element.
pub(crate) fn inline(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        match character {
            '|' => escaped.push_str("\\|"),
            '<' if characters
                .peek()
                .is_some_and(|next| next.is_ascii_alphabetic() || "/!?".contains(*next)) =>
            {
                escaped.push_str("&lt;");
            }
            other if other.is_control() => escaped.push(' '),
            other => escaped.push(other),
        }
    }
    escaped
}

/// Text in a cell of a spreadsheet. A spreadsheet reads text that starts with one of these signs as a formula; an
/// apostrophe before it prevents that. Numbers do not change.
pub(crate) fn cell_text(text: String) -> String {
    let formula = text.starts_with(['=', '+', '-', '@', '\t', '\r', '\n']) && text.parse::<f64>().is_err();
    if formula { format!("'{text}") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_end_no_cell_and_begin_no_element() {
        assert_eq!(inline("a|b\n<script>c</script> 1 < 2"), "a\\|b &lt;script>c&lt;/script> 1 < 2");
    }

    #[test]
    fn formulas_become_text_and_numbers_stay() {
        for formula in ["=1+1", "+A1", "-A1", "@SUM(A1)", "\t=1", "\r=1", "=cmd|' /C calc'!A0"] {
            assert_eq!(cell_text(formula.to_owned()), format!("'{formula}"));
        }
        for text in ["-1.5", "+3", "2012-01-22", "pcm+gc", ""] {
            assert_eq!(cell_text(text.to_owned()), text);
        }
    }
}
