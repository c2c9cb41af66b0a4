//! Simulates a file system that fails at the n-th call: a library for LD_PRELOAD that intercepts the calls by which programs
//! write.
//!
//! Environment variables: `FAILING_LOG` is a file that gets one line for each call, `NAME PATH`. `FAILING_AT` is the number of
//! the call that fails, from 1. `FAILING_ERRNO` is its error number, or 0 for a write that takes half of its bytes. With
//! `FAILING_ON`, every later call that needs space fails too, as on a full disk. Calls on standard error, devices and /proc are
//! not counted. Programs that the program starts run without the library.

#![cfg(all(target_os = "linux", target_pointer_width = "64"))]
#![expect(unsafe_code, reason = "functions of the C library can be replaced in no safe language")]
#![allow(
    missing_docs,
    clippy::missing_safety_doc,
    reason = "each function is what the manual page of its name describes"
)]
#![allow(unreachable_pub, reason = "the dynamic linker reaches them by name")]

use std::ffi::CStr;
use std::sync::atomic::{AtomicI64, Ordering};

use libc::{
    AT_FDCWD, S_IFDIR, S_IFIFO, S_IFMT, S_IFREG, c_char, c_int, c_long, c_uint, c_void, iovec, mode_t, off_t,
    size_t, ssize_t, syscall,
};

static CALLS: AtomicI64 = AtomicI64::new(0);
/// The number of the call that fails; 0 for none.
static AT: AtomicI64 = AtomicI64::new(0);
static ERRNO: AtomicI64 = AtomicI64::new(0);
static ON: AtomicI64 = AtomicI64::new(0);
static LOG: AtomicI64 = AtomicI64::new(-1);

#[used]
#[unsafe(link_section = ".init_array")]
static START: extern "C" fn() = start;

/// Runs before the program.
extern "C" fn start() {
    // SAFETY: one thread, before main; every string ends in NUL.
    unsafe {
        let number = |name: &CStr| {
            let text = libc::getenv(name.as_ptr());
            if text.is_null() { 0 } else { libc::atoll(text) }
        };
        AT.store(number(c"FAILING_AT"), Ordering::Relaxed);
        ERRNO.store(number(c"FAILING_ERRNO"), Ordering::Relaxed);
        ON.store(number(c"FAILING_ON"), Ordering::Relaxed);
        let log = libc::getenv(c"FAILING_LOG".as_ptr());
        if !log.is_null() {
            let flags = libc::O_WRONLY | libc::O_CREAT | libc::O_APPEND | libc::O_CLOEXEC;
            let opened = syscall(libc::SYS_openat, AT_FDCWD, log, flags, 0o600);
            // Use a high number, so that the program gets the same descriptors as without the library.
            LOG.store(syscall(libc::SYS_fcntl, opened, libc::F_DUPFD_CLOEXEC, 500), Ordering::Relaxed);
            syscall(libc::SYS_close, opened);
        }
        libc::unsetenv(c"LD_PRELOAD".as_ptr());
    }
}

/// The fate of a call.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fate {
    Happens,
    Fails,
    TakesHalf,
}

/// Whether a call needs space on the disk.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Needs {
    Space,
    Nothing,
}

/// Counts a call on a path, logs it, and decides its fate. It sets `errno` for a call that fails.
unsafe fn fate(name: &CStr, needs: Needs, path: &[u8]) -> Fate {
    let call = CALLS.fetch_add(1, Ordering::SeqCst) + 1;
    let log = LOG.load(Ordering::Relaxed);
    if log >= 0 {
        let mut line = [0_u8; 4400];
        let mut end = 0;
        for part in [name.to_bytes(), b" ", path, b"\n"] {
            let taken = part.len().min(line.len() - end);
            line[end..end + taken].copy_from_slice(&part[..taken]);
            end += taken;
        }
        unsafe { syscall(libc::SYS_write, log, line.as_ptr(), end) };
    }
    let (at, errno) = (AT.load(Ordering::Relaxed), ERRNO.load(Ordering::Relaxed));
    let later = at > 0 && call > at && needs == Needs::Space && ON.load(Ordering::Relaxed) != 0;
    match (call == at || later, errno) {
        (false, _) => Fate::Happens,
        (true, 0) => Fate::TakesHalf,
        (true, errno) => {
            unsafe { *libc::__errno_location() = errno as c_int };
            Fate::Fails
        }
    }
}

