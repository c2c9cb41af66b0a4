//! Measures posecut-optimize, and other optimisers for comparison, for docs/results/optimize.md.

mod growth;
mod peers;
mod phases;
mod pinned;
mod robust;
mod sessions;
mod whole;

use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, ValueEnum};
use serde_json::{Map, Value};
use xtask::sections::replace;
use xtask::workspace::{root, target};

use crate::Verdict;
use crate::measure::programs::build;

/// Measure posecut-optimize and other optimisers, and regenerate the tables of docs/results/optimize.md
///
/// Needs POSECUT_SHARED_DATA (the graphs in g2o/ and false_closures/); the part `peers` needs gtsam. Builds all programs first, those of
/// crates/optimize/peers in target/peers unless PEERS names the folder of another build. Every process runs on one processor. Results
/// are collected in target/comparison.json, so that you can split a long measurement. LIMIT is the time limit of a process in seconds
/// (40), MOST_WITH_TWO the largest number of poses of a generated graph that is also measured with two threads (300000).
#[derive(Args)]
pub(crate) struct Optimize {
    /// Measure these graphs, separated by commas [default: all]
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
    /// Measure these parts, separated by commas
    #[arg(long, value_delimiter = ',', default_values = ["peers", "process", "growth", "sessions", "robust", "phases"])]
    parts: Vec<Part>,
    /// Measure only generated graphs with these numbers of poses, separated by commas [default: all]
    #[arg(long, value_delimiter = ',')]
    sizes: Vec<u64>,
    /// Regenerate the tables from earlier measurements
    #[arg(long)]
    no_measure: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Other optimisers on the same graphs, from several starts
    Peers,
    /// The whole process
    Process,
    /// Generated graphs of growing size
    Growth,
    /// Maps of up to 27 simulated NCLT sessions at 5 Hz
    Sessions,
    /// Robust kernels and GNC on graphs with false closures
    Robust,
    /// The limits of the processor, compared with the measurements of `process`
    Phases,
}

const PAGE: &str = "docs/results/optimize.md";

/// The measurements so far, stored in target/comparison.json.
struct Results {
    path: PathBuf,
    parts: Map<String, Value>,
}

impl Results {
    fn read() -> anyhow::Result<Self> {
        let path = target().join("comparison.json");
        let parts = match std::fs::read_to_string(&path) {
            Ok(text) => {
                serde_json::from_str(&text).with_context(|| format!("{}: cannot be used", path.display()))?
            }
            Err(_) => Map::new(),
        };
        Ok(Self { path, parts })
    }

    /// Stores a measurement under these names.
    fn keep(&mut self, names: &[&str], found: impl serde::Serialize) -> anyhow::Result<()> {
        let Some((last, outer)) = names.split_last() else { return Ok(()) };
        let mut map = &mut self.parts;
        for name in outer {
            let inner = map.entry(*name).or_insert_with(|| Value::Object(Map::new()));
            map =
                inner.as_object_mut().with_context(|| format!("comparison.json: {name} is not an object"))?;
        }
        map.insert((*last).to_owned(), serde_json::to_value(found)?);
        std::fs::write(&self.path, serde_json::to_string_pretty(&self.parts)?)
            .with_context(|| format!("{}: cannot be written", self.path.display()))
    }

    /// The measurement with this name, if there is one.
    fn part<T: serde::de::DeserializeOwned>(&self, name: &str) -> anyhow::Result<Option<T>> {
        let found = self.parts.get(name).cloned().map(serde_json::from_value).transpose();
        found.with_context(|| format!("comparison.json: {name} lacks fields of its table; measure it again"))
    }
}

/// Names of the benchmark graphs and the lowest known costs.
fn best_known() -> anyhow::Result<Vec<(String, f64)>> {
    let path = root().join("crates/optimize/tests/g2o/best_known.rs");
    let text =
        std::fs::read_to_string(&path).with_context(|| format!("{}: cannot be read", path.display()))?;
    let entry = |line: &str| {
        let (name, rest) = line.split_once("(\"")?.1.split_once("\", ")?;
        let cost = rest.split_once(')')?.0.replace('_', "").parse().ok()?;
        Some((name.to_owned(), cost))
    };
    Ok(text.lines().filter_map(entry).collect())
}

