//! `posecut-evaluate`.

fn main() -> std::process::ExitCode {
    posecut_evaluate::cli::main()
}
