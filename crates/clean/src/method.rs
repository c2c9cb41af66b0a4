//! How wrong landmark edges are found: by verification within this program, or by other stages as programs.

use std::fs::File;
use std::io::{BufReader, Seek as _};
use std::path::PathBuf;
use std::process::Stdio;

use anyhow::{Context as _, bail, ensure};
use posecut_graph::PoseGraph;
use posecut_stage::registry::{Program, Registry};

/// How wrong edges are found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Method {
    /// By `posecut-verify`.
    Verify,
    /// By these programs with their arguments, one after the other; none to use all edges.
    Stages(Vec<Stage>),
}

/// A program between graphs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stage {
    /// The name that the user gave.
    name: String,
    program: Program,
    arguments: Vec<String>,
}

/// The name of the method that rejects nothing.
const NONE: &str = "none";

impl Method {
    /// Reads `verify`, `none`, or stages joined by `+`, each with its options: `pcm --chance 3+multicut`. A name with a slash is
    /// the path of a program.
    ///
    /// # Errors
    ///
    /// There is no such program.
    pub fn parse(text: &str, registry: &Registry) -> anyhow::Result<Self> {
        match text.trim() {
            "verify" => Ok(Self::Verify),
            NONE => Ok(Self::Stages(Vec::new())),
            chain => {
                let stages = chain.split('+').map(|words| Stage::parse(text, words, registry));
                stages.collect::<anyhow::Result<_>>().map(Self::Stages)
            }
        }
    }
}

impl Stage {
    fn parse(text: &str, words: &str, registry: &Registry) -> anyhow::Result<Self> {
        let mut words = words.split_whitespace().map(str::to_owned);
        let Some(name) = words.next() else {
            bail!("--method {text:?} has no stage before or after a +; give names, such as pcm+multicut")
        };
        let program = if name.contains(std::path::is_separator) {
            Program { name: name.clone(), path: PathBuf::from(&name), built_in: false }
        } else {
            registry.get(&name).with_context(|| {
                format!(
                    "--method {text}: there is no program posecut-{name} beside this one or on the PATH; posecut help lists the programs"
                )
            })?
        };
        Ok(Self { name, program, arguments: words.collect() })
    }

    /// Gives the graph to the program, and returns what the program writes.
    ///
    /// # Errors
    ///
    /// The program cannot be started, fails, or writes no graph with the same nodes and edges.
    pub fn run(&self, graph: &PoseGraph) -> anyhow::Result<PoseGraph> {
        let name = &self.name;
        let temporary = || tempfile::tempfile().context("no temporary file can be created");
        let (mut given, mut written) = (temporary()?, temporary()?);
        graph.write(&mut given)?;
        given.rewind()?;
        // The output is read by another handle of the same file.
        let output: File = written.try_clone()?;
        let status = self
            .program
            .command()
            .args(&self.arguments)
            .args(["--quiet", "-"])
            .stdin(Stdio::from(given))
            .stdout(Stdio::from(output))
            .status()
            .with_context(|| format!("{name}: cannot be started"))?;
        ensure!(status.success(), "{name}: failed with {status}; its message is above");
        written.rewind()?;
        let judged = PoseGraph::read(&format!("the output of {name}"), BufReader::new(written))?;
        let same = judged.nodes.iter().map(|node| node.id).eq(graph.nodes.iter().map(|node| node.id))
            && judged.edges.iter().map(|edge| edge.id).eq(graph.edges.iter().map(|edge| edge.id));
        ensure!(
            same,
            "{name}: its output has other nodes or edges than its input; a stage marks edges and removes none (posecut-conform checks that)"
        );
        Ok(judged)
    }

    /// The name that the user gave.
    pub fn name(&self) -> &str {
        &self.name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_of_stages_are_read_with_their_options() {
        let registry = Registry::default();
        assert_eq!(Method::parse("verify", &registry).unwrap(), Method::Verify);
        assert_eq!(Method::parse("none", &registry).unwrap(), Method::Stages(Vec::new()));
        let Method::Stages(stages) = Method::parse("./one --chance 3+./two", &registry).unwrap() else {
            panic!("these are stages")
        };
        assert_eq!(stages[0].arguments, ["--chance", "3"]);
        assert_eq!((stages[0].name(), stages[1].name()), ("./one", "./two"));
        for (text, sentence) in
            [("nothing-like-it", "there is no program posecut-nothing-like-it"), ("./a+", "no stage")]
        {
            let error = Method::parse(text, &registry).unwrap_err().to_string();
            assert!(error.contains(sentence), "{error}");
        }
    }
}
