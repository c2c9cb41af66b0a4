//! The sections of docs/results/multicut.md.

use super::instances::{FAMILIES, RATES};
use super::running::{Found, Peer, Solved};
use crate::markdown;
use crate::numbers::general;

const EXACT: [&str; 9] =
    ["instance", "nodes", "edges", "CPU s", "MB", "objective", "lower bound", "proved", "share %"];
const HEURISTICS: [&str; 9] = [
    "instance",
    "solver",
    "CPU s",
    "objective",
    "peer CPU s",
    "peer solver s",
    "peer objective",
    "ratio",
    "value",
];

const HARD: [&str; 9] =
    ["instance", "nodes", "edges", "CPU s", "MB", "objective", "known optimum", "lower bound", "proved"];
/// The place of the known optimum.
const HARD_KNOWN: usize = 6;

const NO_PEER: &str = "Not measured: `--peer` measures bioimage-cpp.";

/// Whether posecut's value is better than, equal to or worse than the peer's.
fn compared(ours: &Solved, theirs: &Peer) -> &'static str {
    let difference = ours.objective - theirs.objective;
    // Sums in a different order differ in the last digits.
    if difference.abs() <= 1e-9 * theirs.objective.abs().max(1.0) {
        "equal"
    } else if difference < 0.0 {
        "better"
    } else {
        "worse"
    }
}

/// The runs that both solvers finished.
fn pairs(found: &[Found]) -> Vec<(&Solved, &Peer)> {
    let both = found.iter().flat_map(|found| found.peer.all());
    both.filter_map(|(_, (ours, theirs))| Some((ours.as_ref()?, theirs.as_ref()?))).collect()
}

/// Summarises the proofs in a sentence.
pub(super) fn summary(found: &[Found]) -> String {
    let proved = found.iter().filter(|found| found.exact.as_ref().is_some_and(|exact| exact.optimal)).count();
    format!("The solver proves {proved} of {} instances optimal.", found.len())
}

/// Summarises the comparison with the peer.
pub(super) fn summary_of_heuristics(found: &[Found]) -> String {
    let pairs = pairs(found);
    if pairs.is_empty() {
        return NO_PEER.to_owned();
    }
    let count = |word: &str| pairs.iter().filter(|(ours, theirs)| compared(ours, theirs) == word).count();
    let words = ["better", "equal", "worse"].map(|word| format!("{word} in {}", count(word)));
    let faster = pairs.iter().filter(|(ours, theirs)| ours.cpu < theirs.cpu).count();
    let faster_alone = pairs.iter().filter(|(ours, theirs)| ours.cpu < theirs.solve_cpu_seconds).count();
    format!(
        "In the {} runs that bioimage-cpp {} finished in time, posecut's value is {}. Its whole process, with lower bound, is faster \
         than the whole process of bioimage-cpp in {faster} runs, and than the solver of bioimage-cpp alone in {faster_alone}.",
        pairs.len(),
        pairs[0].1.version,
        words.join(", ")
    )
}

fn percent(share: f64) -> String {
    if share >= 0.995 { "100 %".to_owned() } else { format!("{} %", general(100.0 * share, 2)) }
}

fn surviving(solved: &Solved) -> f64 {
    solved.kernel_edges as f64 / solved.edges.max(1) as f64
}

/// CPU seconds, memory, share of surviving edges and gap of the generated instances, with one column a size.
pub(super) fn growth(found: &[Found]) -> String {
    let drawn: Vec<([&str; 3], Option<&Solved>)> = found
        .iter()
        .filter(|found| found.name.contains(" n="))
        .filter_map(|found| {
            let mut words = found.name.split(' ');
            Some(([words.next()?, words.next()?, words.next()?], found.exact.as_ref()))
        })
        .collect();
    let mut sizes: Vec<&str> = drawn.iter().map(|([_, size, _], _)| *size).collect();
    sizes.sort_by_key(|size| size.trim_start_matches("n=").parse::<u64>().ok());
    sizes.dedup();
    let mut rows = Vec::new();
    for family in FAMILIES {
        for rate in RATES {
            let cells = sizes.iter().map(|size| {
                let solved = drawn
                    .iter()
                    .find(|(key, _)| *key == [family, size, rate])
                    .and_then(|(_, solved)| *solved);
                solved.map_or_else(String::new, grown)
            });
            rows.push([family.to_owned(), rate.to_owned()].into_iter().chain(cells).collect());
        }
    }
    let head = [&["family", "false"][..], &sizes].concat();
    markdown::table(&markdown::cells(&head), head.len(), &rows).join("\n")
}

