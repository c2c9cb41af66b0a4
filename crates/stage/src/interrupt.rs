//! Ctrl-C and termination leave no half-written file behind.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Temporary files and folders being written now.
static TEMPORARY: Registry = Registry(Mutex::new(Vec::new()));

/// Exit status after an interrupt, as shells have it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// Paths to delete on an interrupt. Who holds the lock makes the handler, which runs in a thread of its own, wait.
struct Registry(Mutex<Vec<PathBuf>>);

impl Registry {
    fn lock(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes something that has a path, and registers it before an interrupt can happen.
    fn create<T: AsRef<Path>>(&'static self, make: impl FnOnce() -> io::Result<T>) -> io::Result<(T, Guard)> {
        let mut paths = self.lock();
        let made = make()?;
        paths.push(made.as_ref().to_owned());
        let guard = Guard { registry: self, path: made.as_ref().to_owned() };
        Ok((made, guard))
    }

    /// Deletes what is registered. As long as the lock that it returns is held, nothing new is made.
    fn tidy_up(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        let mut paths = self.lock();
        for path in paths.drain(..) {
            // Nothing is left to tell of a failure: the process ends.
            let _ = std::fs::remove_file(&path).or_else(|_| std::fs::remove_dir_all(&path));
        }
        paths
    }
}

/// While it lives, an interrupt deletes the file or folder.
pub(crate) struct Guard {
    registry: &'static Registry,
    path: PathBuf,
}

impl Drop for Guard {
    fn drop(&mut self) {
        self.registry.lock().retain(|path| *path != self.path);
    }
}

/// Makes a temporary file or folder that an interrupt deletes, however early it comes.
pub(crate) fn create<T: AsRef<Path>>(make: impl FnOnce() -> io::Result<T>) -> io::Result<(T, Guard)> {
    TEMPORARY.create(make)
}

/// Does what an interrupt must not find half done. It must make nothing by [`create`] and drop no [`Guard`].
pub(crate) fn uninterrupted<T>(work: impl FnOnce() -> T) -> T {
    let _held = TEMPORARY.lock();
    work()
}

/// Installs the handler; without one (no signals on the platform) the system's default stays.
pub(crate) fn install() {
    let installed = ctrlc::set_handler(|| {
        let _held = TEMPORARY.tidy_up();
        #[expect(clippy::exit, reason = "an interrupt ends the process; everything to tidy up is tidied up")]
        std::process::exit(INTERRUPTED);
    });
    if let Err(error) = installed {
        tracing::debug!("no interrupt handler: {error}");
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;

    /// An interrupt between the making of a file and its registration left the file behind.
    #[test]
    fn an_interrupt_that_comes_with_the_file_deletes_it() {
        static REGISTRY: Registry = Registry(Mutex::new(Vec::new()));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("half");
        let (made, interrupt) = mpsc::channel();
        let handler = std::thread::spawn(move || {
            interrupt.recv().unwrap();
            drop(REGISTRY.tidy_up());
        });
        let (_, guard) = REGISTRY
            .create(|| {
                std::fs::write(&path, "half")?;
                made.send(()).unwrap();
                // Time for a handler that does not wait.
                std::thread::sleep(Duration::from_millis(50));
                Ok(path.clone())
            })
            .unwrap();
        handler.join().unwrap();
        assert!(!path.exists());
        drop(guard);
    }

    #[test]
    fn what_is_finished_is_left_alone() {
        static REGISTRY: Registry = Registry(Mutex::new(Vec::new()));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("whole");
        let (_, guard) = REGISTRY.create(|| std::fs::write(&path, "whole").map(|()| path.clone())).unwrap();
        drop(guard);
        drop(REGISTRY.tidy_up());
        assert!(path.exists());
    }
}
