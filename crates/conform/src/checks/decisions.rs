//! Checks on the decisions of a program.

use std::collections::BTreeSet;
use std::thread;
use std::time::Duration;

use posecut_graph::PoseGraph;

use super::{Bench, Check, Verdict, graph_of, must};
use crate::report::Level;
use crate::sample;

/// The number of runs. Some of them must fall into different seconds.
const RUNS: usize = 3;
const BETWEEN_RUNS: Duration = Duration::from_millis(600);

pub(super) const CHECKS: &[Check] = &[
    Check {
        name: "deterministic",
        level: Level::Must,
        demand: "writes the same bytes for the same input on every run",
        works_on_output: true,
        test: deterministic,
    },
    Check {
        name: "blind-without-truth",
        level: Level::Must,
        demand: "makes the same decisions if the records have no truth",
        works_on_output: true,
        test: |bench| {
            blind(bench, |graph| {
                graph.nodes.iter_mut().for_each(|node| node.truth = None);
                graph.edges.iter_mut().for_each(|edge| edge.truth = None);
            })
        },
    },
    Check {
        name: "blind-to-false-truth",
        level: Level::Must,
        demand: "makes the same decisions if the truth is inverted",
        works_on_output: true,
        test: |bench| {
            blind(bench, |graph| {
                for truth in graph.edges.iter_mut().filter_map(|edge| edge.truth.as_mut()) {
                    truth.correct = truth.correct.map(|correct| !correct);
                }
                let poses: Vec<_> = graph.nodes.iter().rev().map(|node| node.truth.clone()).collect();
                for (node, truth) in graph.nodes.iter_mut().zip(poses) {
                    node.truth = truth;
                }
            })
        },
    },
    Check {
        name: "own-mark",
        level: Level::Must,
        demand: "marks edges with one name, its own",
        works_on_output: true,
        test: |bench| Ok(own_mark(bench)),
    },
    Check {
        name: "provenance",
        level: Level::Should,
        demand: "adds one entry to the header's provenance",
        works_on_output: true,
        test: |bench| Ok(provenance(bench)),
    },
];

fn deterministic(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    for _ in 1..RUNS {
        thread::sleep(BETWEEN_RUNS);
        let run = bench.program.run(&[], &bench.input)?;
        if run.stdout != bench.base.stdout || !run.succeeded() {
            return Ok(Err("two runs on the same input differ".to_owned()));
        }
    }
    Ok(Ok(()))
}

fn blind(bench: &Bench<'_>, change: fn(&mut PoseGraph)) -> anyhow::Result<Verdict> {
    let mut graph = bench.graph.clone();
    change(&mut graph);
    let run = bench.program.run(&[], &sample::bytes(&graph)?)?;
    // Ignore the truth and the provenance (which has the digest of the input), because these may differ.
    let decided = |mut graph: PoseGraph| {
        graph.nodes.iter_mut().for_each(|node| node.truth = None);
        graph.edges.iter_mut().for_each(|edge| edge.truth = None);
        graph.header.provenance.clear();
        graph
    };
    Ok(graph_of(&run).and_then(|other| {
        let (one, other) = (decided(bench.output()?.clone()), decided(other));
        let differs = one.edges.iter().zip(&other.edges).find(|(a, b)| a.rejected_by != b.rejected_by);
        must(one == other, || match differs {
            Some((edge, _)) => format!("{}: the decision differs, and others may differ too", edge.name()),
            None => "the output differs in more than the truth".to_owned(),
        })
    }))
}

fn own_mark(bench: &Bench<'_>) -> Verdict {
    let output = bench.output()?;
    let names: BTreeSet<&str> = output.edges.iter().filter_map(|edge| edge.rejected_by.as_deref()).collect();
    let own: Vec<&str> = names.into_iter().filter(|name| *name != sample::EARLIER).collect();
    must(own.len() <= 1 && own.iter().all(|name| !name.trim().is_empty()), || {
        format!(
            "it marks edges with these names: {}",
            own.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ")
        )
    })
}

fn provenance(bench: &Bench<'_>) -> Verdict {
    let output = bench.output()?;
    let added = output.header.provenance.len().saturating_sub(bench.graph.header.provenance.len());
    must(added == 1, || format!("{added} entries were added"))?;
    let named = output.header.provenance.last().is_some_and(|entry| entry["stage"].is_string());
    must(named, || "the entry has no \"stage\" with the program's name".to_owned())
}
