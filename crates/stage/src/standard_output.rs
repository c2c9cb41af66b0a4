//! Standard output, whose failures count: a full device or a closed descriptor must not look like success.

use std::io;
#[cfg(target_os = "linux")]
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the program was started with standard output closed (`>&-`).
#[cfg(target_os = "linux")]
static CLOSED: AtomicBool = AtomicBool::new(false);

/// Runs before the standard library, which opens /dev/null in place of a closed descriptor, where results vanish.
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

/// Before another program takes the place of this one: gives it a standard output that is closed where this one's was.
pub fn hand_over_standard_output() {
    #[cfg(target_os = "linux")]
    if CLOSED.load(Ordering::Relaxed) {
        // In its place lies /dev/null, which would take what the program writes.
        let _ = nix::unistd::close(1);
    }
}