/// Whether calls on this descriptor count. They do for standard output of any kind, and for files that are open for writing.
unsafe fn counted(descriptor: c_int) -> bool {
    if descriptor == 2 || i64::from(descriptor) == LOG.load(Ordering::Relaxed) {
        return false;
    }
    unsafe {
        let mut status: libc::stat = std::mem::zeroed();
        if syscall(libc::SYS_fstat, descriptor, &raw mut status) != 0 {
            return false;
        }
        let kind = status.st_mode & S_IFMT;
        let flags = syscall(libc::SYS_fcntl, descriptor, libc::F_GETFL, 0);
        let written = flags & c_long::from(libc::O_ACCMODE) != c_long::from(libc::O_RDONLY);
        written && (kind == S_IFREG || (descriptor == 1 && kind == S_IFIFO)) && kind != S_IFDIR
    }
}

/// The fate of a call on a descriptor.
unsafe fn fate_of_descriptor(name: &CStr, needs: Needs, descriptor: c_int) -> Fate {
    if !unsafe { counted(descriptor) } {
        return Fate::Happens;
    }
    let mut place = *b"/proc/self/fd/\0\0\0\0\0\0\0\0\0\0\0\0";
    let (mut digits, mut rest) = ([0_u8; 10], descriptor);
    let mut length = 0;
    loop {
        digits[length] = b'0' + (rest % 10) as u8;
        length += 1;
        rest /= 10;
        if rest == 0 {
            break;
        }
    }
    for (position, digit) in digits[..length].iter().rev().enumerate() {
        place[14 + position] = *digit;
    }
    let mut path = [0_u8; 4096];
    let read =
        unsafe { syscall(libc::SYS_readlinkat, AT_FDCWD, place.as_ptr(), path.as_mut_ptr(), path.len()) };
    let path: &[u8] = if descriptor == 1 { b"standard output" } else { &path[..read.max(0) as usize] };
    unsafe { fate(name, needs, path) }
}

/// The fate of a call on a path.
unsafe fn fate_of_path(name: &CStr, needs: Needs, path: *const c_char) -> Fate {
    let path = unsafe { CStr::from_ptr(path) }.to_bytes();
    if path.starts_with(b"/dev/") || path.starts_with(b"/proc/") {
        return Fate::Happens;
    }
    unsafe { fate(name, needs, path) }
}

