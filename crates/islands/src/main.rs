//! `posecut-islands`.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_islands::Options>(env!("CARGO_PKG_VERSION"))
}
