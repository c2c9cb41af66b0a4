//! The command line of `posecut-doctor`.

use std::process::ExitCode;

use clap::Parser;
use posecut_convert::input::{Reading, ReadingOptions, read};
use posecut_stage::{CommonArguments, Context, Examples, Identity, Outcome, Phase, Place, Source, run};

use crate::{Effort, Finding, Severity, Topic, examine_by, text};

/// `--strict` of all programs has a meaning of its own here, where no doubts arise.
#[derive(Parser)]
#[command(mut_arg("strict", |strict| strict.help("Exit with status 1 if there is an error or a warning").help_heading(None)))]
struct Command {
    /// The graph to read, in any format that posecut-convert reads; `-` is standard input. Several files become one graph
    #[arg(value_name = "INPUT", default_value = "-")]
    inputs: Vec<Source>,

    /// Estimate the calibration of graphs with more than 20000 landmark edges too, which may take minutes
    #[arg(long)]
    thorough: bool,

    #[command(flatten)]
    reading: ReadingOptions,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    ("Check a graph before you trust its map", "posecut doctor graph.g2o"),
    ("Check two files as one graph with two sessions", "posecut doctor first.g2o second.g2o --renumber"),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "doctor",
        version: env!("CARGO_PKG_VERSION"),
        about: "Say what is wrong with a graph in any format, with numbers, consequences and remedies",
        place: Place(Phase::Start, 10),
        examples: EXAMPLES,
    };
    run::<Command>(
        identity,
        |command| &command.common,
        |command, context| {
            let findings = examined(command, context)?;
            let count = |severity| text::count(&findings, severity);
            let bad = count(Severity::Error) + count(Severity::Warning);
            Ok(if command.common.strict && bad > 0 { Outcome::CheckFailed } else { Outcome::Done })
        },
    )
}

fn examined(command: &Command, context: &mut Context) -> anyhow::Result<Vec<Finding>> {
    let inside = context.run_inside(|inner| read(&command.inputs, &command.reading, inner))?;
    let Reading { graph, .. } = inside.value;
    let effort = if command.thorough { Effort::Thorough } else { Effort::Usual };
    let mut findings: Vec<Finding> = Vec::new();
    for (doubt, sentence) in &inside.doubts {
        // A doubt is one sentence that ends with the remedy.
        let (title, remedy) = sentence.rsplit_once("; ").unwrap_or((sentence, ""));
        let finding = Finding::new(Severity::Warning, Topic::Input, "doubt", title.to_owned());
        let finding = finding.with("doubt", doubt.name());
        findings.push(finding.therefore("these covariances are not those of the sensor", remedy));
    }
    findings.extend(examine_by(&graph, effort));
    // Stable: what reading found comes first among equals.
    findings.sort_by_key(|finding| (finding.severity, finding.topic));
    let statistics = &mut context.statistics;
    statistics.note("nodes", graph.nodes.len());
    statistics.note("errors", text::count(&findings, Severity::Error));
    statistics.note("warnings", text::count(&findings, Severity::Warning));
    statistics.note("notes", text::count(&findings, Severity::Note));
    statistics.note("findings", &findings);
    context.write_bytes(text::report(&graph, &findings).as_bytes())?;
    Ok(findings)
}
