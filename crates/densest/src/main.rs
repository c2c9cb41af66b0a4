//! `posecut-densest`.

fn main() -> std::process::ExitCode {
    posecut_densest::cli::main()
}
