//! `posecut-clean`.

fn main() -> std::process::ExitCode {
    posecut_clean::command::main()
}
