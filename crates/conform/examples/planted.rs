//! A stage with one planted fault, to show that each check can fail: `planted FAULT [OPTIONS] [INPUT]`. Without a fault
//! (`none`) it conforms. It rejects landmark edges whose score is below one half.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a stage in its own words, without the shared runtime"
)]

use std::fs;
use std::io::{self, Read as _, Write as _};
use std::process::ExitCode;
use std::time::{SystemTime, UNIX_EPOCH};

use posecut_graph::{EdgeKind, PoseGraph};
use serde_json::json;

/// An exit status and a message.
type Refusal = (u8, String);

#[derive(Default)]
struct Arguments {
    input: Option<String>,
    output: Option<String>,
    stats: Option<String>,
    quiet: bool,
}

fn main() -> ExitCode {
    let mut words = std::env::args().skip(1);
    let fault = words.next().unwrap_or_default();
    match run(&fault, words) {
        Ok(()) => ExitCode::SUCCESS,
        Err((status, said)) => {
            if !said.is_empty() {
                eprintln!("planted: error: {said}");
            }
            if fault == "one-sentence" {
                eprintln!("planted: and that is that");
            }
            ExitCode::from(status)
        }
    }
}

#[allow(clippy::needless_pass_by_value, reason = "`map_err` hands errors over by value")]
fn refuse<E: ToString>(error: E) -> Refusal {
    (2, error.to_string())
}

fn run(fault: &str, words: impl Iterator<Item = String>) -> Result<(), Refusal> {
    let Some(arguments) = arguments(fault, words)? else { return Ok(()) };
    if fault == "hanging" {
        std::thread::sleep(std::time::Duration::from_hours(1));
    }
    if fault == "standard-input" {
        return Err((1, "no".to_owned()));
    }
    let bytes = read(fault, &arguments)?;
    if fault == "premature-output"
        && let Some(output) = &arguments.output
    {
        fs::write(output, "").map_err(refuse)?;
    }
    if fault == "leftovers"
        && let Some(output) = &arguments.output
    {
        fs::write(format!("{output}.part"), "").map_err(refuse)?;
    }
    if fault == "early-output" {
        println!();
    }
    let mut graph = match PoseGraph::read("input", bytes.as_slice()) {
        Ok(graph) => graph,
        Err(error) if accepts(fault, &error.to_string()) => return Ok(()),
        Err(error) if fault == "status" => return Err((1, error.to_string())),
        Err(_) if fault == "silence" => return Err(refuse("")),
        Err(error) => return Err(refuse(error)),
    };
    if fault == "no-landmark-edges" && graph.edges_of(EdgeKind::Landmark).count() == 0 {
        return Err(refuse("there are no landmark edges"));
    }
    if fault == "space" && graph.header.dimension.number() == 3 {
        return Err((1, "no space".to_owned()));
    }
    decide(fault, &mut graph);
    write(fault, &arguments, &graph)
}

/// Parses the command line; `None` if it only asked a question, which is answered.
fn arguments(fault: &str, mut words: impl Iterator<Item = String>) -> Result<Option<Arguments>, Refusal> {
    let mut arguments = Arguments::default();
    while let Some(word) = words.next() {
        match word.as_str() {
            "--help" | "--version" if fault != "help" => {
                println!("planted 1");
                return Ok(None);
            }
            "-o" => arguments.output = words.next(),
            "--stats" if fault != "pipeline-options" => arguments.stats = words.next(),
            "--quiet" => arguments.quiet = true,
            "-" if fault != "dash" => {}
            "--no-such-option" if fault == "unknown-option" => {}
            word if word.starts_with("--") => return Err(refuse(format!("unknown option {word}"))),
            name => arguments.input = Some(name.to_owned()),
        }
    }
    Ok(Some(arguments))
}

