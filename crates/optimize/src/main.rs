//! `posecut-optimize`.

fn main() -> std::process::ExitCode {
    posecut_optimize::cli::main()
}
