//! `posecut-oracle`: rejects the landmark edges that the truth calls incorrect.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_oracle::Options>(env!("CARGO_PKG_VERSION"))
}
