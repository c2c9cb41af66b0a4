//! `posecut-conform`.

fn main() -> std::process::ExitCode {
    posecut_conform::cli::main()
}
