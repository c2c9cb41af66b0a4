//! The context of a running stage: inputs read so far, statistics, doubts and common arguments.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read as _, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use posecut_graph::{InputDigest, PoseGraph, Provenance};
use serde::Serialize;
use tracing::subscriber::{NoSubscriber, with_default};

use crate::given::{Given, overwrites, same_file};
use crate::{CommonArguments, Doubt, Identity, Source, Statistics, input, output, threads};

/// The largest input that is read into memory as a whole: 1 GiB.
const LARGEST_WHOLE: u64 = 1 << 30;

/// The option that names the file of the statistics.
const STATS: &str = "--stats";

/// The option that names the file of the result.
const OUTPUT: &str = "--output";

/// Writes the content of a file.
type Content = Box<dyn FnOnce(&mut dyn Write) -> anyhow::Result<()> + Send>;

/// What a stage that ran inside another program returned and reported.
#[derive(Clone, Debug)]
pub struct Inside<T> {
    /// What it returned.
    pub value: T,
    /// Its figures for `--stats`.
    pub statistics: Statistics,
    /// Its doubts with their sentences.
    pub doubts: Vec<(Doubt, String)>,
}

/// Inputs read so far, statistics, and the common arguments.
pub struct Context {
    /// Figures for `--stats`.
    pub statistics: Statistics,
    /// The digests of the files read, for the provenance.
    pub inputs: Vec<InputDigest>,
    pub(crate) doubts: BTreeSet<Doubt>,
    /// The doubts raised so far with their sentences.
    pub(crate) doubt_messages: Vec<(Doubt, String)>,
    identity: Identity,
    common: CommonArguments,
    started: Instant,
    given: Given,
    /// Files read so far, including files that no argument names.
    opened: Vec<PathBuf>,
    /// Whether standard input was read.
    standard_input_read: bool,
    /// The content to write beside the result, by the option that names the file.
    further: BTreeMap<&'static str, Content>,
}

impl Context {
    /// For a stage that runs inside another program: the library of a stage, a test.
    pub fn new(identity: Identity, common: CommonArguments) -> Self {
        Self {
            statistics: Statistics::default(),
            inputs: Vec::new(),
            doubts: BTreeSet::new(),
            doubt_messages: Vec::new(),
            identity,
            common,
            started: Instant::now(),
            given: Given::default(),
            opened: Vec::new(),
            standard_input_read: false,
            further: BTreeMap::new(),
        }
    }

    /// Runs a stage inside this program. It prints nothing: its messages, statistics and doubts are returned, and this program
    /// reports what it wants of them ([`Self::doubt`]).
    pub fn run_inside<T>(
        &self,
        stage: impl FnOnce(&mut Self) -> anyhow::Result<T>,
    ) -> anyhow::Result<Inside<T>> {
        let mut inner = Self::new(self.identity, self.common.clone());
        let value = with_default(NoSubscriber::default(), || stage(&mut inner))?;
        Ok(Inside { value, statistics: inner.statistics, doubts: inner.doubt_messages })
    }

    /// Sets the files that the command line of the program names.
    pub(crate) fn with_files(self, given: Given) -> Self {
        Self { given, ..self }
    }

    /// Limits the number of threads to the number of processors.
    pub(crate) fn bound_threads(&mut self) {
        self.common.threads = threads::bounded(self.common.threads);
    }

    /// The number of threads the user allows, at most one for each processor; 0 means all processors.
    pub fn threads(&self) -> usize {
        self.common.threads
    }

    /// The file of the result; `None` if it is standard output.
    pub fn output_path(&self) -> Option<&Path> {
        self.common.output.path()
    }

