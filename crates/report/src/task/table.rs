//! `posecut-report table`.

use std::path::PathBuf;

use crate::published::Published;
use crate::{results, table};
use clap::{Args, ValueEnum};

/// Options of `table`.
#[derive(Args)]
pub(crate) struct Table {
    /// Results of posecut-evaluate, or directories to search for *.result.json
    #[arg(required = true)]
    results: Vec<PathBuf>,

    /// Choose the format of the table
    #[arg(long, value_enum, default_value_t = Format::Markdown)]
    format: Format,

    /// Add published figures from this TOML file
    #[arg(long, value_name = "FILE")]
    published: Option<PathBuf>,

    /// Show these methods first, in this order
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    methods: Vec<String>,

    /// Add columns for these sessions, which have no data
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    missing: Vec<String>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// For readers and README files
    Markdown,
    /// One row per run
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
