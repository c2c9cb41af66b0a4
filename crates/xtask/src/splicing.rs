//! `cargo xtask splice`: replaces a section of a document by standard input.

use std::path::PathBuf;

use clap::Args;
use xtask::sections::replace;

use crate::Verdict;

/// Replace the text between `<!-- begin: NAME -->` and `<!-- end: NAME -->` in a document by standard input
#[derive(Args)]
pub(crate) struct Splice {
    document: PathBuf,
    name: String,
}

impl Splice {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        replace(&self.document, &self.name, &std::io::read_to_string(std::io::stdin())?)?;
        Ok(Verdict::Holds)
    }
}