impl Optimize {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let mut results = Results::read()?;
        let graphs = best_known()?;
        if !self.no_measure {
            self.measure(&graphs, &mut results)?;
        }
        let page = root().join(PAGE);
        for (section, text) in tables(&results, &graphs)? {
            replace(&page, section, &text)?;
        }
        Ok(Verdict::Holds)
    }

    fn measure(&self, graphs: &[(String, f64)], results: &mut Results) -> anyhow::Result<()> {
        std::fs::create_dir_all(pinned::work())?;
        build(&["--workspace", "--bins"])?;
        let names: Vec<&str> = match self.only.as_slice() {
            [] => graphs.iter().map(|(name, _)| name.as_str()).collect(),
            only => only.iter().map(String::as_str).collect(),
        };
        let has = |part| self.parts.contains(&part);
        if has(Part::Peers) {
            peers::build()?;
        }
        for name in names.iter().filter(|_| has(Part::Peers)) {
            peers::measure(name, results)?;
        }
        for name in names.iter().filter(|_| has(Part::Process)) {
            whole::measure(name, results)?;
        }
        if has(Part::Phases) {
            phases::measure(results)?;
        }
        if has(Part::Growth) {
            growth::measure(&self.sizes, results)?;
        }
        if has(Part::Sessions) {
            sessions::measure(results)?;
        }
        if has(Part::Robust) {
            robust::measure(&self.only, results)?;
        }
        Ok(())
    }
}

/// The tables of the measurements, each with its section.
fn tables(results: &Results, graphs: &[(String, f64)]) -> anyhow::Result<Vec<(&'static str, String)>> {
    let mut all = Vec::new();
    if let Some(found) = results.part("peers")? {
        all.push(("peers", peers::table(&found, graphs, &peers::poses)?));
    }
    let whole: Option<whole::Graphs> = results.part("process")?;
    if let Some(whole) = &whole {
        all.push(("process", whole::table(whole, graphs)?));
        if let Some(peak) = results.part("peak")? {
            all.extend(phases::table(whole, &peak).map(|text| ("phases", text)));
        }
    }
    if let Some(found) = results.part("growth")? {
        all.push(("growth", growth::table(&found)?));
    }
    if let Some(found) = results.part("sessions")? {
        all.push(("sessions", sessions::table(&found)));
    }
    if let Some(found) = results.part("robust")? {
        all.push(("robust", robust::table(&found)));
    }
    Ok(all)
}

/// The lowest known cost of a graph.
fn best(graphs: &[(String, f64)], name: &str) -> anyhow::Result<f64> {
    let known = graphs.iter().find(|(known, _)| known == name);
    known.map(|(_, cost)| *cost).with_context(|| format!("the lowest cost of {name} is unknown"))
}

/// A JSON object as a list in the order of the file.
type Named<T> = Vec<(String, T)>;

