//! Colours for numbers.

/// Viridis from light to dark. Larger values are darker, so that they can be told apart in grey and by colour-blind
/// readers.
pub const VIRIDIS: [&str; 10] = [
    "#fde725", "#b5de2b", "#6ece58", "#35b779", "#1f9e89", "#26828e", "#31688e", "#3e4989", "#482878",
    "#440154",
];
/// Better: blue.
pub const BETTER: [&str; 4] = ["#f2f2f2", "#a6cbe3", "#4d95c4", "#0b5d99"];
/// Worse: orange.
pub const WORSE: [&str; 4] = ["#f2f2f2", "#f5c79b", "#e08a3c", "#a84a00"];

/// The colour at a position of a ramp, 0 to 1, and whether text on it must be light.
pub fn along(stops: &[&str], share: f64) -> (String, bool) {
    let place = share.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let index = (place.floor() as usize).min(stops.len() - 2);
    let part = place - index as f64;
    let channel = |stop: &str, at: usize| {
        f64::from(u8::from_str_radix(&stop[1 + 2 * at..3 + 2 * at], 16).unwrap_or_default())
    };
    let mixed: [f64; 3] = std::array::from_fn(|at| {
        (channel(stops[index], at) * (1.0 - part) + channel(stops[index + 1], at) * part).round()
    });
    let light = 0.299 * mixed[0] + 0.587 * mixed[1] + 0.114 * mixed[2];
    (format!("#{:02x}{:02x}{:02x}", mixed[0] as u8, mixed[1] as u8, mixed[2] as u8), light < 140.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The page and the figures must show a number in the same colour.
    #[test]
    fn the_page_has_the_same_ramps() {
        let script = include_str!("../../assets/script/theme.js");
        for (name, stops) in [("viridis", &VIRIDIS[..]), ("better", &BETTER[..]), ("worse", &WORSE[..])] {
            let listed: Vec<String> = stops.iter().map(|stop| format!("\"{stop}\"")).collect();
            let line = format!("const {name} = [{}];", listed.join(", "));
            assert!(script.contains(&line), "{line}");
        }
    }

    #[test]
    fn colours_lie_between_their_neighbours() {
        assert_eq!(along(&["#000000", "#ffffff"], 0.5), ("#808080".to_owned(), true));
        assert_eq!(along(&VIRIDIS, 7.0).0, "#440154");
        assert_eq!(along(&VIRIDIS, -1.0), ("#fde725".to_owned(), false));
    }
}