fn grown(solved: &Solved) -> String {
    let gap = solved.gap.unwrap_or_default() / solved.objective.abs();
    let end = if solved.optimal { "proved".to_owned() } else { format!("gap {}", percent(gap)) };
    format!("{:.2} s, {:.0} MB, {}, {end}", solved.cpu, solved.memory, percent(surviving(solved)))
}

/// The row of a proof: instance, size, effort, objective, bound and whether they meet, with one more cell at the given place.
fn proof(found: &Found, place: usize, cell: impl Fn(&Solved) -> String) -> Vec<String> {
    let mut cells = vec![found.name.clone()];
    match &found.exact {
        None => cells.extend(["–", "–", "failed", "", "", "", "", ""].map(str::to_owned)),
        Some(solved) => {
            cells.extend([
                solved.nodes.to_string(),
                solved.edges.to_string(),
                format!("{:.2}", solved.cpu),
                format!("{:.0}", solved.memory),
                general(solved.objective, 10),
                general(solved.lower_bound, 10),
                if solved.optimal { "yes" } else { "no" }.to_owned(),
            ]);
            cells.insert(place, cell(solved));
        }
    }
    cells
}

/// A table with a row for each instance.
pub(super) fn exact(found: &[Found]) -> String {
    let share = |solved: &Solved| general(100.0 * surviving(solved), 3);
    let rows: Vec<Vec<String>> = found.iter().map(|found| proof(found, EXACT.len() - 1, share)).collect();
    narrow(&markdown::table(&markdown::cells(&EXACT), EXACT.len(), &rows))
}

/// Counts, and a table with a row for each small and hard instance; `known` has the published optimum of each, if there is one.
pub(super) fn hard(found: &[Found], known: &[Option<f64>]) -> String {
    let solved =
        || found.iter().zip(known).filter_map(|(found, known)| Some((found.exact.as_ref()?, *known)));
    let proved = solved().filter(|(solved, _)| solved.optimal).count();
    let reached = |(solved, known): &(&Solved, Option<f64>)| {
        known.is_some_and(|known| solved.objective <= known + 1e-9 * known.abs())
    };
    let text = format!(
        "{proved} of {} instances are proved; {} of {} published optima are reached.",
        found.len(),
        solved().filter(reached).count(),
        known.iter().flatten().count()
    );
    let row = |(found, known): (&Found, &Option<f64>)| {
        proof(found, HARD_KNOWN, |_| known.map_or_else(String::new, |known| general(known, 10)))
    };
    let rows: Vec<Vec<String>> = found.iter().zip(known).map(row).collect();
    format!("{text}\n\n{}", narrow(&markdown::table(&markdown::cells(&HARD), HARD.len(), &rows)))
}

/// A table with a row for each run of the peer.
pub(super) fn heuristics(found: &[Found], limit: u64) -> String {
    let mut rows = Vec::new();
    for one in found {
        for (solver, (ours, theirs)) in one.peer.all() {
            rows.push(
                [vec![one.name.clone(), solver.to_owned()], beside(ours.as_ref(), theirs.as_ref(), limit)]
                    .concat(),
            );
        }
    }
    if rows.is_empty() {
        return NO_PEER.to_owned();
    }
    narrow(&markdown::table(&markdown::cells(&HEURISTICS), HEURISTICS.len(), &rows))
}

