//! `posecut-report table`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use posecut_report::published::Published;
use posecut_report::{results, table};

/// Options of `table`.
#[derive(Args)]
pub(crate) struct Table {
    /// Results of posecut-evaluate, or directories searched for *.result.json
    #[arg(required = true)]
    results: Vec<PathBuf>,

    /// How the table is written
    #[arg(long, value_enum, default_value_t = Format::Markdown)]
    format: Format,

    /// Published figures to stand beside ours (TOML)
    #[arg(long, value_name = "FILE")]
    published: Option<PathBuf>,

    /// Methods in the order of rows
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,

    /// Sessions asked for that have no data
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    missing: Vec<String>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// For people and README files
    Markdown,
    /// One row a run
    Csv,
    /// For papers
    Latex,
}

impl Table {
    pub(crate) fn write(&self) -> anyhow::Result<Vec<u8>> {
        let results = results::read_all(&self.results)?;
        let published =
            self.published.as_ref().map(|path| Published::read(path)).transpose()?.unwrap_or_default();
        let tables = table::tables(&results, &self.methods, &self.missing);
        Ok(match self.format {
            Format::Markdown => table::markdown(&tables, &published).into_bytes(),
            Format::Latex => table::latex(&tables, &published).into_bytes(),
            Format::Csv => table::write_csv(&results)?,
        })
    }
}
