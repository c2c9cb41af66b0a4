//! Runs work without the interpreter's lock, so that other threads of Python go on and Ctrl-C is answered.

use std::sync::OnceLock;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::Builder;
use std::time::Duration;

use pyo3::prelude::*;

use crate::error::{self, Error};

/// How often Python looks for signals while work runs.
const LOOK: Duration = Duration::from_millis(50);

/// The stack of a thread: as much as the main thread of a program has.
const STACK: usize = 8 << 20;

/// The process that first computed. Its threads for computations do not exist in a process that was forked from it.
static PROCESS: OnceLock<u32> = OnceLock::new();

/// Runs a computation, which may use threads of its own, as [`run`] does.
pub(crate) fn compute<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    let own = std::process::id();
    if *PROCESS.get_or_init(|| own) != own {
        return Err(Error::new_err(
            "this process was forked from one that had run a stage, whose threads do not exist here; start processes by the method \
             spawn or forkserver of multiprocessing",
        ));
    }
    run(py, work)
}

/// Runs work in a thread of its own and waits for it. On Ctrl-C the call ends with `KeyboardInterrupt` at once. The work has no
/// place at which it could stop; it ends in the background, and its result is dropped.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> anyhow::Result<T> + Send + 'static,
) -> PyResult<T> {
    let (sender, mut receiver) = channel();
    let send = move || {
        // No one may wait any more, after Ctrl-C.
        let _ = sender.send(work());
    };
    Builder::new().name("posecut".to_owned()).stack_size(STACK).spawn(send).map_err(|cause| {
        Error::new_err(format!("no further thread can be started ({cause}); end other threads or processes"))
    })?;
    loop {
        let received;
        (receiver, received) = py.detach(move || {
            let received = receiver.recv_timeout(LOOK);
            (receiver, received)
        });
        match received {
            Ok(result) => return result.map_err(|cause| error::error(&cause)),
            Err(RecvTimeoutError::Timeout) => py.check_signals()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Error::new_err(
                    "the work ended by a panic, which is an error in posecut; report it with the message above",
                ));
            }
        }
    }
}
