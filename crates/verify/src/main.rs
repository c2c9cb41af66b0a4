//! `posecut-verify`.

fn main() -> std::process::ExitCode {
    posecut_verify::cli::main()
}
