//! `posecut-simulate-log`.

fn main() -> std::process::ExitCode {
    posecut_simulate_log::cli::main()
}
