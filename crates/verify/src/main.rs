//! `posecut-verify`.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_verify::Options>(env!("CARGO_PKG_VERSION"))
}
