//! `posecut-voting`.

fn main() -> std::process::ExitCode {
    posecut_voting::cli::main()
}
