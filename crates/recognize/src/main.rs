//! `posecut-recognize`.

fn main() -> std::process::ExitCode {
    posecut_recognize::cli::main()
}
