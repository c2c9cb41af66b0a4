//! `posecut-islands`.

fn main() -> std::process::ExitCode {
    posecut_islands::cli::main()
}
