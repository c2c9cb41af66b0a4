//! `posecut-doctor`.

fn main() -> std::process::ExitCode {
    posecut_doctor::cli::main()
}
