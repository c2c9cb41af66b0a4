//! `posecut-report`.

fn main() -> std::process::ExitCode {
    posecut_report::cli::main()
}
