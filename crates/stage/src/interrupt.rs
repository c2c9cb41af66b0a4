//! Removes half-written files on Ctrl-C and termination.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Temporary files and folders being written now.
static TEMPORARY: Registry = Registry(Mutex::new(Vec::new()));

/// Exit status after an interrupt, as shells have it: 128 + SIGINT.
const INTERRUPTED: i32 = 130;

/// The number of attempts to delete a folder.
const DELETIONS: usize = 100;

/// Paths to delete on an interrupt. The handler runs in a thread of its own and waits while another thread holds the lock.
struct Registry(Mutex<Vec<PathBuf>>);

impl Registry {
    fn lock(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes something that has a path, and registers it before an interrupt can happen. The guard comes first in the result:
    /// a function that ends early drops it last, so the path is still registered while the file is deleted.
    fn create<T: AsRef<Path>>(&'static self, make: impl FnOnce() -> io::Result<T>) -> io::Result<(Guard, T)> {
        let mut paths = self.lock();
        let made = make()?;
        paths.push(made.as_ref().to_owned());
        let guard = Guard { registry: self, path: made.as_ref().to_owned() };
        Ok((guard, made))
    }

    /// Deletes all registered paths. Nothing new is made while the returned lock is held.
    fn tidy_up(&self) -> MutexGuard<'_, Vec<PathBuf>> {
        let mut paths = self.lock();
        for path in paths.drain(..) {
            delete(&path, || ());
        }
        paths
    }
}

/// Deletes a file or a folder that another thread may still be filling. A folder is renamed first, so that the other thread
/// makes nothing new in it. `begun` is called when the deletion of a folder begins.
fn delete(path: &Path, begun: impl Fn()) {
    // Ignore failures: the process ends, so nobody would handle them.
    if std::fs::remove_file(path).is_ok() {
        return;
    }
    let mut name = path.as_os_str().to_owned();
    name.push(".removed.tmp");
    let renamed = Path::new(&name);
    let path = if std::fs::rename(path, renamed).is_ok() { renamed } else { path };
    begun();
    for _ in 0..DELETIONS {
        // Try again: the other thread may be deleting the same folder, entry by entry.
        if std::fs::remove_dir_all(path).is_ok() || !path.exists() {
            return;
        }
    }
}

/// As long as the guard lives, an interrupt deletes the file or folder.
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
pub(crate) fn create<T: AsRef<Path>>(make: impl FnOnce() -> io::Result<T>) -> io::Result<(Guard, T)> {
    TEMPORARY.create(make)
}

/// Does work that an interrupt must not split. The work must not call [`create`] or drop a [`Guard`]: it would wait for itself.
pub(crate) fn uninterrupted<T>(work: impl FnOnce() -> T) -> T {
    let _held = TEMPORARY.lock();
    work()
}

/// Installs the handler. If that fails (no signals on the platform), the system's default stays.
pub(crate) fn install() {
    let installed = ctrlc::set_handler(|| {
        let _held = TEMPORARY.tidy_up();
        #[expect(clippy::exit, reason = "an interrupt ends the process; everything to tidy up is tidied up")]
        std::process::exit(INTERRUPTED);
    });
    if let Err(error) = installed {
        tracing::debug!("the interrupt handler cannot be installed: {error}");
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use std::sync::mpsc;
    use std::time::Duration;

    use super::*;

    /// Regression: an interrupt between the creation of a file and its registration left the file behind.
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
        let (guard, _) = REGISTRY
            .create(|| {
                std::fs::write(&path, "half")?;
                made.send(()).unwrap();
                // Give a handler that does not wait enough time to run.
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
        let (guard, _) = REGISTRY.create(|| std::fs::write(&path, "whole").map(|()| path.clone())).unwrap();
        drop(guard);
        drop(REGISTRY.tidy_up());
        assert!(path.exists());
    }

    /// Regression: a folder remained, because the main thread made another file in it after its files were deleted and before
    /// the folder itself was.
    #[test]
    fn nothing_new_is_made_in_a_folder_that_is_being_deleted() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join(".posecut-x.tmp");
        std::fs::create_dir(&folder).unwrap();
        std::fs::write(folder.join("first"), "half").unwrap();
        delete(&folder, || {
            assert!(std::fs::write(folder.join("second"), "half").is_err(), "the folder still has its name");
        });
        assert_eq!(std::fs::read_dir(parent.path()).unwrap().count(), 0);
    }

    /// Regression: a function that ended early unregistered its folder before it deleted the folder.
    #[test]
    fn a_folder_is_registered_until_it_is_deleted() {
        static REGISTRY: Registry = Registry(Mutex::new(Vec::new()));
        struct Folder(PathBuf);
        impl AsRef<Path> for Folder {
            fn as_ref(&self) -> &Path {
                &self.0
            }
        }
        impl Drop for Folder {
            fn drop(&mut self) {
                assert!(REGISTRY.lock().contains(&self.0));
            }
        }
        let ends_early = || {
            let (_guard, _folder) = REGISTRY.create(|| Ok(Folder(PathBuf::from("x")))).unwrap();
        };
        ends_early();
        assert!(REGISTRY.lock().is_empty());
    }
}
