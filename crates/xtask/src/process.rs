//! Runs processes, and measures some of them.

use std::ffi::OsStr;
use std::io::Read;
use std::process::{Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use wait4::Wait4 as _;

/// Output, time and memory of a process that succeeded.
pub(crate) struct Measured {
    /// Standard output.
    pub(crate) output: Vec<u8>,
    /// Wall seconds.
    pub(crate) wall: f64,
    /// CPU seconds of all threads, in user and system mode.
    pub(crate) cpu: f64,
    /// Peak resident memory in bytes.
    pub(crate) peak: u64,
}

/// How a measured process ended.
pub(crate) enum Ended {
    Done(Measured),
    /// It failed, with this text on standard error.
    Failed(String),
    /// It reached the time limit and was stopped.
    OutOfTime,
}

impl Ended {
    /// The measurement if the process succeeded.
    pub(crate) fn done(self) -> Option<Measured> {
        match self {
            Ended::Done(measured) => Some(measured),
            _ => None,
        }
    }
}

/// The command as one would type it.
pub(crate) fn shown(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(OsStr::to_string_lossy).collect::<Vec<_>>().join(" ")
}

fn collected(stream: Option<impl Read + Send + 'static>) -> JoinHandle<Vec<u8>> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            // If reading fails, what was read so far is the output.
            let _ = stream.read_to_end(&mut bytes);
        }
        bytes
    })
}

/// Runs a process for at most `limit`. Only status 0 is success.
///
/// # Errors
/// If it cannot be started.
pub(crate) fn measure(command: &mut Command, limit: Duration) -> anyhow::Result<Ended> {
    measure_accepting(command, limit, &[0])
}

/// Runs a process for at most `limit`. The statuses in `good` are success.
///
/// # Errors
/// If it cannot be started.
pub(crate) fn measure_accepting(
    command: &mut Command,
    limit: Duration,
    good: &[i32],
) -> anyhow::Result<Ended> {
    let began = Instant::now();
    let called = shown(command);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    // On Linux a new process inherits its parent's peak memory: reset ours first.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    let mut child = command.spawn().with_context(|| format!("{called}: cannot be started"))?;
    let (output, said) = (collected(child.stdout.take()), collected(child.stderr.take()));
    let ended = loop {
        if let Some(ended) = child.try_wait4().with_context(|| format!("{called}: cannot be waited for"))? {
            break ended;
        }
        let seconds = began.elapsed();
        if seconds > limit {
            child.kill()?;
            child.wait()?;
            return Ok(Ended::OutOfTime);
        }
        // Short processes are polled more often, so that their wall time is exact.
        std::thread::sleep(Duration::from_micros(if seconds.as_secs() < 1 { 500 } else { 10_000 }));
    };
    let wall = began.elapsed().as_secs_f64();
    let (output, said) = (output.join().unwrap_or_default(), said.join().unwrap_or_default());
    if ended.status.code().is_none_or(|code| !good.contains(&code)) {
        return Ok(Ended::Failed(String::from_utf8_lossy(&said).trim().to_owned()));
    }
    let cpu = (ended.rusage.utime + ended.rusage.stime).as_secs_f64();
    Ok(Ended::Done(Measured { output, wall, cpu, peak: ended.rusage.maxrss }))
}

/// Runs a process that must succeed, and returns its standard output.
///
/// # Errors
/// If the process cannot be started or fails; the message has its standard error.
pub(crate) fn must(command: &mut Command) -> anyhow::Result<Vec<u8>> {
    let called = shown(command);
    let output = command.output().with_context(|| format!("{called}: cannot be started"))?;
    if !output.status.success() {
        bail!("{called}: {}", String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(output.stdout)
}

/// Runs a process that must succeed. Its messages go to the terminal.
///
/// # Errors
/// If the process cannot be started or fails.
pub(crate) fn visibly(command: &mut Command) -> anyhow::Result<()> {
    let called = shown(command);
    let status = command.status().with_context(|| format!("{called}: cannot be started"))?;
    if !status.success() {
        bail!("{called}: ended with {status}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_process_writes_and_says_is_known() {
        let ended = measure(Command::new("sh").args(["-c", "echo out"]), Duration::from_mins(1)).unwrap();
        let measured = ended.done().unwrap();
        assert_eq!(measured.output, b"out\n");
        assert!(measured.peak > 0);
        let ended =
            measure(Command::new("sh").args(["-c", "echo no >&2; exit 3"]), Duration::from_mins(1)).unwrap();
        assert!(matches!(ended, Ended::Failed(said) if said == "no"));
        let error = must(Command::new("sh").args(["-c", "echo no >&2; exit 3"])).unwrap_err().to_string();
        assert!(error.ends_with("exit 3: no"), "{error}");
    }

    #[test]
    fn a_process_beyond_its_limit_is_stopped() {
        let ended = measure(Command::new("sleep").arg("600"), Duration::from_millis(50)).unwrap();
        assert!(matches!(ended, Ended::OutOfTime));
    }

    /// Measuring scripts in Python used to report their own 15 MB as the peak of small programs.
    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_of_a_process_is_its_own() {
        let held = vec![1_u8; 256 << 20];
        assert_eq!(
            held.iter().step_by(4096).map(|&byte| usize::from(byte)).sum::<usize>(),
            held.len() / 4096
        );
        drop(held);
        let measured = measure(&mut Command::new("true"), Duration::from_mins(1)).unwrap().done().unwrap();
        assert!(measured.peak < 64 << 20, "{} MB", measured.peak >> 20);
    }
}
