//! Measures the peak performance of the processor, and the share of it that the factorisation reaches.

use std::collections::BTreeMap;

use anyhow::Context as _;

use super::Results;
use super::pinned::Pinned;
use super::whole::Graphs;
use crate::markdown;
use crate::measure::peers::{python, script};

const PHASES: [&str; 5] = ["analysis", "start", "linearisation", "factorisation", "substitution"];

/// Measures Gflop/s of large dense products and Gbyte/s of sums of two long vectors, on one core.
pub(super) fn measure(results: &mut Results) -> anyhow::Result<()> {
    let output = Pinned::new(&python(&["numpy"])?, 1).path(script("numpy")).must()?.output;
    let peak: BTreeMap<String, f64> =
        serde_json::from_slice(&output).context("scripts/peer-numpy.py does not print figures")?;
    results.keep(&["peak"], peak)
}

/// The table; `None` if the flops of a graph are not known.
pub(super) fn table(found: &Graphs, peak: &BTreeMap<String, f64>) -> Option<String> {
    let (gigaflops, gigabytes) = (peak.get("gigaflops")?, peak.get("gigabytes")?);
    let mut rows = Vec::new();
    for (name, graph) in &found.0 {
        let plain = &graph.plain;
        let flops = plain.flops?;
        let rate = 1e-9 * flops * plain.factorizations as f64 / plain.phase("factorisation");
        let mut row = vec![name.clone(), format!("{:.2}", 1e3 * plain.phase("optimize"))];
        row.extend(PHASES.map(|phase| format!("{:.2}", 1e3 * plain.phase(phase))));
        row.extend([
            format!("{:.1}", 1e-6 * flops),
            format!("{rate:.1}"),
            format!("{:.0}%", 100.0 * rate / gigaflops),
        ]);
        rows.push(row);
    }
    let head =
        [&["graph", "optimisation, ms"][..], &PHASES, &["Mflop a factorisation", "Gflop/s", "of the peak"]]
            .concat();
    let table = markdown::table(&markdown::cells(&head), head.len(), &rows).join("\n");
    Some(format!(
        "{table}\n\nOne core gives {gigaflops:.0} Gflop/s in dense products of order 2000 and {gigabytes:.0} Gbyte/s in sums of long \
         vectors (numpy)."
    ))
}
