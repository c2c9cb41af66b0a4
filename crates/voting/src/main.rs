//! `posecut-voting`.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_voting::Options>(env!("CARGO_PKG_VERSION"))
}
