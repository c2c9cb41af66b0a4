//! `posecut-simulate-graph`.

fn main() -> std::process::ExitCode {
    posecut_simulate_graph::cli::main()
}
