//! `posecut-isam`: incremental pose-graph optimisation.

fn main() -> std::process::ExitCode {
    posecut_isam::stage::main()
}
