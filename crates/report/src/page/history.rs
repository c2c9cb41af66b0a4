//! Where the page's numbers come from: stages with their versions and arguments, and digests of files. It has no paths
//! or dates, so that the same inputs give the same bytes.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use posecut_graph::InputDigest;
use posecut_stage::digest;
use posecut_view::arguments::said;
use posecut_view::markup::escape;
use serde_json::Value;

use crate::results::Located;

/// The history of all results: stages by experiment, inputs by session, and digests of all files read.
pub fn history(results: &[Located], inputs: &[InputDigest]) -> String {
    let mut text = String::new();
    let mut experiments: BTreeMap<String, Vec<&Located>> = BTreeMap::new();
    for located in results {
        experiments.entry(located.result.label("pipeline")).or_default().push(located);
    }
    for (name, own) in &experiments {
        stages(&mut text, name, own);
    }
    data(&mut text, results);
    files(&mut text, results, inputs);
    text
}

/// A stage with its arguments except the seed, the methods that use it, its seeds, and its last position in any
/// history.
#[derive(Default)]
struct Stage {
    place: usize,
    methods: BTreeSet<String>,
    seeds: BTreeSet<u64>,
}

/// Each stage with each set of arguments once, in the order in which they ran.
fn stages(text: &mut String, experiment: &str, results: &[&Located]) {
    let mut found: BTreeMap<(String, String, String), Stage> = BTreeMap::new();
    for located in results {
        for (place, entry) in located.result.provenance.iter().enumerate() {
            let field = |name: &str| entry.get(name).and_then(Value::as_str).unwrap_or("?").to_owned();
            let arguments = entry.get("arguments").map_or_else(String::new, said);
            let stage = found.entry((field("stage"), field("version"), arguments)).or_default();
            stage.place = stage.place.max(place);
            stage.methods.insert(located.result.label("method"));
            stage.seeds.extend(entry.get("seed").and_then(Value::as_u64));
        }
    }
    let mut rows: Vec<_> = found.into_iter().collect();
    rows.sort_by_key(|(_, stage)| stage.place);
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "<h3>{0}</h3><div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Stages of {0}\"><table class=\"text\"><thead><tr><th scope=\"col\">stage</th><th scope=\"col\">version</th><th scope=\"col\">arguments</th><th scope=\"col\">methods</th></tr></thead><tbody>",
        escape(experiment)
    );
    for ((name, version, arguments), stage) in rows {
        let seeds = match (stage.seeds.first(), stage.seeds.last(), stage.seeds.len()) {
            (Some(first), Some(last), count) if count > 2 && last - first + 1 == count as u64 => {
                format!("; seeds {first} to {last}")
            }
            (Some(_), _, count) => {
                let listed: Vec<String> = stage.seeds.iter().map(u64::to_string).collect();
                format!("; seed{} {}", if count == 1 { "" } else { "s" }, listed.join(", "))
            }
            _ => String::new(),
        };
        let methods: Vec<String> = stage.methods.into_iter().collect();
        let _ = writeln!(
            text,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}{}</td><td>{}</td></tr>",
            escape(&name),
            escape(&version),
            escape(&arguments),
            escape(&seeds),
            escape(&methods.join(", "))
        );
    }
    text.push_str("</tbody></table></div>\n");
}

/// The files that the first stage of each session read.
fn data(text: &mut String, results: &[Located]) {
    let mut rows: BTreeSet<(String, String, String)> = BTreeSet::new();
    for located in results {
        let first = located.result.provenance.first();
        let inputs = first.and_then(|entry| entry.get("inputs")).and_then(Value::as_array);
        for input in inputs.into_iter().flatten() {
            let field = |name: &str| input.get(name).and_then(Value::as_str).unwrap_or("?").to_owned();
            rows.insert((located.result.label("session"), field("name"), field("sha256")));
        }
    }
    digests(
        text,
        "Data",
        "session and file",
        rows.into_iter().map(|(session, name, sha256)| (format!("{session}: {name}"), sha256)),
    );
}

/// The files that this page was made from.
fn files(text: &mut String, results: &[Located], inputs: &[InputDigest]) {
    let named = |located: &Located| {
        let label = |name: &str| located.result.label(name);
        format!("{}/{}/{}/{}", label("pipeline"), label("session"), label("seed"), label("method"))
    };
    let rows: BTreeSet<(String, String)> =
        results.iter().map(|located| (named(located), located.sha256.clone())).collect();
    let lines: Vec<String> = rows.iter().map(|(name, sha256)| format!("{sha256}  {name}\n")).collect();
    let _ = writeln!(
        text,
        "<p>SHA-256 over all result digests and names, one <code>digest  name</code> a line: <code class=\"digest\">{}</code></p>",
        digest(lines.concat().as_bytes())
    );
    digests(text, "Results", "experiment/session/seed/method", rows.into_iter());
    let graphs: BTreeSet<(String, String)> =
        inputs.iter().map(|input| (input.name.clone(), input.sha256.clone())).collect();
    digests(text, "Graphs drawn and other files", "experiment/session/seed/method", graphs.into_iter());
}

fn digests(text: &mut String, title: &str, column: &str, rows: impl Iterator<Item = (String, String)>) {
    let rows: Vec<(String, String)> = rows.collect();
    if rows.is_empty() {
        return;
    }
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "<details><summary>{title}: {}</summary><div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{title}\"><table class=\"text\"><thead><tr><th scope=\"col\">{column}</th><th scope=\"col\">SHA-256</th></tr></thead><tbody>",
        posecut_stage::counted(rows.len(), "file")
    );
    for (name, sha256) in rows {
        let _ = writeln!(
            text,
            "<tr><th scope=\"row\">{}</th><td><code class=\"digest\">{}</code></td></tr>",
            escape(&name),
            escape(&sha256)
        );
    }
    text.push_str("</tbody></table></div></details>\n");
}