/// A table whose empty cells have a single space.
fn narrow(lines: &[String]) -> String {
    lines.join("\n").replace("  |", " |")
}

fn beside(ours: Option<&Solved>, theirs: Option<&Peer>, limit: u64) -> Vec<String> {
    let mut cells = match ours {
        None => markdown::cells(&["failed", "–"]),
        Some(ours) => vec![format!("{:.3}", ours.cpu), general(ours.objective, 10)],
    };
    match (ours, theirs) {
        (Some(ours), Some(theirs)) => cells.extend([
            format!("{:.3}", theirs.cpu),
            format!("{:.3}", theirs.solve_cpu_seconds),
            general(theirs.objective, 10),
            general(theirs.cpu / ours.cpu.max(1e-3), 2),
            compared(ours, theirs).to_owned(),
        ]),
        (_, Some(_)) => cells.extend(markdown::cells(&["–", "", "", "", ""])),
        (_, None) => cells.extend([
            format!("over {limit}"),
            String::new(),
            String::new(),
            String::new(),
            String::new(),
        ]),
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The expected tables come from an earlier Python script, which made them of the same measurements.
    #[test]
    fn recorded_measurements_make_the_tables() {
        let lines = [
            r#"{"name": "mod_karate", "exact": null, "peer": {"gaec": [null, null]}}"#,
            r#"{"name": "A n=1000 0.5", "exact": {"cpu": 29.81, "memory": 93.2, "nodes": 2000, "edges": 4990, "kernel_edges": 3733,
                "objective": -1373.0, "lower_bound": -1379.0, "optimal": false, "gap": 6.0, "work": 1},
                "peer": {"gaec": [{"cpu": 0.011, "memory": 4.0, "nodes": 2000, "edges": 4990, "kernel_edges": 3733,
                "objective": -1369.0, "lower_bound": -1379.0, "optimal": false, "gap": 10.0},
                {"cpu": 0.243, "memory": 40.0, "objective": -1320.0, "solve_cpu_seconds": 0.006, "version": "1"}]}}"#,
        ];
        let found: Vec<Found> = lines.iter().map(|line| serde_json::from_str(line).unwrap()).collect();
        let last = |text: &str| text.lines().last().unwrap_or_default().to_owned();
        assert!(exact(&found).contains("\n| mod_karate | – | – | failed | | | | | |\n"));
        assert_eq!(
            last(&exact(&found)),
            "| A n=1000 0.5 | 2000 | 4990 | 29.81 | 93 | -1373 | -1379 | no | 74.8 |"
        );
        assert!(heuristics(&found, 15).contains("\n| mod_karate | gaec | failed | – | over 15 | | | | |\n"));
        assert_eq!(
            last(&heuristics(&found, 15)),
            "| A n=1000 0.5 | gaec | 0.011 | -1369 | 0.243 | 0.006 | -1320 | 22 | better |"
        );
        assert!(growth(&found).contains("\n| A | 0.5 | 29.81 s, 93 MB, 75 %, gap 0.44 % |\n"));
        assert_eq!(summary(&found), "The solver proves 0 of 2 instances optimal.");
        assert_eq!(
            summary_of_heuristics(&found),
            "In the 1 runs that bioimage-cpp 1 finished in time, posecut's value is better in 1, equal in 0, worse in 0. Its whole \
             process, with lower bound, is faster than the whole process of bioimage-cpp in 1 runs, and than the solver of \
             bioimage-cpp alone in 0."
        );
        let hard = hard(&found, &[None, Some(-1373.0)]);
        assert!(
            hard.starts_with(
                "0 of 2 instances are proved; 1 of 1 published optima are reached.\n\n| instance"
            )
        );
        assert!(hard.contains("\n| mod_karate | – | – | failed | | | | | |\n"));
        assert_eq!(last(&hard), "| A n=1000 0.5 | 2000 | 4990 | 29.81 | 93 | -1373 | -1373 | -1379 | no |");
    }
}
