//! One entry point to all programs of posecut.
//!
//! `posecut NAME ...` does what `posecut-NAME ...` does. The program is searched beside `posecut`, then in `posecut` itself
//! ([`built_in`]), then on the PATH, so a stage of your own joins the others by its name. A program of another file replaces the
//! running process (on Windows `posecut` waits for it), so input, output and exit status are those of the program.

pub mod built_in;
pub mod entry;
pub mod listing;
