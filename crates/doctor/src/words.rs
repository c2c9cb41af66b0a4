//! Numbers as readers expect them.

/// `1 edge`, `2 edges`.
pub(crate) fn counted(number: usize, singular: &str) -> String {
    match (number, singular.strip_suffix("trix")) {
        (1, _) => format!("1 {singular}"),
        (_, Some(stem)) => format!("{number} {stem}trices"),
        _ => format!("{number} {singular}s"),
    }
}

/// Three significant digits, without an exponent between 0.0001 and a million.
pub(crate) fn figure(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() {
        return format!("{value}");
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.1e}");
    }
    let magnitude = size.log10().floor() as i32;
    if magnitude > 2 {
        let unit = 10_f64.powi(magnitude - 2);
        return format!("{:.0}", (value / unit).round() * unit);
    }
    let decimals = (2 - magnitude) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A share as a percentage; 100 % and 0 % only if they are exact.
pub(crate) fn percent(part: usize, whole: usize) -> String {
    if part == 0 || part == whole {
        return format!("{} %", if part == 0 { 0 } else { 100 });
    }
    let share = 100.0 * part as f64 / whole as f64;
    if share < 1.0 {
        "under 1 %".to_owned()
    } else if share > 99.0 {
        "over 99 %".to_owned()
    } else {
        format!("{share:.0} %")
    }
}

/// The first names, and how many others there are.
pub(crate) fn listed<T: AsRef<str>>(names: &[T], most: usize) -> String {
    let shown: Vec<&str> = names.iter().take(most).map(AsRef::as_ref).collect();
    let others = names.len().saturating_sub(most);
    let more = if others > 0 { format!(" and {others} more") } else { String::new() };
    shown.join(", ") + &more
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_three_digits() {
        for (value, text) in [
            (0.3, "0.3"),
            (0.046_81, "0.0468"),
            (123.456, "123"),
            (99_999.0, "100000"),
            (5_944.0, "5940"),
            (2.0, "2"),
            (0.0, "0"),
            (1.234e-5, "1.2e-5"),
            (-4.567, "-4.57"),
            (2.5e7, "2.5e7"),
        ] {
            assert_eq!(figure(value), text);
        }
    }

    #[test]
    fn shares_are_exact_at_their_ends_only() {
        assert_eq!(percent(0, 5), "0 %");
        assert_eq!(percent(5, 5), "100 %");
        assert_eq!(percent(1, 1000), "under 1 %");
        assert_eq!(percent(999, 1000), "over 99 %");
        assert_eq!(percent(1, 2), "50 %");
        assert_eq!(listed(&["a", "b", "c"], 2), "a, b and 1 more");
        assert_eq!(counted(2, "matrix"), "2 matrices");
    }
}
