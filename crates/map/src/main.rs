//! `posecut-map`.

fn main() -> std::process::ExitCode {
    posecut_map::cli::main()
}
