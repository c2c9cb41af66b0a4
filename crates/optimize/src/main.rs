//! `posecut-optimize`: pose-graph optimisation.

fn main() -> std::process::ExitCode {
    posecut_optimize::command::main()
}
