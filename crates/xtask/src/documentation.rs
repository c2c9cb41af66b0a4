//! Documents that are generated from the programs.
//!
//! Every program describes its own command line (`--generate`), so a new program needs no change here.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail};
use serde_json::Value;

use crate::splice::splice;
use crate::workspace::root;

/// The name of the section in a program's README, and the heading above it.
const SECTION: &str = "options";
const HEADING: &str = "\n## Options\n";

/// A document and its text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Page {
    /// The path from the root of the workspace.
    pub path: PathBuf,
    /// The text that it should have.
    pub text: String,
}

impl Page {
    /// Whether the document has this text.
    pub fn is_current(&self) -> bool {
        std::fs::read_to_string(root().join(&self.path)).is_ok_and(|text| text == self.text)
    }

    /// Writes the document.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self) -> anyhow::Result<()> {
        let path = root().join(&self.path);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        std::fs::write(&path, &self.text).with_context(|| format!("{}: cannot be written", path.display()))
    }
}

/// The output of a program with `--generate`.
///
/// # Errors
/// If the program cannot be run or fails.
pub fn generated(program: &Path, what: &str) -> anyhow::Result<String> {
    let called = || format!("{} --generate {what}", program.display());
    let output = Command::new(program).args(["--generate", what]).output().with_context(called)?;
    if !output.status.success() {
        bail!("{}: {}", called(), String::from_utf8_lossy(&output.stderr).trim());
    }
    String::from_utf8(output.stdout).with_context(called)
}

/// All generated documents. `names` are the programs' names without `posecut-`, `program` gives the path for a name,
/// and `schema` is the format's schema.
///
/// # Errors
/// If a program does not run or a README cannot be read.
pub fn pages(
    names: &[String],
    program: impl Fn(&str) -> PathBuf,
    schema: &Value,
) -> anyhow::Result<Vec<Page>> {
    let mut pages = vec![reference(names, &program)?, schema_page(schema)?];
    for name in names {
        pages.extend(readme(name, &program(name))?);
    }
    Ok(pages)
}

fn reference(names: &[String], program: impl Fn(&str) -> PathBuf) -> anyhow::Result<Page> {
    let mut text = "# Command line reference\n\nGenerated from the programs by `make documentation`.\n\n\
        Every program has the options of the first table in addition to its own. Its exit status is 0 after success; 1 if a\n\
        check failed; 2 after an error, with a message in one sentence; and 3, only with `--strict`, after success with a\n\
        doubtful result ([doubts.md](doubts.md)). `make install PREFIX=DIR` installs programs, manual pages and shell\n\
        completions. `posecut-pcm --generate man` prints the manual page of one program; `bash`, `zsh`, `fish`, `elvish` and\n\
        `powershell` print its completions.\n\n\
        ## Every program\n\n"
        .to_owned();
    if let Some(first) = names.first() {
        text += &generated(&program(first), "common")?;
    }
    for name in names {
        text.push('\n');
        text += &generated(&program(name), "reference")?;
    }
    Ok(Page { path: "docs/cli.md".into(), text })
}

fn schema_page(schema: &Value) -> anyhow::Result<Page> {
    let text = serde_json::to_string_pretty(schema)? + "\n";
    Ok(Page { path: "docs/schema/pose-graph-1.schema.json".into(), text })
}

/// A README with its table of options. If it lacks the section, add it under the heading `## Options`, before the text
/// there, or at the end.
fn readme(name: &str, program: &Path) -> anyhow::Result<Option<Page>> {
    let path = Path::new("crates").join(name).join("README.md");
    let Ok(mut text) = std::fs::read_to_string(root().join(&path)) else { return Ok(None) };
    let (begin, end) = (format!("<!-- begin: {SECTION} -->\n"), format!("<!-- end: {SECTION} -->\n"));
    if !text.contains(&begin) {
        if !text.contains(HEADING) {
            text += HEADING;
        }
        text = text.replacen(HEADING, &format!("{HEADING}\n{begin}{end}"), 1);
    }
    let options = generated(program, "options")?;
    let text = splice(&text, SECTION, &options).with_context(|| path.display().to_string())?;
    Ok(Some(Page { path, text }))
}
