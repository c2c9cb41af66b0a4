//! `posecut-multicut`: a minimum-cost multicut of the landmark edges of a pose graph.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_multicut::stage::StageOptions>(env!("CARGO_PKG_VERSION"))
}
