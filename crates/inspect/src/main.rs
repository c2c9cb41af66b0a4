//! `posecut-inspect`.

fn main() -> std::process::ExitCode {
    posecut_inspect::cli::main()
}
