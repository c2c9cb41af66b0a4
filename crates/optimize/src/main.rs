//! `posecut-optimize`: pose-graph optimisation.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_optimize::stage::StageOptions>(env!("CARGO_PKG_VERSION"))
}
