//! Closes files and reports errors of closing: a network file system or a quota may refuse the last bytes only at that moment,
//! and the standard library ignores the error.

use std::fs::File;
use std::io;

/// Closes a file. An error means that some of the written bytes are lost.
pub fn close(file: File) -> io::Result<()> {
    #[cfg(unix)]
    return close_descriptor(file.into());
    #[cfg(not(unix))]
    return file.sync_all();
}

/// Reports the error that closing standard output would give, and leaves it open.
pub(crate) fn close_standard_output() -> io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::fd::AsFd as _;
        // Closing a copy of the descriptor gives the same error. Without a free descriptor there is no copy and no answer.
        if let Ok(copy) = io::stdout().as_fd().try_clone_to_owned() {
            return close_descriptor(copy);
        }
    }
    Ok(())
}

#[cfg(unix)]
fn close_descriptor(descriptor: std::os::fd::OwnedFd) -> io::Result<()> {
    match nix::unistd::close(descriptor) {
        // After EINTR the descriptor is closed too; closing it again might close another file.
        Ok(()) | Err(nix::errno::Errno::EINTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