    /// Reads a pose graph. `role` is what the provenance calls it: never a path, so that a pipe and a file
    /// give the same bytes.
    pub fn read_graph(&mut self, source: &Source, role: &str) -> anyhow::Result<PoseGraph> {
        self.note_opened(source)?;
        let mut input = input::open(source)?;
        let name = input.name.clone();
        let graph = PoseGraph::read(&name, &mut input)?;
        let sha256 = input.finish().with_context(|| format!("{name}: cannot be read to its end"))?;
        self.inputs.push(InputDigest { name: role.to_owned(), sha256 });
        Ok(graph)
    }

    /// Reads an input that is not a pose graph, as a whole. Returns its name for messages and its bytes.
    pub fn read_bytes(&mut self, source: &Source, role: &str) -> anyhow::Result<(String, Vec<u8>)> {
        self.note_opened(source)?;
        let mut input = input::open(source)?;
        let name = input.name.clone();
        let mut bytes = Vec::new();
        (&mut input)
            .take(LARGEST_WHOLE + 1)
            .read_to_end(&mut bytes)
            .with_context(|| format!("{name}: cannot be read to its end"))?;
        if bytes.len() as u64 > LARGEST_WHOLE {
            bail!(
                "{name}: exceeds {} MiB, the largest size for files of this kind; split the file",
                LARGEST_WHOLE >> 20
            );
        }
        let sha256 = input.finish().with_context(|| format!("{name}: cannot be read to its end"))?;
        self.inputs.push(InputDigest { name: role.to_owned(), sha256 });
        Ok((name, bytes))
    }

    /// Notes a file that is read by other means, so that no output may replace it.
    pub fn note_read(&mut self, path: impl Into<PathBuf>) {
        self.opened.push(path.into());
    }

    /// Notes an input. Standard input can be read once; a second reader would find it empty.
    fn note_opened(&mut self, source: &Source) -> anyhow::Result<()> {
        match source {
            Source::File(path) => self.opened.push(path.clone()),
            Source::Standard if std::mem::replace(&mut self.standard_input_read, true) => {
                bail!("only one input can be standard input; name files for the others")
            }
            Source::Standard => {}
        }
        Ok(())
    }

    /// Adds this run, with the doubts raised so far, to the history of a graph.
    pub fn record_provenance<A: Serialize>(
        &self,
        graph: &mut PoseGraph,
        arguments: &A,
        seed: Option<u64>,
    ) -> anyhow::Result<()> {
        let arguments = serde_json::to_value(arguments).context("the arguments cannot be written as JSON")?;
        graph.header.push_provenance(&Provenance {
            stage: self.identity.name.to_owned(),
            version: self.identity.version.to_owned(),
            arguments,
            seed,
            inputs: self.inputs.clone(),
            doubts: self.doubts().into_iter().map(str::to_owned).collect(),
        });
        Ok(())
    }

    /// Writes the stage's graph to its output.
    pub fn write_graph(&self, graph: &PoseGraph) -> anyhow::Result<()> {
        output::write_output(&self.common.output, |writer| Ok(graph.write(writer)?))
    }

    /// Writes the stage's graph to its output in another format than JSON Lines. The output may replace the input.
    pub fn write_graph_bytes(&self, bytes: &[u8]) -> anyhow::Result<()> {
        output::write_output(&self.common.output, |writer| Ok(writer.write_all(bytes)?))
    }

    /// Writes the stage's output in any format. The output may not replace an input.
    pub fn write_bytes(&self, bytes: &[u8]) -> anyhow::Result<()> {
        self.check_output()?;
        output::write_output(&self.common.output, |writer| Ok(writer.write_all(bytes)?))
    }

