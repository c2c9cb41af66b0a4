//! Running a command with a time limit.

use std::io::{Read, Write as _};
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};

/// The interval at which a running program is checked.
const LOOK: Duration = Duration::from_millis(3);

/// A command to check.
#[derive(Clone, Debug)]
pub struct Program {
    /// The command and its own options.
    pub arguments: Vec<String>,
    limit: Duration,
}

/// The outcome of a run.
#[derive(Clone, Debug)]
pub struct Run {
    /// The exit status; `None` if a signal or the time limit ended it.
    pub status: Option<i32>,
    /// How the run ended, in words.
    pub ending: String,
    /// Whether the signal of a closed pipe ended the run, as is usual for Unix programs.
    pub closed_pipe: bool,
    /// Standard output.
    pub stdout: Vec<u8>,
    /// Standard error.
    pub stderr: String,
}

impl Run {
    /// Whether the run ended with exit status 0.
    pub fn succeeded(&self) -> bool {
        self.status == Some(0)
    }

    /// How the run ended and the first line of its messages, for a report.
    pub fn said(&self) -> String {
        let lines = || self.stderr.lines().filter(|line| !line.trim().is_empty());
        // In a traceback, the last line names the error.
        let line = if self.stderr.contains("Traceback") { lines().next_back() } else { lines().next() };
        match line {
            Some(line) => format!("{}; its message: {line}", self.ending),
            None => format!("{}; no message", self.ending),
        }
    }
}

impl Program {
    /// A command with a time limit for each of its runs.
    pub fn new(arguments: Vec<String>, limit: Duration) -> anyhow::Result<Self> {
        if arguments.is_empty() {
            bail!("there is no program to check; name it after --, as in posecut-conform -- ./my-stage");
        }
        Ok(Self { arguments, limit })
    }

    /// Runs the command with more arguments and with standard input.
    pub fn run(&self, more: &[&str], input: &[u8]) -> anyhow::Result<Run> {
        self.start(more, input, false)
    }

    /// Runs the command in the same way, but closes its standard output.
    pub fn run_into_closed_pipe(&self, more: &[&str], input: &[u8]) -> anyhow::Result<Run> {
        self.start(more, input, true)
    }

    fn start(&self, more: &[&str], input: &[u8], close: bool) -> anyhow::Result<Run> {
        let name = &self.arguments[0];
        let mut child = Command::new(PathBuf::from(name))
            .args(&self.arguments[1..])
            .args(more)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .with_context(|| {
                format!("{name}: cannot be started; name an executable file, or a command on the PATH")
            })?;
        let mut stdin = child.stdin.take().context("the program's input is a pipe")?;
        let stdout = child.stdout.take().context("the program's output is a pipe")?;
        let stderr = child.stderr.take().context("the program's messages are a pipe")?;
        let stdout = if close {
            drop(stdout);
            thread::spawn(Vec::new)
        } else {
            thread::spawn(move || all_of(stdout))
        };
        let bytes = input.to_vec();
        // Ignore the error: a program may refuse its input early and close the pipe.
        let writer = thread::spawn(move || drop(stdin.write_all(&bytes)));
        let messages = thread::spawn(move || all_of(stderr));
        let status = self.wait(&mut child)?;
        drop(writer.join());
        let stdout = stdout.join().unwrap_or_default();
        let stderr = String::from_utf8_lossy(&messages.join().unwrap_or_default()).into_owned();
        let (ending, closed_pipe) = describe(status);
        Ok(Run { status: status.and_then(|status| status.code()), ending, closed_pipe, stdout, stderr })
    }

    /// Waits for the command; `None` if the time limit ended it.
    fn wait(&self, child: &mut Child) -> anyhow::Result<Option<ExitStatus>> {
        let end = Instant::now() + self.limit;
        loop {
            if let Some(status) = child.try_wait()? {
                return Ok(Some(status));
            }
            if Instant::now() >= end {
                child.kill()?;
                child.wait()?;
                return Ok(None);
            }
            thread::sleep(LOOK);
        }
    }
}

fn all_of(mut stream: impl Read) -> Vec<u8> {
    let mut bytes = Vec::new();
    // On an error, use the bytes that were read before.
    drop(stream.read_to_end(&mut bytes));
    bytes
}

/// The ending in words, and whether the signal of a closed pipe caused it. Shells report that signal as status 128 + 13.
fn describe(status: Option<ExitStatus>) -> (String, bool) {
    let Some(status) = status else { return ("time limit reached".to_owned(), false) };
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return (format!("ended by signal {signal}"), signal == 13);
    }
    let code = status.code().unwrap_or(-1);
    (format!("exit status {code}"), code == 128 + 13)
}
