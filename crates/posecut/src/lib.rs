//! One entry point to all programs of posecut.
//!
//! `posecut NAME ...` does what `posecut-NAME ...` does: the program is looked for beside `posecut` and then on the PATH, so that a
//! stage of your own joins the others by its name. It takes the place of the running process (on Windows it is waited for), and
//! input, output and exit status are its own.

pub mod entry;
pub mod listing;
pub mod registry;
