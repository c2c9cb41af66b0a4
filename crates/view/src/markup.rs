//! Puts text into markup. Names of sessions and labels come from files of unknown origin.

/// Text that cannot end the element or attribute that contains it.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            other => escaped.push(other),
        }
    }
    escaped
}

/// JSON that cannot end the script element that contains it, nor break a line of a script.
pub fn json(text: &str) -> String {
    text.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
}

/// Replaces every `{{name}}` of a template in one pass: inserted text is not searched again.
///
/// # Panics
/// If `value` does not know a name of the template. Both are part of this crate, so this is a bug.
pub fn fill(template: &str, value: impl Fn(&str) -> Option<String>) -> String {
    let mut parts = template.split("{{");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, rest) = part.split_once("}}").expect("every {{ of a template has its }}");
        text.push_str(&value(name).expect("every name of a template is known"));
        text.push_str(rest);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_text_stays_text() {
        assert_eq!(escape("<script>&\"'"), "&lt;script&gt;&amp;&quot;&#39;");
        assert_eq!(json("\"</script><!--\""), "\"\\u003c/script\\u003e\\u003c!--\"");
    }

    #[test]
    fn what_is_filled_in_is_not_filled_again() {
        let text = fill("a {{one}} b {{two}}", |name| {
            Some(if name == "one" { "{{two}}".to_owned() } else { "2".to_owned() })
        });
        assert_eq!(text, "a {{two}} b 2");
    }
}
