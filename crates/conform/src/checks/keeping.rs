//! Checks on what a program must not change.

use std::collections::BTreeMap;

use posecut_graph::{Edge, Extra, PoseGraph};
use serde_json::Value;

use super::{Bench, Check, Verdict, must};
use crate::report::Level;
use crate::sample;

pub(super) const CHECKS: &[Check] = &[
    Check {
        name: "nodes",
        level: Level::Must,
        demand: "keeps every node, with session, frame, utime and truth",
        works_on_output: true,
        test: |bench| Ok(nodes(bench)),
    },
    Check {
        name: "edges",
        level: Level::Must,
        demand: "marks edges, and neither removes nor adds any",
        works_on_output: true,
        test: |bench| Ok(edges(bench)),
    },
    Check {
        name: "numbers",
        level: Level::Must,
        demand: "keeps measurements, information, scores and truth bit for bit",
        works_on_output: true,
        test: |bench| Ok(numbers(bench)),
    },
    Check {
        name: "unknown-fields",
        level: Level::Must,
        demand: "keeps unknown fields in every record",
        works_on_output: true,
        test: |bench| Ok(unknown_fields(bench)),
    },
    Check {
        name: "unknown-kinds",
        level: Level::Must,
        demand: "keeps records of unknown kinds",
        works_on_output: true,
        test: |bench| Ok(unknown_kinds(bench)),
    },
    Check {
        name: "earlier-marks",
        level: Level::Must,
        demand: "keeps the mark of the stage that first rejected an edge",
        works_on_output: true,
        test: |bench| Ok(earlier_marks(bench)),
    },
];

fn nodes(bench: &Bench<'_>) -> Verdict {
    let output = bench.output()?;
    let ids = |graph: &PoseGraph| graph.nodes.iter().map(|node| node.id).collect::<Vec<_>>();
    must(ids(output) == ids(&bench.graph), || {
        format!("{} nodes went in, {} came out", bench.graph.nodes.len(), output.nodes.len())
    })?;
    for (before, after) in bench.graph.nodes.iter().zip(&output.nodes) {
        let same = before.session == after.session
            && before.frame == after.frame
            && before.utime == after.utime
            && before.truth.as_ref().map(|truth| &truth.pose)
                == after.truth.as_ref().map(|truth| &truth.pose);
        must(same, || format!("node {}: its session, frame, utime or truth changed", before.id))?;
    }
    Ok(())
}

fn edges(bench: &Bench<'_>) -> Verdict {
    let output = bench.output()?;
    let name = |edge: &Edge| (edge.id, edge.kind.name(), edge.from, edge.to);
    let names = |graph: &PoseGraph| graph.edges.iter().map(name).collect::<Vec<_>>();
    let (before, after) = (names(&bench.graph), names(output));
    match before.iter().find(|edge| !after.contains(edge)) {
        Some((id, kind, ..)) => Err(format!(
            "{kind} {id} is missing or joins other nodes; {} edges went in, {} came out",
            before.len(),
            after.len()
        )),
        None => must(before == after, || format!("{} edges went in, {} came out", before.len(), after.len())),
    }
}

fn numbers(bench: &Bench<'_>) -> Verdict {
    let output = bench.output()?;
    must(output.header.noise_models == bench.graph.header.noise_models, || {
        "the header's noise models changed".to_owned()
    })?;
    let after: BTreeMap<u64, &Edge> = output.edges.iter().map(|edge| (edge.id, edge)).collect();
    for before in &bench.graph.edges {
        let Some(after) = after.get(&before.id) else { continue };
        let correct = |edge: &Edge| edge.truth.as_ref().map(|truth| truth.correct);
        let fields = [
            ("measurement", before.measurement == after.measurement),
            ("information", before.information == after.information),
            ("noise", before.noise == after.noise),
            ("score", before.score == after.score),
            ("truth", correct(before) == correct(after)),
        ];
        if let Some((field, _)) = fields.iter().find(|(_, same)| !same) {
            return Err(format!("{}: its \"{field}\" changed", before.name()));
        }
    }
    Ok(())
}

/// Checks that every field of `before` is in `after`, unchanged.
fn kept(place: &str, before: &Extra, after: Option<&Extra>) -> Verdict {
    for (field, value) in before {
        must(after.and_then(|after| after.get(field)) == Some(value), || {
            format!("{place}: its field \"{field}\" was lost or changed")
        })?;
    }
    Ok(())
}

fn unknown_fields(bench: &Bench<'_>) -> Verdict {
    let output = bench.output()?;
    kept("the header", &bench.graph.header.extra, Some(&output.header.extra))?;
    must(output.header.provenance.starts_with(&bench.graph.header.provenance), || {
        "the header: its provenance was lost or changed".to_owned()
    })?;
    for (before, after) in bench.graph.nodes.iter().zip(&output.nodes) {
        let place = format!("node {}", before.id);
        kept(&place, &before.extra, Some(&after.extra))?;
        let empty = Extra::new();
        let truth = before.truth.as_ref().map_or(&empty, |truth| &truth.extra);
        kept(&format!("{place}, truth"), truth, after.truth.as_ref().map(|truth| &truth.extra))?;
    }
    let after: BTreeMap<u64, &Edge> = output.edges.iter().map(|edge| (edge.id, edge)).collect();
    for before in &bench.graph.edges {
        // Another check reports a missing edge.
        let Some(after) = after.get(&before.id) else { continue };
        kept(&before.name(), &before.extra, Some(&after.extra))?;
        let empty = Extra::new();
        let truth = before.truth.as_ref().map_or(&empty, |truth| &truth.extra);
        kept(&format!("{}, truth", before.name()), truth, after.truth.as_ref().map(|truth| &truth.extra))?;
    }
    Ok(())
}

fn unknown_kinds(bench: &Bench<'_>) -> Verdict {
    let output = bench.output()?;
    // Compare values, because a writer may choose spaces and the notation of numbers.
    let values = |graph: &PoseGraph| -> Vec<Option<Value>> {
        graph.unknown.iter().map(|line| serde_json::from_str(line).ok()).collect()
    };
    must(values(output) == values(&bench.graph), || {
        format!("{} such records went in, {} came out", bench.graph.unknown.len(), output.unknown.len())
    })
}

fn earlier_marks(bench: &Bench<'_>) -> Verdict {
    let output = bench.output()?;
    for before in bench.graph.edges.iter().filter(|edge| !edge.in_use()) {
        let after = output.edges.iter().find(|edge| edge.id == before.id);
        must(after.is_some_and(|after| after.rejected_by == before.rejected_by), || {
            format!("{}: it was rejected by {}, and that mark is gone", before.name(), sample::EARLIER)
        })?;
    }
    Ok(())
}