    /// A progress bar over a known amount of work. It is drawn only on a terminal and without `--quiet`.
    pub fn progress(&self, length: u64, what: &str) -> ProgressBar {
        let target =
            if self.common.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style = ProgressStyle::with_template("{msg} [{bar:30}] {percent}% {eta}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        ProgressBar::with_draw_target(Some(length), target).with_style(style).with_message(what.to_owned())
    }

    /// Redraws a bar at this interval even when nothing advances it. That needs a thread, and the library panics if it cannot
    /// start one; in that case the bar is redrawn only when it advances.
    pub fn keep_drawing(&self, progress: &ProgressBar, interval: Duration) {
        if !progress.is_hidden() && threads::probe().is_ok() {
            progress.enable_steady_tick(interval);
        }
    }

    /// Checks a file that `option` names and that is written beside the result. Refuses it if it would overwrite the result, an
    /// input or another file of the command line, or if it is called `-`.
    ///
    /// Call it before the work is done.
    pub fn check_further_output(&self, option: &str, path: &Path) -> anyhow::Result<()> {
        if path == Path::new("-") {
            bail!("{option} cannot be -, because only --output may be standard output; name a file");
        }
        if path.is_dir() {
            bail!("{}: is a folder, but {option} writes a file; name a file", path.display());
        }
        let stats = self.common.stats.as_deref().filter(|_| option != STATS);
        let read = self.opened.iter().map(|opened| (Some(opened.as_path()), "as input"));
        for (other, what) in
            [(self.common.output.path(), "as output"), (stats, "for --stats")].into_iter().chain(read)
        {
            if other.is_some_and(|other| overwrites(path, other)) {
                return Err(overwritten(path, what, option));
            }
        }
        let output = self.common.output.path().filter(|output| output.is_dir());
        if output.zip(path.parent()).is_some_and(|(output, folder)| same_file(output, folder)) {
            bail!(
                "{}: {option} names a file in the folder that --output replaces; name a file elsewhere",
                path.display()
            );
        }
        self.given.other(option, path).map_or(Ok(()), |what| Err(overwritten(path, what, option)))
    }

    /// Hands over the content of a [further output](crate::GraphStage::further_outputs) for the option that names its file. The
    /// content is written after the run.
    pub fn further_output(
        &mut self,
        option: &'static str,
        write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()> + Send + 'static,
    ) {
        self.further.insert(option, Box::new(write));
    }

    /// Writes the content that was handed over for `option`.
    pub(crate) fn write_further_output(&mut self, option: &str, path: &Path) -> anyhow::Result<()> {
        match self.further.remove(option) {
            Some(write) => output::write_atomically(path, write),
            None => bail!("{}: this run has nothing to write for {option}; omit the option", path.display()),
        }
    }

    /// Refuses a result that would overwrite an input. Call it only for results other than graphs: a graph may replace its input.
    pub fn check_output(&self) -> anyhow::Result<()> {
        let Some(path) = self.common.output.path() else { return Ok(()) };
        let opened = self.opened.iter().any(|opened| overwrites(path, opened)).then_some("as input");
        let what = opened.or_else(|| self.given.other(OUTPUT, path));
        what.map_or(Ok(()), |what| Err(overwritten(path, what, OUTPUT)))
    }

    /// Refuses a `--stats` file that would overwrite the result or another file.
    pub(crate) fn check_outputs(&self) -> anyhow::Result<()> {
        self.common.stats.as_deref().map_or(Ok(()), |stats| self.check_further_output(STATS, stats))
    }

    pub(crate) fn write_statistics(&self) -> anyhow::Result<()> {
        let Some(path) = &self.common.stats else { return Ok(()) };
        // Check again: only now all inputs are known.
        self.check_outputs()?;
        let mut all = Statistics::default();
        all.note("stage", self.identity.name);
        all.note("version", self.identity.version);
        for (name, value) in self.statistics.as_map() {
            all.note(name, value);
        }
        all.note("doubts", self.doubts());
        all.note("seconds", self.started.elapsed().as_secs_f64());
        output::write_atomically(path, |writer| {
            serde_json::to_writer_pretty(&mut *writer, all.as_map())?;
            Ok(writer.write_all(b"\n")?)
        })
    }
}

fn overwritten(path: &Path, what: &str, option: &str) -> anyhow::Error {
    anyhow::anyhow!(
        "{}: is named both {what} and for {option}, so one would overwrite the other; name two files",
        path.display()
    )
}
