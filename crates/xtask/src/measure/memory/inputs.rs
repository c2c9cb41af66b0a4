//! Makes the inputs of programs by kind and size, each once.

use std::ffi::OsString;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Context as _;
use xtask::workspace::{program, root};

use super::run;

/// The kind of a program's input.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Metres,
    Session,
    SessionGraph,
    Graph,
    /// A graph without incorrect edges, for least-squares solvers.
    CleanGraph,
    Results,
    Seeds,
    Program,
}

impl Kind {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Metres => "metres",
            Self::Session => "session",
            Self::SessionGraph => "session graph",
            Self::Graph => "graph",
            Self::CleanGraph => "clean graph",
            Self::Results => "results",
            Self::Seeds => "seeds",
            Self::Program => "program",
        }
    }

    /// The unit of the size.
    pub(super) fn unit(self) -> &'static str {
        match self {
            Self::Metres | Self::Session | Self::SessionGraph => "m of driving",
            Self::Graph => "nodes",
            Self::CleanGraph => "nodes, correct edges alone",
            Self::Results => "results",
            Self::Seeds => "seeds",
            Self::Program => "program",
        }
    }
}

/// A folder with inputs.
pub(super) struct Inputs<'a> {
    folder: &'a Path,
}

impl<'a> Inputs<'a> {
    pub(super) fn new(folder: &'a Path) -> Self {
        Self { folder }
    }

    fn session(&self, metres: usize) -> anyhow::Result<PathBuf> {
        let path = self.folder.join(metres.to_string()).join("2012-01-22");
        if !path.exists() {
            let mut simulate = Command::new(program("simulate"));
            run(simulate.args(["-q", "--length", &metres.to_string(), "--rate", "40", "-o"]).arg(&path))?;
        }
        Ok(path)
    }

    fn file(&self, kind: Kind, size: usize) -> anyhow::Result<PathBuf> {
        let path = self.folder.join(format!("{}.{size}.jsonl", kind.name().replace(' ', "-")));
        if path.exists() {
            return Ok(path);
        }
        match kind {
            Kind::CleanGraph => {
                let mut oracle = Command::new(program("oracle"));
                oracle.arg("-q").arg(self.file(Kind::Graph, size)?).args(["--drop-rejected", "-o"]);
                run(oracle.arg(&path))?;
            }
            Kind::SessionGraph => {
                let mut ingest = Command::new(program("ingest"));
                run(ingest.arg("-q").arg(self.session(size)?).arg("-o").arg(&path))?;
            }
            Kind::Results => self.results(size, &path)?,
            _ => drawn_apart(size, &path)?,
        }
        Ok(path)
    }

    /// Writes one result under many seeds.
    fn results(&self, size: usize, path: &Path) -> anyhow::Result<()> {
        let (small, result) = (self.folder.join("small.jsonl"), self.folder.join("one.result.json"));
        drawn_apart(200, &small)?;
        let mut evaluate = Command::new(program("evaluate"));
        evaluate.arg("-q").arg(&small).args([
            "--label",
            "method=none",
            "--label",
            "session=a",
            "--label",
            "seed=1",
        ]);
        run(evaluate.arg("-o").arg(&result))?;
        let text = std::fs::read_to_string(&result)?;
        let line = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
        let (before, after) = line
            .split_once("\"seed\":")
            .and_then(|(before, rest)| Some((before, rest.trim_start().strip_prefix('1')?)))
            .context("the result of posecut-evaluate has no label seed=1")?;
        let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
        for seed in 0..size {
            writeln!(file, "{before}\"seed\":{seed}{after}")?;
        }
        Ok(file.flush()?)
    }

    /// The arguments of a program, and the number of bytes that it reads.
    pub(super) fn arguments(&self, kind: Kind, size: usize) -> anyhow::Result<(Vec<OsString>, u64)> {
        let output = self.folder.join("output");
        let words = |words: &[&dyn AsRef<std::ffi::OsStr>]| -> Vec<OsString> {
            words.iter().map(|word| word.as_ref().to_owned()).collect()
        };
        let number = size.to_string();
        Ok(match kind {
            Kind::Metres => (words(&[&"--length", &number, &"-o", &self.folder.join("2012-01-22")]), 0),
            Kind::Session => {
                let path = self.session(size)?;
                let mut read = 0;
                for entry in path.read_dir()? {
                    read += entry?.metadata()?.len();
                }
                (words(&[&path, &"-o", &output]), read)
            }
            Kind::Seeds => {
                let declaration = self.folder.join("memory.toml");
                let text = "sessions = [\"one\"]\nsimulated_sessions = [\"one\"]\nmethods = [\"none\"]\n[method]\nnone = []\noracle = [\"oracle\"]\n";
                std::fs::write(&declaration, text)?;
                let stages = root().join("pipelines/stages.toml");
                let given = words(&[&declaration, &"--seeds", &number, &"--stages", &stages, &"-o", &output]);
                (given, text.len() as u64)
            }
            Kind::Program => (words(&[&program("oracle")]), 0),
            _ => {
                let path = self.file(kind, size)?;
                let read = path.metadata()?.len();
                (words(&[&path, &"-o", &output]), read)
            }
        })
    }
}

/// Draws the graph in a separate process. Otherwise its memory would count towards the peak of the programs that this
/// process starts.
fn drawn_apart(nodes: usize, path: &Path) -> anyhow::Result<()> {
    let own = std::env::current_exe().context("the path of this program is unknown")?;
    run(Command::new(own).args(["measure", "graph", &nodes.to_string()]).arg(path))?;
    Ok(())
}
