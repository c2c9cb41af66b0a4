//! The documents that are made from the programs themselves, and what they should say.
//!
//! Every program describes its own command line (`--generate`), so a new one appears here without a change.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::registry::programs;
use crate::{program, workspace};

/// Around what is made in a program's README.
const BEGIN: &str = "<!-- options: made by `make documentation` -->\n";
const HEADING: &str = "\n## Options\n";
const END: &str = "<!-- end of options -->\n";

/// A document and what it should say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Page {
    /// Where it lies, from the root of the workspace.
    pub path: PathBuf,
    /// What it should say.
    pub text: String,
}

impl Page {
    /// Whether it says what it should.
    pub fn is_current(&self) -> bool {
        std::fs::read_to_string(workspace().join(&self.path)).is_ok_and(|text| text == self.text)
    }

    /// Makes it say so.
    pub fn write(&self) -> std::io::Result<()> {
        let path = workspace().join(&self.path);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        std::fs::write(path, &self.text)
    }
}

/// What a program says of itself.
///
/// # Panics
/// If it does not.
pub fn generated(name: &str, what: &str) -> String {
    let output = Command::new(program(name)).args(["--generate", what]).output().expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "posecut-{name} --generate {what}: {said}");
    String::from_utf8(output.stdout).expect("documentation is text")
}

/// All documents that are made.
///
/// # Panics
/// If a program does not run.
pub fn pages() -> Vec<Page> {
    let names = programs();
    let mut pages = vec![reference(&names), schema()];
    pages.extend(names.iter().filter_map(|name| readme(name)));
    pages
}

fn reference(names: &[String]) -> Page {
    let mut text = "# Command line reference\n\nMade from the programs by `make documentation`.\n\n\
        Every program takes the options of the first table beside its own. Exit status 0: done; 1: what was checked does\n\
        not hold; 2: an error, told in one sentence; 3, with `--strict`: done, and the result is doubtful\n\
        ([doubts.md](doubts.md)). `make install PREFIX=DIR` puts programs, manual pages and shell\n\
        completions into place; `posecut-pcm --generate man` prints one (also `bash`, `zsh`, `fish`, `elvish`, `powershell`).\n\n\
        ## Every program\n\n"
        .to_owned();
    text += &generated(&names[0], "common");
    for name in names {
        text.push('\n');
        text += &generated(name, "reference");
    }
    Page { path: "docs/cli.md".into(), text }
}

fn schema() -> Page {
    let mut text = serde_json::to_string_pretty(&posecut_graph::schema()).expect("a schema is JSON");
    text.push('\n');
    Page { path: "docs/schema/pose-graph-1.schema.json".into(), text }
}

/// A README with its table of options. One without a place for it gets the place: under the heading `## Options`, before
/// what stands there, or at its end.
fn readme(name: &str) -> Option<Page> {
    let path = Path::new("crates").join(name).join("README.md");
    let text = std::fs::read_to_string(workspace().join(&path)).ok()?;
    let made = format!("{BEGIN}\n{}\n{END}", generated(name, "options"));
    let place = text.find(BEGIN).zip(text.find(END)).filter(|(begin, end)| begin < end);
    let text = match (place, text.find(HEADING)) {
        (Some((begin, end)), _) => format!("{}{made}{}", &text[..begin], &text[end + END.len()..]),
        (None, Some(heading)) => {
            let (before, after) = text.split_at(heading + HEADING.len());
            format!("{before}\n{made}{after}")
        }
        (None, None) => format!("{text}{HEADING}\n{made}"),
    };
    Some(Page { path, text })
}