/// The entries of a JSON object in their order.
fn named<'de, D: serde::Deserializer<'de>, T: serde::de::DeserializeOwned>(
    deserializer: D,
) -> Result<Named<T>, D::Error> {
    let map: Map<String, Value> = serde::Deserialize::deserialize(deserializer)?;
    let entry = |(name, value)| Ok((name, serde_json::from_value(value).map_err(serde::de::Error::custom)?));
    map.into_iter().map(entry).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// The expected tables come from an earlier Python script, which made them of the same measurements.
    #[test]
    fn recorded_measurements_make_the_tables() {
        let entry = |seconds: f64, cost: Option<f64>| json!({"seconds": seconds, "iterations": 4, "megabytes": 12.4, "cost": cost});
        let best = 40.550_883_344_1;
        let run = |cost: f64| {
            json!({"seconds": 0.0138, "megabytes": 8.44, "certificate": "optimal", "cost": cost, "flops": 838_728.0,
                "iterations": 3, "factorizations": 4, "termination": "converged", "start": "given",
                "optimize_seconds": 0.00267, "analysis_seconds": 0.00044, "start_seconds": 0.00064,
                "linearisation_seconds": 0.00056, "factorisation_seconds": 0.0004, "substitution_seconds": 0.0001})
        };
        let parts = json!({
            "peers": {"CSAIL": {"file": {
                "posecut": entry(0.002, Some(best)),
                "arael": entry(0.0031, Some(best * (1.0 + 3e-7))),
                "factrs": entry(0.001, Some(2.0 * best)),
                "apex": {"failed": "over 40 s"},
                "tiny": {"failed": "no word"},
                "gtsam": {"seconds": 0.02, "iterations": null, "megabytes": 90.0, "cost": best}}}},
            "process": {"CSAIL": {"poses": 1045, "plain": run(best), "odometry": run(best * (1.0 + 1e-3)),
                "certify": run(best), "marginals": run(best)}},
            "peak": {"gigaflops": 41.7, "gigabytes": 11.2},
            "growth": {"sphere": {
                "100000": {"poses": 100_000, "edges": 200_001, "seconds": 1.25, "with_two": 1.125, "peak_megabytes": 321.4,
                    "factor_blocks": 1_234_567, "factor_megabytes": 99.95, "iterations": 4, "factorizations": 6,
                    "start": "chordal", "chi_square_per_freedom": 1.0},
                "1000000": {"failed": "over 40 s"}}},
            "sessions": {"3": {"poses": 76_315, "edges": 109_312, "seconds": [1.5, 1.25], "optimisation": [0.75, 0.5],
                "megabytes": 271.6, "iterations": 4, "factorizations": 3, "start": "chordal", "converged": true,
                "chi_square": 98_994.0}},
            "robust": {"csail_grouped_10": {"plain": 8.054_49, "Huber": null, "GNC": 2.5e-8}},
        });
        let Value::Object(parts) = parts else { panic!("parts") };
        let results = Results { path: PathBuf::new(), parts };
        let graphs = best_known().unwrap();
        assert_eq!(super::best(&graphs, "CSAIL").unwrap(), best);
        let row = |text: &str, number: usize| text.lines().nth(number).unwrap_or_default().to_owned();

        let found = results.part("peers").unwrap().unwrap();
        let text = peers::table(&found, &graphs, &|_| Ok(1045)).unwrap();
        assert_eq!(
            row(&text, 2),
            "| CSAIL | 1045 | file | 2 ms (4, 0e+00, 12 MB) | 3.1 ms (4, 3e-07, 12 MB) | *1 ms (4, 1e+00, 12 MB)* | over 40 s | \
             fails | 20 ms (0e+00, 90 MB) | 1.55 |"
        );
        assert!(text.ends_with(
            "are 1 rows. In 0 no peer gets there; in 0 posecut is at least twice as fast as the fastest peer that does, in 1 faster \
             by less, in 0 slower. The lowest factors: CSAIL from file 1.55."
        ));

        let whole = results.part("process").unwrap().unwrap();
        assert_eq!(
            row(&whole::table(&whole, &graphs).unwrap(), 2),
            "| CSAIL | 1045 | 40.5508833441 | 40.5508833441 | 0e+00 | 1e-03 | given | 3 (4) | converged | 0.014 (8) | 0.014 | \
             optimal | 0.014 |"
        );
        let text = phases::table(&whole, &results.part("peak").unwrap().unwrap()).unwrap();
        assert_eq!(row(&text, 2), "| CSAIL | 2.67 | 0.44 | 0.64 | 0.56 | 0.40 | 0.10 | 0.8 | 8.4 | 20% |");
        assert!(text.ends_with("One core gives 42 Gflop/s in dense products of order 2000 and 11 Gbyte/s in sums of long vectors (numpy)."));

        let text = growth::table(&results.part("growth").unwrap().unwrap()).unwrap();
        assert_eq!(
            row(&text, 2),
            "| sphere | 100,000 | 200,001 | 1.250 | 1.125 | 321 | 12.3 | 100.0 | 4 (6) | chordal | 1.000 |"
        );
        assert_eq!(row(&text, 3), "| sphere | 1,000,000 | | over 40 s | | | | | | | |");
        assert_eq!(
            row(&sessions::table(&results.part("sessions").unwrap().unwrap()), 2),
            "| 3 | 76,315 | 109,312 | 0.75 | 0.50 | 1.50 | 1.25 | 272 | 4 (3) | chordal | yes | 1.000 |"
        );
        let text = robust::table(&results.part("robust").unwrap().unwrap());
        assert_eq!(
            row(&text, 2),
            "| csail_grouped_10 | 8.054 | fails | fails | fails | fails | 0.000 | fails |"
        );
    }
}
