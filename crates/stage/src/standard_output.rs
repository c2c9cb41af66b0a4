//! Errors of standard output: a full device or a closed descriptor must not look like success.

use std::io;
#[cfg(target_os = "linux")]
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the program was started with standard output closed (`>&-`).
#[cfg(target_os = "linux")]
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Runs before the standard library starts. The library opens /dev/null in place of a closed descriptor, so results would vanish.
#[cfg(target_os = "linux")]
#[used]
#[expect(
    unsafe_code,
    reason = "the linker's list of functions to call before main, which nothing safe can name"
)]
#[unsafe(link_section = ".init_array")]
static LOOK: extern "C" fn() = {
    extern "C" fn look() {
        let missing = |path: &str| {
            std::fs::symlink_metadata(path).is_err_and(|error| error.kind() == io::ErrorKind::NotFound)
        };
        CLOSED.store(missing("/proc/self/fd/1") && !missing("/proc/self/fd"), Ordering::Relaxed);
    }
    look
};

/// Refuses a standard output that was closed before the program started.
pub(crate) fn check() -> io::Result<()> {
    #[cfg(target_os = "linux")]
    if CLOSED.load(Ordering::Relaxed) {
        let message = "it is closed; name a file with -o, or leave it open";
        return Err(io::Error::new(io::ErrorKind::NotConnected, message));
    }
    Ok(())
}

/// Closes standard output again if it was closed at the start. Call it before another program replaces this one.
pub fn hand_over_standard_output() {
    #[cfg(target_os = "linux")]
    if CLOSED.load(Ordering::Relaxed) {
        // Descriptor 1 is /dev/null now, which would swallow the output of the next program.
        let _ = nix::unistd::close(1);
    }
}
