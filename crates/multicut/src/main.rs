//! `posecut-multicut`: minimum-cost multicuts of landmark edges.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_multicut::stage::StageOptions>(env!("CARGO_PKG_VERSION"))
}
