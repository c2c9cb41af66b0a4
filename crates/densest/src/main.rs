//! `posecut-densest`.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_densest::Options>(env!("CARGO_PKG_VERSION"))
}
