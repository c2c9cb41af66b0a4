//! `posecut-convert`.

fn main() -> std::process::ExitCode {
    posecut_convert::cli::main()
}
