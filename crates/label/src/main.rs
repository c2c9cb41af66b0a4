//! `posecut-label`: writes which landmark edges of a graph are correct.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_label::stage::Options>(env!("CARGO_PKG_VERSION"))
}
