//! `posecut-multicut`.

fn main() -> std::process::ExitCode {
    posecut_multicut::cli::main()
}
