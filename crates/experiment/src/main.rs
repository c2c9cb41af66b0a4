//! `posecut-experiment`.

fn main() -> std::process::ExitCode {
    posecut_experiment::cli::main()
}