unsafe fn opened(name: &CStr, folder: c_int, path: *const c_char, flags: c_int, mode: mode_t) -> c_int {
    let writes = flags & libc::O_ACCMODE != libc::O_RDONLY || flags & libc::O_CREAT != 0;
    unsafe {
        if writes && fate_of_path(name, Needs::Space, path) != Fate::Happens {
            return -1;
        }
        syscall(libc::SYS_openat, folder, path, flags, mode) as c_int
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn open(path: *const c_char, flags: c_int, mode: mode_t) -> c_int {
    unsafe { opened(c"open", AT_FDCWD, path, flags, mode) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn open64(path: *const c_char, flags: c_int, mode: mode_t) -> c_int {
    unsafe { opened(c"open", AT_FDCWD, path, flags, mode) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn openat(folder: c_int, path: *const c_char, flags: c_int, mode: mode_t) -> c_int {
    unsafe { opened(c"openat", folder, path, flags, mode) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn openat64(folder: c_int, path: *const c_char, flags: c_int, mode: mode_t) -> c_int {
    unsafe { opened(c"openat", folder, path, flags, mode) }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn write(descriptor: c_int, bytes: *const c_void, count: size_t) -> ssize_t {
    unsafe {
        let count = match fate_of_descriptor(c"write", Needs::Space, descriptor) {
            Fate::Happens => count,
            Fate::TakesHalf => count.div_ceil(2),
            Fate::Fails => return -1,
        };
        syscall(libc::SYS_write, descriptor, bytes, count) as ssize_t
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn writev(descriptor: c_int, parts: *const iovec, count: c_int) -> ssize_t {
    unsafe {
        match fate_of_descriptor(c"writev", Needs::Space, descriptor) {
            Fate::Happens => syscall(libc::SYS_writev, descriptor, parts, count) as ssize_t,
            Fate::TakesHalf => {
                let first = &*parts;
                syscall(libc::SYS_write, descriptor, first.iov_base, first.iov_len.div_ceil(2)) as ssize_t
            }
            Fate::Fails => -1,
        }
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn pwrite64(d: c_int, bytes: *const c_void, count: size_t, offset: off_t) -> ssize_t {
    unsafe {
        let count = match fate_of_descriptor(c"pwrite", Needs::Space, d) {
            Fate::Happens => count,
            Fate::TakesHalf => count.div_ceil(2),
            Fate::Fails => return -1,
        };
        syscall(libc::SYS_pwrite64, d, bytes, count, offset) as ssize_t
    }
}

/// Closes the descriptor even if the call is to fail, as Linux does.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn close(descriptor: c_int) -> c_int {
    unsafe {
        let fate = fate_of_descriptor(c"close", Needs::Nothing, descriptor);
        let errno = *libc::__errno_location();
        let closed = syscall(libc::SYS_close, descriptor) as c_int;
        if fate == Fate::Happens {
            return closed;
        }
        *libc::__errno_location() = errno;
        -1
    }
}

/// Defines functions that return a number and fail completely. Each names the argument that decides its fate.
macro_rules! intercept {
    ($($name:ident($($argument:ident: $type:ty),+), $fate:ident($of:ident), $needs:ident => $($call:expr),+;)*) => {$(
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name($($argument: $type),+) -> c_int {
            const NAME: &CStr = match CStr::from_bytes_with_nul(concat!(stringify!($name), "\0").as_bytes()) {
                Ok(name) => name,
                Err(_) => c"?",
            };
            unsafe {
                if $fate(NAME, Needs::$needs, $of) != Fate::Happens {
                    return -1;
                }
                syscall($($call),+) as c_int
            }
        }
    )*};
}

intercept! {
    fsync(d: c_int), fate_of_descriptor(d), Space => libc::SYS_fsync, d;
    fdatasync(d: c_int), fate_of_descriptor(d), Space => libc::SYS_fdatasync, d;
    ftruncate64(d: c_int, size: off_t), fate_of_descriptor(d), Nothing => libc::SYS_ftruncate, d, size;
    fchmod(d: c_int, mode: mode_t), fate_of_descriptor(d), Nothing => libc::SYS_fchmod, d, mode;
    chmod(p: *const c_char, mode: mode_t), fate_of_path(p), Nothing => libc::SYS_fchmodat, AT_FDCWD, p, mode;
    mkdir(p: *const c_char, mode: mode_t), fate_of_path(p), Space => libc::SYS_mkdirat, AT_FDCWD, p, mode;
    unlink(p: *const c_char), fate_of_path(p), Nothing => libc::SYS_unlinkat, AT_FDCWD, p, 0;
    rmdir(p: *const c_char), fate_of_path(p), Nothing => libc::SYS_unlinkat, AT_FDCWD, p, libc::AT_REMOVEDIR;
    unlinkat(d: c_int, p: *const c_char, flags: c_int), fate_of_path(p), Nothing => libc::SYS_unlinkat, d, p, flags;
    rename(old: *const c_char, new: *const c_char), fate_of_path(new), Nothing
        => libc::SYS_renameat2, AT_FDCWD, old, AT_FDCWD, new, 0;
    renameat(from: c_int, old: *const c_char, to: c_int, new: *const c_char), fate_of_path(new), Nothing
        => libc::SYS_renameat2, from, old, to, new, 0;
    renameat2(from: c_int, old: *const c_char, to: c_int, new: *const c_char, flags: c_uint), fate_of_path(new), Nothing
        => libc::SYS_renameat2, from, old, to, new, flags;
    linkat(from: c_int, old: *const c_char, to: c_int, new: *const c_char, flags: c_int), fate_of_path(new), Space
        => libc::SYS_linkat, from, old, to, new, flags;
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn copy_file_range(
    from: c_int,
    from_offset: *mut off_t,
    to: c_int,
    to_offset: *mut off_t,
    count: size_t,
    flags: c_uint,
) -> ssize_t {
    unsafe {
        let count = match fate_of_descriptor(c"copy_file_range", Needs::Space, to) {
            Fate::Happens => count,
            Fate::TakesHalf => count.div_ceil(2),
            Fate::Fails => return -1,
        };
        syscall(libc::SYS_copy_file_range, from, from_offset, to, to_offset, count, flags) as ssize_t
    }
}

#[unsafe(no_mangle)]
pub unsafe extern "C" fn sendfile64(to: c_int, from: c_int, offset: *mut off_t, count: size_t) -> ssize_t {
    unsafe {
        let count = match fate_of_descriptor(c"sendfile", Needs::Space, to) {
            Fate::Happens => count,
            Fate::TakesHalf => count.div_ceil(2),
            Fate::Fails => return -1,
        };
        syscall(libc::SYS_sendfile, to, from, offset, count) as ssize_t
    }
}
