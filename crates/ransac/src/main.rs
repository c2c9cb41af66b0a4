//! `posecut-ransac`.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_ransac::Options>(env!("CARGO_PKG_VERSION"))
}
