//! `posecut-simulate`.

fn main() -> std::process::ExitCode {
    posecut_simulate::cli::main()
}
