//! `posecut-pcm`: pairwise consistency maximisation on a pose graph.

fn main() -> std::process::ExitCode {
    posecut_stage::run_graph_stage::<posecut_pcm::stage::StageOptions>(env!("CARGO_PKG_VERSION"))
}
