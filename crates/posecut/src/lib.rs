//! One entry point to all programs of posecut.
//!
//! `posecut NAME ...` runs `posecut-NAME ...`. The program is searched beside `posecut` and then on the PATH, so a stage of your
//! own joins the others by its name. The program replaces the running process (on Windows `posecut` waits for it), so input,
//! output and exit status are those of the program.

pub mod entry;
pub mod listing;
pub mod registry;
