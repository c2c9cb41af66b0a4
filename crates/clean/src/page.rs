//! The page of a run: the map before and after, what became of each landmark edge and why, and what is doubtful.

use std::path::Path;

use posecut_doctor::{Finding, Severity};
use posecut_graph::PoseGraph;
use posecut_view::{Alternative, Remark, View, page};

use crate::run::Cleaned;
use crate::summary::Input;

/// Makes the page of a cleaned graph, with its provenance.
pub(crate) fn page_of(graph: &PoseGraph, input: &Input, cleaned: &Cleaned) -> anyhow::Result<String> {
    let remarks: Vec<Remark> = cleaned.findings.iter().map(remark).collect();
    let alternatives: Vec<Alternative> =
        cleaned.alternatives.iter().map(|(name, graph)| Alternative { name, graph }).collect();
    let posed = cleaned.before.nodes.iter().any(|node| node.pose.is_some());
    page(&View {
        title: title(&input.name),
        before: posed.then_some(&cleaned.before),
        statistics: cleaned.verification.as_ref().map(|(_, statistics)| statistics.as_map()),
        remarks: &remarks,
        alternatives: &alternatives,
        ..View::of(graph)
    })
}

/// The name of a file without its folders.
fn title(name: &str) -> &str {
    Path::new(name).file_name().and_then(|name| name.to_str()).unwrap_or(name)
}

fn remark(finding: &Finding) -> Remark {
    Remark {
        severity: match finding.severity {
            Severity::Error => posecut_view::Severity::Error,
            Severity::Warning => posecut_view::Severity::Warning,
            Severity::Note => posecut_view::Severity::Note,
        },
        title: finding.title.clone(),
        text: sentence(&finding.consequence),
        remedy: finding.remedy.clone(),
    }
}

/// A part of a sentence as a sentence of its own. Names of programs stay as they are.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    if text.starts_with("posecut") {
        return format!("{text}.");
    }
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}
