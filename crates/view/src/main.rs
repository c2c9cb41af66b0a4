//! `posecut-view`.

fn main() -> std::process::ExitCode {
    posecut_view::cli::main()
}
