//! Closing what was written, and hearing whether it failed: a network file system or a quota may refuse the last bytes only then,
//! and the standard library does not tell.

use std::fs::File;
use std::io;

/// Closes a file. An error means that not everything that was written has arrived.
pub fn close(file: File) -> io::Result<()> {
    #[cfg(unix)]
    return close_descriptor(file.into());
    #[cfg(not(unix))]
    return file.sync_all();
}

/// Makes standard output say what closing it would say. It stays open.
pub(crate) fn close_standard_output() -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::fd::AsFd as _;
        // Closing a copy of the descriptor asks the same; without a free descriptor it cannot be asked.
        if let Ok(copy) = io::stdout().as_fd().try_clone_to_owned() {
            return close_descriptor(copy);
        }
    }
    Ok(())
}

#[cfg(unix)]
fn close_descriptor(descriptor: std::os::fd::OwnedFd) -> io::Result<()> {
    match nix::unistd::close(descriptor) {
        // It is closed all the same, and closing it again might close another file.
        Ok(()) | Err(nix::errno::Errno::EINTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
