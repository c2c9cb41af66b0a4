//! `posecut-label`.

fn main() -> std::process::ExitCode {
    posecut_label::cli::main()
}
