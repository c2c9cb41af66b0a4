//! Findings for people.

use posecut_graph::{EdgeKind, PoseGraph};

use crate::finding::{Finding, Severity};
use crate::words::counted;

/// Width of the column of topics: that of the longest name, and a space.
const COLUMN: usize = 13;

/// The number of findings of a severity.
pub fn count(findings: &[Finding], severity: Severity) -> usize {
    findings.iter().filter(|finding| finding.severity == severity).count()
}

/// The whole report: the size of the graph, errors and warnings with consequence and remedy, notes in a line each, and the counts. Control
/// characters of the graph's own names are left out. The name of the file is not in it, so that a file and a pipe give the same bytes.
pub fn report(graph: &PoseGraph, findings: &[Finding]) -> String {
    let mut text = format!(
        "{}, {}, {}, in {}\n",
        counted(graph.nodes.len(), "node"),
        counted(graph.edges_of(EdgeKind::Odometry).count(), "odometry edge"),
        counted(graph.edges_of(EdgeKind::Landmark).count(), "landmark edge"),
        if graph.header.dimension.number() == 2 { "the plane" } else { "space" }
    );
    let (notes, problems): (Vec<&Finding>, Vec<&Finding>) =
        findings.iter().partition(|finding| finding.severity == Severity::Note);
    for finding in problems {
        text += &format!("\n{} ({}): {}\n", finding.severity, finding.topic, finding.title);
        for (what, sentence) in [("consequence", &finding.consequence), ("remedy", &finding.remedy)] {
            if !sentence.is_empty() {
                text += &format!("  {what}: {sentence}\n");
            }
        }
    }
    if !notes.is_empty() {
        text.push('\n');
    }
    for finding in notes {
        text += &format!("{:COLUMN$} {}\n", finding.topic.name(), sentence(finding));
    }
    let [errors, warnings, notes] =
        [Severity::Error, Severity::Warning, Severity::Note].map(|severity| count(findings, severity));
    text += &format!(
        "\n{}, {}, {}\n",
        counted(errors, "error"),
        counted(warnings, "warning"),
        counted(notes, "note")
    );
    text.chars().filter(|character| *character == '\n' || !character.is_control()).collect()
}

/// A note with its consequence and remedy in one line.
fn sentence(finding: &Finding) -> String {
    let parts = [&finding.title, &finding.consequence, &finding.remedy];
    parts.into_iter().filter(|part| !part.is_empty()).map(String::as_str).collect::<Vec<_>>().join("; ")
}
