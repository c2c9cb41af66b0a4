//! `posecut-readmit`: judges every landmark edge by the map that the others make.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_readmit::Options>(env!("CARGO_PKG_VERSION"))
}
