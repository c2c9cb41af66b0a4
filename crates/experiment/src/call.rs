//! One call of a stage program: its limit, its CPU seconds, and the meaning of its failure.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use anyhow::{Context as _, bail};
use wait4::Wait4 as _;

use crate::Task;
use crate::digest::digest_path;
use crate::lock::Lock;
use crate::make_rules::shell;

/// The outcome of a task.
pub(crate) enum Outcome {
    /// The task wrote its outputs: SHA-256 of each, and CPU seconds summed over threads.
    Done { outputs: BTreeMap<String, String>, cpu_seconds: f64 },
    /// The method failed on this graph. This is a result and does not depend on the machine's state.
    FailedRun { said: String, cpu_seconds: f64, by_limit: bool },
}

/// Runs a task once.
pub(crate) fn call(task: &Task, lock: &Lock, threads: usize) -> anyhow::Result<Outcome> {
    for output in task.outputs.iter().chain(&task.statistics) {
        if let Some(folder) = Path::new(output).parent() {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("{}: cannot be created", folder.display()))?;
        }
    }
    let called = || task.argv.iter().map(|word| shell(word)).collect::<Vec<_>>().join(" ");
    let mut command = command(task);
    command.stdin(lock.stdin()?).stdout(Stdio::null()).stderr(Stdio::piped());
    if threads > 1 && std::env::var_os("RAYON_NUM_THREADS").is_none() {
        // Parallel tasks fill the processors already, and results do not depend on the number of threads.
        command.env("RAYON_NUM_THREADS", "1");
    }
    let mut child = command.spawn().with_context(|| format!("cannot be started: {}", called()))?;
    let mut said = Vec::new();
    if let Some(mut stderr) = child.stderr.take() {
        stderr
            .read_to_end(&mut said)
            .with_context(|| format!("its messages cannot be read: {}", called()))?;
    }
    let ended = child.wait4().with_context(|| format!("cannot be waited for: {}", called()))?;
    let cpu_seconds = (ended.rusage.utime + ended.rusage.stime).as_secs_f64();
    let said = String::from_utf8_lossy(&said);
    if let Some(limit) = task.cpu_limit {
        // The system's limit applies to each process. A script that calls several processes is checked here.
        if cpu_seconds >= limit as f64 || ended_by_limit(ended.status, cpu_seconds, limit as f64) {
            let said = format!("{}: stopped at {limit} CPU seconds", task.stage);
            return Ok(Outcome::FailedRun { said, cpu_seconds, by_limit: true });
        }
        if failed_by_itself(ended.status) {
            return Ok(Outcome::FailedRun { said: reason(task, &said), cpu_seconds, by_limit: false });
        }
    }
    if !ended.status.success() {
        let lines: Vec<&str> = said.lines().collect();
        let last = lines[lines.len().saturating_sub(3)..].join(" / ");
        bail!("{} of `{}`: {last}", ended.status, called());
    }
    let outputs = task.outputs.iter().map(|output| {
        let digest = digest_path(Path::new(output))
            .with_context(|| format!("`{}` succeeded but did not write {output}", called()))?;
        Ok((output.clone(), digest))
    });
    Ok(Outcome::Done { outputs: outputs.collect::<anyhow::Result<_>>()?, cpu_seconds })
}

/// The command of a task. If there is a limit, a shell sets it.
fn command(task: &Task) -> Command {
    let Some(limit) = task.cpu_limit.filter(|_| cfg!(unix)) else {
        let mut command = Command::new(&task.argv[0]);
        command.args(&task.argv[1..]);
        return command;
    };
    let mut command = Command::new("sh");
    // Allow one second more, so that the measured CPU seconds certainly exceed the limit.
    command.args(["-c", &format!("ulimit -t {} && exec \"$@\"", limit + 1), "sh"]).args(&task.argv);
    command
}

/// Whether the kernel ended a program at its limit. The kernel counts in ticks and may report less time afterwards.
#[cfg(unix)]
fn ended_by_limit(status: ExitStatus, cpu_seconds: f64, limit: f64) -> bool {
    use std::os::unix::process::ExitStatusExt as _;
    // SIGKILL at the hard limit, SIGXCPU at the soft one.
    matches!(status.signal(), Some(9 | 24)) && cpu_seconds >= 0.5 * limit
}

#[cfg(not(unix))]
fn ended_by_limit(_: ExitStatus, _: f64, _: f64) -> bool {
    false
}

/// Whether a program ended with an error of its own. A program that a signal ended says nothing about the method: somebody
/// interrupted it, or the machine ran out of memory.
fn failed_by_itself(status: ExitStatus) -> bool {
    // A shell uses 126 and above for signals and for programs that it could not start.
    status.code().is_some_and(|code| (1..126).contains(&code))
}

/// The last line of a program's messages, without folders, which differ from machine to machine.
fn reason(task: &Task, said: &str) -> String {
    let last = said.lines().last().unwrap_or("it failed without a message");
    let mut text = last.split_once("error: ").map_or(last, |(_, error)| error).to_owned();
    for path in task.inputs.iter().chain(&task.outputs) {
        if let Some(name) = Path::new(path).file_name() {
            text = text.replace(path.as_str(), &name.to_string_lossy());
        }
    }
    format!("{}: {text}", task.stage)
}
