//! `posecut-construct`.

fn main() -> std::process::ExitCode {
    posecut_construct::cli::main()
}
