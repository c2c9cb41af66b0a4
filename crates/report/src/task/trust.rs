//! `posecut-report trust`.

use std::path::{Path, PathBuf};

use crate::figure::plotting::{Drawing, charts, lanes};
use crate::figure::regret::{figure, regrets};
use crate::figure::reliability::figure as diagram;
use crate::splice::splice;
use crate::trust::comparison::brief;
use crate::trust::document::sections;
use crate::trust::recommendation::recommended;
use crate::trust::records::{read_results, read_times};
use crate::trust::reliability::reliability;
use crate::trust::tables::{Table, tables};
use crate::trust::{Benchmark, Half};
use anyhow::{Context as _, ensure};
use clap::Args;
use posecut_stage::{Context, warn, write_atomically};

/// Number of panels in a row of a figure.
const COLUMNS: usize = 3;

/// Options of `trust`.
#[derive(Args)]
pub(crate) struct Trust {
    /// Results of the trust benchmark, one JSON object per line
    #[arg(required = true, value_name = "RESULTS")]
    results: Vec<PathBuf>,

    /// Read CPU times of the same runs from this file, one JSON object per line; may be repeated
    #[arg(long, value_name = "FILE")]
    times: Vec<PathBuf>,

    /// Report this half of every family
    #[arg(long, value_enum, default_value_t = Half::Test)]
    half: Half,

    /// Draw the regret of every run to this file (SVG, PDF or PNG, by its name)
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,

    /// Draw the share of correct edges over `verify_probability` to this file (SVG, PDF or PNG, by its name)
    #[arg(long, value_name = "FILE")]
    reliability: Option<PathBuf>,

    /// Write the answer and the tables between the markers of this document (docs/trust.md)
    #[arg(long, value_name = "FILE")]
    document: Option<PathBuf>,

    /// Write a comparison of the recommended and the best other method between the markers `trust` of this document (README.md)
    #[arg(long, value_name = "FILE")]
    summary: Option<PathBuf>,
}

impl Trust {
    pub(crate) fn write(&self, context: &mut Context) -> anyhow::Result<Vec<u8>> {
        for (option, path) in [
            ("--figure", &self.figure),
            ("--reliability", &self.reliability),
            ("--document", &self.document),
            ("--summary", &self.summary),
        ] {
            if let Some(path) = path {
                context.check_further_output(option, path)?;
            }
        }
        let benchmark = benchmark(&self.results, &self.times, context)?;
        check_half(&benchmark, self.half)?;
        if let Some(path) = &self.figure {
            let drawing = lanes(&figure(&regrets(&benchmark, self.half)), COLUMNS)?;
            write_figure(path, &drawing)?;
        }
        if let Some(path) = &self.reliability {
            if let Some(found) = reliability(&benchmark, self.half) {
                write_figure(path, &charts(&diagram(&found), COLUMNS)?)?;
            } else {
                warn!(
                    "{} was not written, because no result of the {} half has probabilities (`calibration`)",
                    path.display(),
                    self.half
                );
            }
        }
        if let Some(document) = &self.document {
            let link = self.reliability.as_deref().map(|diagram| link(document, diagram));
            fill(document, &sections(&benchmark, link.as_deref())?)?;
        }
        if let Some(document) = &self.summary {
            let chosen = recommended(&benchmark)?;
            fill(document, &[("trust", brief(&benchmark, self.half, chosen))])?;
        }
        context.statistics.note("runs", benchmark.runs.len());
        context.statistics.note("methods", benchmark.methods.len());
        let text: String = tables(&benchmark, self.half).iter().map(Table::markdown).collect();
        Ok(text.into_bytes())
    }
}

/// The link from a document to a file, which is relative if the file is in or below the document's folder.
fn link(document: &Path, file: &Path) -> String {
    let folder = document.parent().unwrap_or(Path::new(""));
    file.strip_prefix(folder).unwrap_or(file).display().to_string()
}

/// Replaces sections of a document between their markers.
fn fill(document: &Path, sections: &[(&str, String)]) -> anyhow::Result<()> {
    let place = || format!("{}: cannot be used", document.display());
    let mut text = std::fs::read_to_string(document).with_context(place)?;
    for (name, section) in sections {
        text = splice(&text, name, section).with_context(place)?;
    }
    write_atomically(document, |writer| Ok(writer.write_all(text.as_bytes())?))
}

/// Reads results and times, and records their digests in the context.
pub(crate) fn benchmark(
    results: &[PathBuf],
    times: &[PathBuf],
    context: &mut Context,
) -> anyhow::Result<Benchmark> {
    let mut records = Vec::new();
    for path in results {
        let (own, digest) = read_results(path)?;
        records.extend(own);
        context.inputs.push(digest);
    }
    let mut seconds = Vec::new();
    for path in times {
        let (own, digest) = read_times(path)?;
        seconds.extend(own);
        context.inputs.push(digest);
    }
    Benchmark::new(&records, (!times.is_empty()).then_some(&seconds))
}

/// Refuses a half that has no runs.
pub(crate) fn check_half(benchmark: &Benchmark, half: Half) -> anyhow::Result<()> {
    ensure!(
        benchmark.of(half, None).next().is_some(),
        "there is no run of the {half} half in the results of the trust benchmark; run the benchmark on it, or choose the other half (--half of `posecut-report trust`)"
    );
    Ok(())
}

fn write_figure(path: &Path, drawing: &Drawing) -> anyhow::Result<()> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let bytes = drawing.write(&extension).with_context(|| path.display().to_string())?;
    write_atomically(path, |writer| Ok(writer.write_all(&bytes)?))
}
