//! `posecut-ransac`.

fn main() -> std::process::ExitCode {
    posecut_ransac::cli::main()
}