fn read(fault: &str, arguments: &Arguments) -> Result<Vec<u8>, Refusal> {
    let mut bytes = Vec::new();
    match &arguments.input {
        Some(name) => match fs::read(name) {
            Ok(read) => bytes = read,
            Err(error) if fault == "missing-input" => return Err((1, format!("{name}: {error}"))),
            Err(error) => return Err(refuse(error)),
        },
        None => drop(io::stdin().read_to_end(&mut bytes).map_err(refuse)?),
    }
    if fault == "file" && arguments.input.is_some() {
        bytes.extend(b"{\"kind\":\"from-a-file\"}\n");
    }
    if bytes.starts_with(&[0x1f, 0x8b]) && fault != "compressed-input" {
        let mut text = Vec::new();
        flate2::read::GzDecoder::new(bytes.as_slice()).read_to_end(&mut text).map_err(refuse)?;
        bytes = text;
    }
    Ok(bytes)
}

/// Whether the planted fault is to accept this error in the input.
fn accepts(fault: &str, error: &str) -> bool {
    let words = match fault {
        "empty-input" => "is empty",
        "no-json" => "not JSON",
        "cut-line" => "cut short",
        "no-header" => "kind \"node\"",
        "other-version" => "found 7",
        "not-a-number" => "NaN",
        "dangling-edge" => "no node 9",
        "double-id" => "node 1",
        _ => return false,
    };
    error.contains(words)
}

fn decide(fault: &str, graph: &mut PoseGraph) {
    for (number, edge) in graph.edges.iter_mut().enumerate() {
        let correct = edge.truth_correct();
        let low = edge.score.is_some_and(|score| score < 0.5);
        let sees = match fault {
            "blind-without-truth" => edge.kind == EdgeKind::Landmark && edge.truth.is_none(),
            "blind-to-false-truth" => correct == Some(false),
            _ => false,
        };
        if fault == "earlier-marks" && low {
            edge.readmit();
        }
        if low || sees {
            edge.reject(if fault == "own-mark" && number % 2 == 0 { "other" } else { "planted" });
        }
        if fault == "numbers"
            && let Some(measurement) = &mut edge.measurement
        {
            measurement[0] = f64::from(measurement[0] as f32);
        }
        if fault == "unknown-fields" {
            edge.extra.clear();
        }
    }
    match fault {
        "nodes" => graph.nodes.iter_mut().for_each(|node| node.frame = node.frame.map(|frame| frame + 1)),
        "lost-node" => {
            let last = graph.nodes.len().saturating_sub(1);
            graph.edges.retain(|edge| edge.from != last as u64 && edge.to != last as u64);
            graph.nodes.truncate(last);
        }
        "edges" => graph.drop_rejected(),
        "unknown-kinds" => graph.unknown.clear(),
        "header-fields" => graph.header.extra.clear(),
        "deterministic" => {
            let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
            graph.header.extra.insert("written".to_owned(), now.into());
        }
        _ => {}
    }
    if fault != "provenance" {
        graph.header.provenance.push(json!({"stage": "planted"}));
    }
}

fn write(fault: &str, arguments: &Arguments, graph: &PoseGraph) -> Result<(), Refusal> {
    let mut bytes = Vec::new();
    graph.write(&mut bytes).map_err(refuse)?;
    if fault == "canonical-order" {
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (header, rest) = text.split_once('\n').unwrap_or((&text, ""));
        let mut backwards: Vec<&str> = rest.lines().collect();
        let known = backwards.len().saturating_sub(graph.unknown.len());
        backwards[..known].reverse();
        bytes = format!("{header}\n{}\n", backwards.join("\n")).into_bytes();
    }
    if let Some(stats) = &arguments.stats {
        let figures = if fault == "doubtful" { r#"{"doubts":["nothing-kept"]}"# } else { "{}" };
        fs::write(stats, figures).map_err(refuse)?;
    }
    if fault == "chatter" || fault == "doubtful" || !arguments.quiet {
        eprintln!("planted: done");
    }
    if let Some(output) = &arguments.output {
        if fault == "missing-folder"
            && let Some(folder) = std::path::Path::new(output).parent()
        {
            fs::create_dir_all(folder).map_err(refuse)?;
        }
        let written = fs::write(output, &bytes);
        if fault != "full-disk" || output != "/dev/full" {
            written.map_err(refuse)?;
        }
        if fault != "output-file" {
            return Ok(());
        }
    }
    match io::stdout().write_all(&bytes) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe && fault != "closed-pipe" => Ok(()),
        written => written.map_err(refuse),
    }
}
