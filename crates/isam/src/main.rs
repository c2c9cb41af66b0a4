//! `posecut-isam`.

fn main() -> std::process::ExitCode {
    posecut_isam::cli::main()
}
